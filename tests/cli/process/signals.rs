//! Signals at any moment of a run.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use super::{fifo, folder, render};
use crate::support::{
    PROGRAM, Running, ended, error, interruptible, json_lines, signal, software, spawn, until,
    with_default_signals, words,
};

/// Whether the program catches SIGINT (2), SIGTERM (15) and SIGHUP (1).
pub fn catches(child: &Child) -> bool {
    [2, 15, 1].iter().all(|signal| catches_signal(child, *signal))
}

/// Whether a process catches one signal. It leaves those alone that it was started to ignore.
pub fn catches_signal(child: &Child, signal: u32) -> bool {
    let status = fs::read_to_string(Path::new("/proc").join(child.id().to_string()).join("status"));
    let caught = status.ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        u64::from_str_radix(line.trim(), 16).ok()
    });
    caught.is_some_and(|caught| caught >> (signal - 1) & 1 == 1)
}

/// Theory: the program catches signals before it reads anything. From then on a signal ends a
/// render with exit code 130 at any moment. If a pass is complete the image is written, otherwise a
/// message says that nothing is saved.
#[test]
fn a_signal_at_any_moment() {
    let folder = folder("moments");
    let (mut before, mut after) = (0, 0);
    for (number, wait) in [0, 0, 0, 1, 2, 4, 8, 16, 40, 100, 250, 600].into_iter().enumerate() {
        let name = ["INT", "TERM", "HUP"][number % 3];
        // the large image takes a while before its first pass ends
        let size = if number < 9 { "--size 1000x800" } else { "" };
        let picture = folder.join("a.png");
        let _ = fs::remove_file(&picture);
        let child = spawn(render(&folder, &format!("--quiet --passes 1000000 {size} -o a.png")));
        until("ready", || catches(&child));
        std::thread::sleep(Duration::from_millis(wait));
        signal(&child, name);
        let output = ended(child);
        let error = error(&output);
        assert_eq!(
            output.status.code(),
            Some(130),
            "{name} after {wait} ms: {:?} {error}",
            output.status
        );
        let (nothing, saved) =
            (error.contains("nothing is saved"), error.contains("finishing the pass"));
        assert!(nothing != saved, "{name} after {wait} ms: {error}");
        assert_eq!(picture.exists(), saved, "{name} after {wait} ms: {error}");
        before += u32::from(nothing);
        after += u32::from(saved);
    }
    assert!(before > 0 && after > 0, "{before} {after}");
}

/// Theory: the exit code is the same while a driver compiles. Lavapipe without its cache compiles
/// for seconds, on separate threads.
#[test]
fn a_signal_while_a_driver_compiles() {
    software();
    let folder = folder("compiling");
    let mut before = 0;
    for wait in (0..24).map(|n| 60 * n) {
        let line = "render ball.toml --device software --quiet --passes 100000 -o a.png";
        let mut command = interruptible(&folder, &words(line));
        command.env("MESA_SHADER_CACHE_DISABLE", "true");
        let child = spawn(command);
        until("ready", || catches(&child));
        std::thread::sleep(Duration::from_millis(wait));
        signal(&child, "INT");
        let output = ended(child);
        let error = error(&output);
        assert_eq!(output.status.code(), Some(130), "after {wait} ms: {:?} {error}", output.status);
        before += u32::from(error.contains("nothing is saved"));
    }
    assert!(before > 0);
}

/// Starts the program from a shell that ignores these signals, as `nohup` and shells without job
/// control do.
fn ignoring(folder: &Path, names: &str, line: &str) -> Running {
    let program = format!("trap '' {names}; exec \"$0\" \"$@\"");
    let mut command = with_default_signals("sh");
    command.args(["-c", &program, PROGRAM]).args(words(line));
    command.current_dir(folder).env("NO_COLOR", "1");
    spawn(command)
}

/// Theory: a signal that is ignored when the program starts stays ignored. The other signals still
/// end it.
#[test]
fn ignored_signals_stay_ignored() {
    let folder = folder("ignored");
    let line = "render ball.toml --device cpu --quiet --passes 1000000 --time 60s -o a.png";
    let mask = |child: &Child, name: &str| {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status
            .lines()
            .find_map(|line| line.strip_prefix(name))
            .unwrap_or("0")
            .trim()
            .to_owned();
        u64::from_str_radix(&line, 16).unwrap()
    };
    for (names, ignored, ends) in [
        ("HUP", &["HUP"][..], "INT"),
        ("INT HUP", &["INT", "HUP"], "TERM"),
        ("TERM", &["TERM"], "HUP"),
    ] {
        let mut child = ignoring(&folder, names, line);
        let number = |name: &str| {
            ["HUP", "INT", "TERM"].iter().position(|n| *n == name).map(|i| [1, 2, 15][i])
        };
        let bit = |name: &str| 1u64 << (number(name).unwrap() - 1);
        // the shell itself may catch a signal before it executes the program
        let program =
            || fs::read_to_string(format!("/proc/{}/comm", child.id())).unwrap_or_default();
        until("ready", || {
            program().trim() == "caustica" && mask(&child, "SigCgt:") & bit(ends) != 0
        });
        for name in ignored {
            assert!(mask(&child, "SigIgn:") & bit(name) != 0, "{names}: {name}");
            signal(&child, name);
        }
        std::thread::sleep(Duration::from_millis(300));
        assert!(child.try_wait().unwrap().is_none(), "{names}: {ignored:?} end it");
        signal(&child, ends);
        let output = ended(child);
        assert_eq!(output.status.code(), Some(130), "{names}: {}", error(&output));
        assert_eq!(error(&output).matches("interrupted").count(), 1, "{}", error(&output));
    }
}

/// Theory: an interrupted bench reports what it has measured: some rounds of the first device, or
/// all of them if the next device is still compiling.
#[test]
fn an_interrupted_bench_keeps_its_figures() {
    use std::io::{BufRead, BufReader, Read};
    software();
    let folder = folder("bench");
    let caustics = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/caustics.toml");
    let long = "bench ball.toml --device cpu --passes 1000000";
    let next = format!(
        "bench {caustics} --size 16x16 --photons 1000 --passes 2 --device cpu --device software"
    );
    let cases = [
        (long, "measuring", 1),
        (long, "on ", 1),
        (&next, "\"done\":1", 1),
        (&next, "a pass takes", 1),
    ];
    for (line, begun, devices) in cases {
        let json = begun.starts_with(['m', '"']);
        let mut command = interruptible(&folder, &words(line));
        command.args(json.then_some("--json")).env("MESA_SHADER_CACHE_DISABLE", "true");
        let mut child = spawn(command);
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut said = String::new();
        while !said.lines().any(|line| line.contains(begun)) {
            assert!(stdout.read_line(&mut said).unwrap() > 0, "{line}: {said}");
        }
        std::thread::sleep(Duration::from_millis(700));
        signal(&child, "INT");
        let begun = std::time::Instant::now();
        stdout.read_to_string(&mut said).unwrap();
        let output = ended(child);
        assert_eq!(output.status.code(), Some(130), "{line}: {}", error(&output));
        assert!(begun.elapsed() < Duration::from_secs(3), "{line}: {:?}", begun.elapsed());
        if json {
            let bench = json_lines(said.as_bytes()).pop().unwrap();
            assert_eq!(
                (&bench["event"], &bench["complete"]),
                (&"bench".into(), &false.into()),
                "{said}"
            );
            let reports = bench["devices"].as_array().unwrap();
            assert_eq!(reports.len(), devices);
            assert!(
                reports.iter().all(|report| report["pass"]["count"].as_u64() > Some(0)),
                "{said}"
            );
        } else {
            assert_eq!(said.matches("a pass takes").count(), devices, "{said}");
        }
    }
}

/// A command without passes ends with the same code and does not mention passes.
#[test]
fn a_command_without_passes() {
    let folder = folder("no passes");
    fifo(&folder.join("pipe.toml"));
    let child = spawn(interruptible(&folder, &["check", "pipe.toml"]));
    until("ready", || catches(&child));
    signal(&child, "INT");
    let output = ended(child);
    assert_eq!((output.status.code(), error(&output).as_str()), (Some(130), "interrupted"));
}

/// Theory: a test that fails leaves no process behind. A process that would run for a minute is
/// gone once its owner has panicked.
#[test]
fn a_panic_leaves_no_process() {
    let (sender, receiver) = std::sync::mpsc::channel();
    let failing = std::thread::spawn(move || {
        let running = Running::start(Command::new("sleep").arg("60"));
        sender.send(running.id()).unwrap();
        panic!("as a failing test");
    });
    assert!(failing.join().is_err());
    let id = receiver.recv().unwrap().to_string();
    let found = Command::new("kill").args(["-0", &id]).stderr(Stdio::null()).status().unwrap();
    assert!(!found.success(), "process {id} is left");
}
