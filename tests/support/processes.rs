//! Processes that run in the background, receive signals, or run as another user.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::program::{PROGRAM, command, text};

/// The program with the default action of signals. A child inherits ignored signals, so without
/// this a test that sends one would wait for ever if the test suite itself ignores it, as under
/// `nohup` or in the background of a shell without job control.
pub fn interruptible(folder: &Path, arguments: &[&str]) -> Command {
    if !cfg!(target_os = "linux") {
        return command(folder, arguments);
    }
    let mut command = with_default_signals(PROGRAM);
    command.args(arguments).current_dir(folder).env("NO_COLOR", "1");
    command
}

/// A program that starts with the default action of signals, by GNU `env`.
pub fn with_default_signals(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new("env");
    command.arg("--default-signal=INT,TERM,HUP").arg(program);
    command
}

/// Starts a command in the background, with its output captured.
pub fn spawn(mut command: Command) -> Child {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Waits for the end of a process and returns its output; kills it after a minute.
#[track_caller]
pub fn ended(mut child: Child) -> Output {
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

/// Waits until `so` holds, at most a minute.
#[track_caller]
pub fn until(what: &str, mut so: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !so() {
        assert!(begun.elapsed() < Duration::from_secs(60), "never {what}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Sends a signal to a process.
#[track_caller]
pub fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args(["-s", name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// A command that runs `program` as the user 65534 if the tests run as root, because limits and
/// permissions do not apply to root.
pub fn unprivileged(program: impl AsRef<OsStr>) -> Command {
    let id = Command::new("id").arg("-u").output().unwrap();
    if text(&id.stdout).trim() != "0" {
        return Command::new(program);
    }
    let mut command = Command::new("setpriv");
    command.args(["--reuid=65534", "--clear-groups"]).arg(program);
    command
}

/// Held by tests that use [`unprivileged`]: the limit of processes counts all processes of a user,
/// also those of other tests.
pub fn only_unprivileged() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}
