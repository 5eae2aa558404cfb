//! Signals at any moment.

use std::fs;
use std::path::Path;
use std::process::Child;
use std::time::Duration;

use super::software::software;
use super::support::error;
use super::{ended, folder, render, signal, spawn, until};

/// Whether the program catches SIGINT (2), SIGTERM (15) and SIGHUP (1).
fn catches(child: &Child) -> bool {
    let status = fs::read_to_string(Path::new("/proc").join(child.id().to_string()).join("status"));
    let caught = status.ok().and_then(|text| {
        let line = text.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        u64::from_str_radix(line.trim(), 16).ok()
    });
    [2, 15, 1].iter().all(|signal| caught.is_some_and(|caught| caught >> (signal - 1) & 1 == 1))
}

/// Theory: from the moment at which it catches signals, and that is before anything is read, a render ends
/// by the code of an interrupt, 130, whatever it is at. There is a picture if a pass is whole, else a word
/// that there is none.
#[test]
fn a_signal_at_any_moment() {
    let folder = folder("moments");
    let (mut before, mut after) = (0, 0);
    for (number, wait) in [0, 0, 0, 1, 2, 4, 8, 16, 40, 100, 250, 600].into_iter().enumerate() {
        let name = ["INT", "TERM", "HUP"][number % 3];
        // the large picture takes a while before the first pass
        let size = if number < 9 { "--size 1000x800" } else { "" };
        let picture = folder.join("a.png");
        let _ = fs::remove_file(&picture);
        let child = spawn(render(&folder, &format!("--quiet --passes 1000000 {size} -o a.png")));
        until("ready", || catches(&child));
        std::thread::sleep(Duration::from_millis(wait));
        signal(&child, name);
        let output = ended(child);
        let error = error(&output);
        assert_eq!(output.status.code(), Some(130), "{name} after {wait} ms: {:?} {error}", output.status);
        let (nothing, saved) = (error.contains("nothing is saved"), error.contains("finishing the pass"));
        assert!(nothing != saved, "{name} after {wait} ms: {error}");
        assert_eq!(picture.exists(), saved, "{name} after {wait} ms: {error}");
        before += u32::from(nothing);
        after += u32::from(saved);
    }
    assert!(before > 0 && after > 0, "{before} {after}");
}

/// Theory: a driver's compiler at work is no reason for another code. Lavapipe without its cache compiles for
/// some seconds, on threads of its own.
#[test]
fn a_signal_while_a_driver_compiles() {
    software();
    let folder = folder("compiling");
    let mut before = 0;
    for wait in (0..24).map(|n| 60 * n) {
        let line = "render ball.toml --device software --quiet --passes 100000 -o a.png";
        let mut command = super::support::command(&folder, &super::support::words(line));
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

/// A command without passes ends the same way, and does not speak of passes.
#[test]
fn a_command_without_passes() {
    let folder = folder("no passes");
    super::fifo(&folder.join("pipe.toml"));
    let child = spawn(super::support::command(&folder, &["check", "pipe.toml"]));
    until("ready", || catches(&child));
    signal(&child, "INT");
    let output = ended(child);
    assert_eq!((output.status.code(), error(&output).as_str()), (Some(130), "interrupted"));
}
