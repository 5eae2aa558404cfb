//! Ctrl-C: the first asks for an end, the second ends at once.

use std::sync::atomic::{AtomicBool, Ordering};

use super::output::message;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// The flag that the first Ctrl-C (or termination signal) from now on sets.
pub fn flag() -> &'static AtomicBool {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(super::Done::Interrupted as i32);
        }
        message("\ninterrupted: finishing the pass; once more to end at once");
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        message(format_args!("warning: Ctrl-C will end the program without saving the picture: {error}"));
    }
    &INTERRUPTED
}
