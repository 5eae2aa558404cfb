//! What the system gives the program: threads and memory.
//!
//! Theory: a process may be refused threads and memory at any time, and a program that counts both
//! before it takes them ends as documented: with a picture, or with a message and exit code 1. A
//! panic (101) or an abort by the allocator (134, by signal 6) is neither.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{folder, text};

fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).display().to_string()
}

/// The program under limits that util-linux's `prlimit` sets.
fn limited(program: &Path, limit: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("prlimit");
    command.arg(limit).arg("--").arg(program).args(arguments).env("NO_COLOR", "1");
    command
}

fn output(mut command: Command) -> Output {
    command.output().unwrap_or_else(|error| panic!("{command:?}: {error} (util-linux has it)"))
}

fn program() -> PathBuf {
    PathBuf::from(env!("CARGO_BIN_EXE_caustica"))
}

/// Under every limit of the address space the render is cut until it fits, or says that it does
/// not.
#[test]
fn little_address_space() {
    let folder = folder("address-space");
    let picture = folder.join("picture.png").display().to_string();
    let mut cut = 0;
    let mut refused = 0;
    for megabytes in [90, 110, 130, 170, 230, 300, 450] {
        let limit = format!("--as={}", megabytes * 1_000_000u64);
        let arguments =
            ["render", &scene("caustics.toml"), "--device", "cpu", "--passes", "1", "-o", &picture];
        let output = output(limited(&program(), &limit, &arguments));
        let error = text(&output.stderr);
        match output.status.code() {
            Some(0) => cut += u32::from(error.contains("to save memory")),
            Some(1) => {
                assert!(
                    error.contains("ulimit -v") && error.contains("--size"),
                    "{megabytes} MB: {error}"
                );
                refused += 1;
            }
            code => panic!("{megabytes} MB: {code:?} {:?} {error}", output.status),
        }
    }
    assert!(cut > 0 && refused > 0, "{cut} renders were cut and {refused} refused");
}

/// Under every limit of processes there are fewer threads, down to the main thread alone, and the
/// same picture. Root has no such limit, so that the program runs as another user then.
#[test]
fn few_threads() {
    let folder = std::env::temp_dir().join(format!("caustica-threads-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let program = folder.join("caustica");
    fs::copy(self::program(), &program).unwrap();
    fs::copy(scene("cornell.toml"), folder.join("cornell.toml")).unwrap();
    let open = |path: &Path| {
        use std::os::unix::fs::PermissionsExt;
        fs::set_permissions(path, fs::Permissions::from_mode(0o777)).unwrap();
    };
    open(&folder);
    open(&program);
    let id = Command::new("id").arg("-u").output().unwrap();
    let root = text(&id.stdout).trim() == "0";
    let mut pictures = Vec::new();
    // another user of a machine may have processes already: then none may be left
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
        let mut command = limited(&program, &limit, &arguments);
        if root {
            let mut other = Command::new("setpriv");
            other.args(["--reuid=65534", "--clear-groups", "prlimit"]).args(command.get_args());
            command = other;
        }
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

/// A number of threads that nobody can mean is reported and not started.
#[test]
fn too_many_threads() {
    let cores = std::thread::available_parallelism().unwrap().get();
    let mut command = Command::new(program());
    command.args(["check", &scene("cornell.toml")]).env("RAYON_NUM_THREADS", "100000");
    let output = output(command);
    let error = text(&output.stderr);
    assert!(
        output.status.success() && error.contains(&format!("{} are started", 4 * cores)),
        "{error}"
    );
}
