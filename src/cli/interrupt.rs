//! Ctrl-C and termination signals. While something is prepared, one ends the program at once; while a
//! render has passes to keep, the first asks for an end and the second ends at once.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};

use super::output::message;

static RENDERING: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static FAILED: OnceLock<String> = OnceLock::new();

/// The argument that stands for nothing but this exit code.
const END: &str = "--interrupted";

/// Whether this process is one that only ends, see [`end`].
pub fn is_end() -> bool {
    let mut arguments = std::env::args_os().skip(1);
    arguments.next().is_some_and(|argument| argument == END) && arguments.next().is_none()
}

/// Ends the process at once, with the code of an interrupt, whatever its other threads are at. What C
/// libraries do at a regular exit takes a driver's compiler apart while it compiles, which ends in a crash;
/// so the program gives its place to a new one, of a single thread, that exits.
fn end() -> ! {
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        let program = std::env::current_exe();
        // returns only if it fails
        let _ = program.map(|program| std::process::Command::new(program).arg(END).exec());
    }
    std::process::exit(super::Done::Interrupted as i32)
}

/// Handles signals from now on; `renders` says whether the command has passes to come.
pub fn begin(renders: bool) {
    let handler = move || {
        if !RENDERING.load(Ordering::Relaxed) {
            message(match renders {
                true => "\ninterrupted before the first pass: nothing is saved",
                false => "\ninterrupted",
            });
            end();
        }
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            end();
        }
        message("\ninterrupted: finishing the pass; once more to end at once");
    };
    // Handlers that nobody waits for would swallow signals: none are set where there is no thread to wait.
    let thread = thread::Builder::new().spawn(|| ()).map(JoinHandle::join);
    let set = thread.map_err(ctrlc::Error::System).and_then(|_| ctrlc::set_handler(handler));
    if let Err(error) = set {
        let _ = FAILED.set(error.to_string());
    }
}

/// The flag that the first signal from now on sets.
pub fn flag() -> &'static AtomicBool {
    RENDERING.store(true, Ordering::Relaxed);
    if let Some(error) = FAILED.get() {
        message(format_args!("warning: Ctrl-C will end the program without saving the picture: {error}"));
    }
    &INTERRUPTED
}
