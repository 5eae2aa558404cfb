//! Limits of the operating system on threads and memory.
//!
//! Theory: the system may refuse threads and memory at any time. The program counts both before it
//! uses them, so it ends as documented: with an image, or with a message and exit code 1. A panic
//! gives 101 and an abort by the allocator 134 (signal 6).

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::support::{PROGRAM, folder, only_unprivileged, shipped, text, unprivileged};

/// The program under a limit set by util-linux's `prlimit`.
fn limited(program: &Path, limit: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("prlimit");
    command.arg(limit).arg("--").arg(program).args(arguments).env("NO_COLOR", "1");
    command
}

fn output(mut command: Command) -> Output {
    command.output().unwrap_or_else(|error| panic!("{command:?}: {error} (util-linux has it)"))
}

/// Theory: under every limit of the address space the render is split until it fits, or reports
/// that it does not.
#[test]
fn little_address_space() {
    let folder = folder("address-space");
    let picture = folder.join("picture.png").display().to_string();
    let mut cut = 0;
    let mut refused = 0;
    for megabytes in [90, 110, 130, 170, 230, 300, 450] {
        let limit = format!("--as={}", megabytes * 1_000_000u64);
        let arguments = [
            "render",
            &shipped("caustics.toml"),
            "--device",
            "cpu",
            "--passes",
            "1",
            "-o",
            &picture,
        ];
        let output = output(limited(PROGRAM.as_ref(), &limit, &arguments));
        let error = text(&output.stderr);
        match output.status.code() {
            Some(0) => cut += u32::from(error.contains("to save memory")),
            Some(1) => {
                assert!(
                    error.contains("ulimit -v")
                        && (error.contains("--size") || error.contains("raise the limit")),
                    "{megabytes} MB: {error}"
                );
                refused += 1;
            }
            code => panic!("{megabytes} MB: {code:?} {:?} {error}", output.status),
        }
    }
    assert!(cut > 0 && refused > 0, "{cut} renders were cut and {refused} refused");
}

/// Theory: under every limit of processes the program uses fewer threads, down to the main thread
/// alone, and renders the same image. Root has no such limit, so root runs the program as another
/// user.
#[test]
fn few_threads() {
    let _only = only_unprivileged();
    let folder = std::env::temp_dir().join(format!("caustica-threads-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let program = folder.join("caustica");
    fs::copy(PROGRAM, &program).unwrap();
    fs::copy(shipped("cornell.toml"), folder.join("cornell.toml")).unwrap();
    let open = |path: &Path| {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o777)).unwrap();
    };
    open(&folder);
    open(&program);
    let mut pictures = Vec::new();
    // that user may have processes already, so that none may be left
    for processes in [1, 2, 4, 7, 100] {
        let picture = folder.join(format!("{processes}.pfm"));
        let limit = format!("--nproc={processes}");
        let arguments = [
            "render",
            "cornell.toml",
            "--size",
            "16x16",
            "--photons",
            "2000",
            "--passes",
            "2",
            "--device",
        ];
        let mut command = unprivileged("prlimit");
        command.args(limited(&program, &limit, &arguments).get_args());
        command
            .args(["cpu", "-o"])
            .arg(&picture)
            .current_dir(&folder)
            .env("RAYON_NUM_THREADS", "6");
        let output = output(command);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{processes} processes: {error}");
        assert_eq!(error.contains("of 6 threads"), processes < 9, "{processes} processes: {error}");
        pictures.push(fs::read(&picture).unwrap());
    }
    assert!(
        pictures.windows(2).all(|pair| pair[0] == pair[1]),
        "the picture depends on the threads"
    );
    fs::remove_dir_all(&folder).unwrap();
}

/// An absurd number of threads is reported and not started.
#[test]
fn too_many_threads() {
    let cores = std::thread::available_parallelism().unwrap().get();
    let mut command = Command::new(PROGRAM);
    command.args(["check", &shipped("cornell.toml")]).env("RAYON_NUM_THREADS", "100000");
    let output = output(command);
    let error = text(&output.stderr);
    assert!(
        output.status.success() && error.contains(&format!("using {} threads", 4 * cores)),
        "{error}"
    );
}
