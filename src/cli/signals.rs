//! Handling of Ctrl-C, SIGTERM and SIGHUP on a separate thread.

use std::io;

/// Calls `handler` for each signal from now on. On Linux, signals that were ignored when the
/// program started stay ignored: SIGHUP under `nohup`, SIGINT for background jobs of a shell
/// without job control.
///
/// # Errors
/// If the thread or a handler cannot be created; then no signal is caught.
#[cfg(unix)]
pub fn listen(handler: impl Fn() + Send + 'static) -> io::Result<()> {
    use std::sync::{Arc, Mutex, PoisonError};
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    let ignored = ignored();
    let caught = [SIGINT, SIGTERM, SIGHUP]
        .map(|signal| (ignored >> (signal - 1) & 1 == 0).then_some(signal));
    // Without the thread, installed handlers would swallow signals, so start it first. It allocates
    // nothing before the first signal: glibc would reserve 64 MiB of address space for it.
    let signals = Arc::new(Mutex::new(None::<Signals>));
    let theirs = signals.clone();
    let thread = thread::Builder::new().name("signals".to_owned()).spawn(move || {
        let take = || theirs.lock().unwrap_or_else(PoisonError::into_inner).take();
        loop {
            match take() {
                Some(mut signals) => signals.forever().for_each(|_| handler()),
                None => thread::park(),
            }
        }
    })?;
    let set = Signals::new(caught.into_iter().flatten())?;
    *signals.lock().unwrap_or_else(PoisonError::into_inner) = Some(set);
    thread.thread().unpark();
    Ok(())
}

/// Bit mask of the signals that this process ignores, bit 0 for signal 1. Must be read before
/// handlers are installed.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Calls `handler` for each signal from now on.
///
/// # Errors
/// If the thread or the handler cannot be created.
#[cfg(not(unix))]
pub fn listen(handler: impl FnMut() + Send + 'static) -> io::Result<()> {
    ctrlc::set_handler(handler).map_err(io::Error::other)
}
