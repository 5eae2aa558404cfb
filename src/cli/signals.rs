//! Waits for Ctrl-C, SIGTERM and SIGHUP on a thread of its own.

use std::io;

/// Calls `handler` for each signal from now on. A signal that the program was started to ignore stays
/// ignored (Linux): SIGHUP under `nohup`, SIGINT for a background job of a shell without job control.
///
/// # Errors
/// The system gives no thread or no handler; then no signal is caught.
#[cfg(unix)]
pub fn listen(handler: impl Fn() + Send + 'static) -> io::Result<()> {
    use std::sync::mpsc;
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    let ignored = ignored();
    let caught = [SIGINT, SIGTERM, SIGHUP].map(|signal| (ignored >> (signal - 1) & 1 == 0).then_some(signal));
    // Handlers that nobody waits for would swallow signals: the thread that waits sets them.
    let (sender, receiver) = mpsc::channel();
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        let (mut signals, set) = match Signals::new(caught.into_iter().flatten()) {
            Ok(signals) => (Some(signals), Ok(())),
            Err(error) => (None, Err(error)),
        };
        // the other end waits for this
        let _ = sender.send(set);
        signals.iter_mut().flat_map(|signals| signals.forever()).for_each(|_| handler());
    })?;
    receiver.recv().unwrap_or_else(|error| Err(io::Error::other(error)))
}

/// The signals that this process ignores, one bit each, from 1. Asked before any handler is set.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Calls `handler` for each signal from now on.
///
/// # Errors
/// The system gives no thread or no handler.
#[cfg(not(unix))]
pub fn listen(handler: impl FnMut() + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(handler).map_err(io::Error::other)
}
