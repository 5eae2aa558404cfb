//! The program and the system: files of every kind, terminals, signals.
//!
//! Theory: what the system does for other programs it does for this one. Names lead where links
//! lead, modes and owners stay, pipes and devices are neither replaced nor waited for, terminals
//! show text, and signals end a render by the code that the documentation names.

mod compiling;
mod drivers;
mod limits;
mod outputs;
mod readers;
mod sharing;
mod signals;
mod terminal;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use crate::support::{DISC, LAMP, ball, folder_with};

static SCENE: LazyLock<String> =
    LazyLock::new(|| ball((12, 8), "passes = 2\nphotons = 500", &[DISC, LAMP]));

/// A fresh folder with a small scene in it.
fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE)])
}

/// A render of it, with the words of `line`.
fn render(folder: &Path, line: &str) -> Command {
    let line = format!("render ball.toml --device cpu {line}");
    crate::support::command(folder, &crate::support::words(&line))
}

/// A command that runs in the background.
fn spawn(mut command: Command) -> Child {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Its end, which must come in time: what waits for ever is killed.
#[track_caller]
fn ended(mut child: Child) -> Output {
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("it waits: {:?}", child.wait_with_output());
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    child.wait_with_output().unwrap()
}

/// Waits until something is so.
#[track_caller]
fn until(what: &str, mut so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "never {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Makes a pipe with a name.
fn fifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Sends a signal.
fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}
