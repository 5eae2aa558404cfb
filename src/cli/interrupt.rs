//! Ctrl-C and termination signals. During setup, a signal ends the program at once. During a
//! render, the first signal ends it after the current pass, the second at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};

use super::output::{message, paragraph};
use super::signals;

static RENDERING: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static ENDING: AtomicBool = AtomicBool::new(false);
static FAILED: OnceLock<String> = OnceLock::new();
static LAST_WORDS: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// Internal argument: exit at once with the code of an interrupt.
const END: &str = "--interrupted";

/// Returns true if this process only has to exit, see [`end`].
pub fn is_end() -> bool {
    let mut arguments = std::env::args_os().skip(1);
    arguments.next().is_some_and(|argument| argument == END) && arguments.next().is_none()
}

/// Ends the process at once with the code of an interrupt, regardless of other threads. At a
/// regular exit, the destructors of C libraries would run while a driver compiles in another
/// thread, which crashes. So the process replaces itself (exec) with a single-threaded one that
/// exits.
fn end() -> ! {
    ENDING.store(true, Ordering::SeqCst);
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt;
        let program = std::env::current_exe();
        // exec returns only if it fails
        let _ = program.map(|program| std::process::Command::new(program).arg(END).exec());
    }
    std::process::exit(super::Done::Interrupted as i32)
}

/// Blocks if a signal is ending the program. The other threads may fail meanwhile, since a process
/// that is being replaced cannot create threads; such a failure must not be reported.
pub fn wait_if_ending() {
    while ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Installs the signal handlers. `renders` is true if the command will render passes.
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
        paragraph("\ninterrupted: finishing the pass; interrupt again to end at once");
    };
    if let Err(error) = signals::listen(handler) {
        let _ = FAILED.set(error.to_string());
    }
}

/// Until the next call of [`flag`], a signal calls `last_words`, which prints the results so far,
/// and ends the program at once.
pub fn last_words(last_words: impl FnOnce() + Send + 'static) {
    *LAST_WORDS.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(last_words));
    RENDERING.store(false, Ordering::Relaxed);
}

/// Returns the flag that the first signal sets from now on.
pub fn flag() -> &'static AtomicBool {
    RENDERING.store(true, Ordering::Relaxed);
    if let Some(error) = FAILED.get() {
        message(format_args!(
            "warning: Ctrl-C will end the program without saving the image: {error}"
        ));
    }
    &INTERRUPTED
}
