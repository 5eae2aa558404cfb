//! Processes that run in the background, receive signals, or run as another user.

use std::ffi::OsStr;
use std::ops::{Deref, DerefMut};
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

/// A process that is killed if the test ends first, also by a panic.
pub struct Running(Option<Child>);

impl From<Child> for Running {
    fn from(child: Child) -> Self {
        Self(Some(child))
    }
}

impl Running {
    /// Starts a command.
    #[track_caller]
    pub fn start(command: &mut Command) -> Self {
        let name = command.get_program().to_owned();
        command.spawn().unwrap_or_else(|error| panic!("{name:?}: {error}")).into()
    }
}

impl Deref for Running {
    type Target = Child;

    fn deref(&self) -> &Child {
        self.0.as_ref().expect("taken only by `ended`, which consumes it")
    }
}

impl DerefMut for Running {
    fn deref_mut(&mut self) -> &mut Child {
        self.0.as_mut().expect("taken only by `ended`, which consumes it")
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        if let Some(child) = &mut self.0 {
            // it may have ended already
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Starts a command in the background, with its output captured.
#[track_caller]
pub fn spawn(mut command: Command) -> Running {
    Running::start(command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()))
}

/// Waits for the end of a process and returns its output; kills it after a minute.
#[track_caller]
pub fn ended(mut running: Running) -> Output {
    let begun = Instant::now();
    let mut waits = false;
    while running.try_wait().unwrap().is_none() {
        if begun.elapsed() > Duration::from_secs(60) {
            waits = true;
            running.kill().unwrap();
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let output = running.0.take().map(Child::wait_with_output).unwrap().unwrap();
    assert!(!waits, "it does not end: {output:?}");
    output
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
