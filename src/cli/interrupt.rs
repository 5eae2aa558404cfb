//! Ctrl-C and termination signals. While something is prepared, one ends the program at once; while
//! a render has passes to keep, the first asks for an end and the second ends at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use super::output::{message, paragraph};
use super::signals;

static RENDERING: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static ENDING: AtomicBool = AtomicBool::new(false);
static FAILED: OnceLock<String> = OnceLock::new();
static LAST_WORDS: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// The argument that stands for nothing but this exit code.
const END: &str = "--interrupted";

/// Whether this process is one that only ends, see [`end`].
pub fn is_end() -> bool {
    let mut arguments = std::env::args_os().skip(1);
    arguments.next().is_some_and(|argument| argument == END) && arguments.next().is_none()
}

/// Ends the process at once, with the code of an interrupt, whatever its other threads are at. What
/// C libraries do at a regular exit takes a driver's compiler apart while it compiles, which ends
/// in a crash; so the program gives its place to a new one, of a single thread, that exits.
fn end() -> ! {
    ENDING.store(true, Ordering::SeqCst);
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        let program = std::env::current_exe();
        // returns only if it fails
        let _ = program.map(|program| std::process::Command::new(program).arg(END).exec());
    }
    std::process::exit(super::Done::Interrupted as i32)
}

/// Waits for the end if a signal is ending the program. Meanwhile other threads may fail, since the
/// system gives none to a process that is about to be replaced; such a failure must not be
/// reported.
pub fn wait_if_ending() {
    while ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Handles signals from now on; `renders` says whether the command has passes to come.
pub fn begin(renders: bool) {
    let handler = move || {
        if !RENDERING.load(Ordering::Relaxed) {
            if let Some(last_words) =
                LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner).take()
            {
                last_words();
            }
            paragraph(match renders {
                true => "\ninterrupted before the first pass: nothing is saved",
                false => "\ninterrupted",
            });
            end();
        }
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            end();
        }
        paragraph("\ninterrupted: finishing the pass; once more to end at once");
    };
    if let Err(error) = signals::listen(handler) {
        let _ = FAILED.set(error.to_string());
    }
}

/// From now on until [`flag`] is asked for, a signal ends the program at once, after `last_words`,
/// which print the results so far.
pub fn last_words(last_words: impl FnOnce() + Send + 'static) {
    *LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(last_words));
    RENDERING.store(false, Ordering::Relaxed);
}

/// The flag that the first signal from now on sets.
pub fn flag() -> &'static AtomicBool {
    RENDERING.store(true, Ordering::Relaxed);
    if let Some(error) = FAILED.get() {
        message(format_args!(
            "warning: Ctrl-C will end the program without saving the picture: {error}"
        ));
    }
    &INTERRUPTED
}
