//! The thread pool, built before anything needs it.
//!
//! A system may refuse threads (`ulimit -u`, a container's `pids.max`). Then there are fewer, and
//! where it gives none, all work is done on the main thread.

use std::num::NonZero;
use std::sync::{Arc, Mutex, mpsc};
use std::thread;

use caustica::low_level::memory::address_space;
use miette::miette;

use super::Failure;
use super::output::message;

/// Most threads for each core that the process may use.
const MOST_PER_CORE: usize = 4;
/// Address space for each thread: its stack, and what the allocator reserves for it.
const SPACE: u64 = 160 << 20;
/// Threads that the program needs in addition to the pool: signals, and those of a driver.
const OTHERS: usize = 2;

/// Builds the pool: as many threads as the process may use cores, which on Linux follows the
/// affinity and the cgroup's CPU quota, or as `RAYON_NUM_THREADS` says.
///
/// # Errors
/// Where the system allows no pool at all.
pub fn begin() -> Result<(), Failure> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let wanted = match std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok()) {
        None | Some(0) => cores,
        Some(asked) if asked > MOST_PER_CORE * cores => {
            let most = MOST_PER_CORE * cores;
            message(format_args!(
                "warning: RAYON_NUM_THREADS={asked} is more than {MOST_PER_CORE} threads for each of the {cores} \
                 cores that this process may use; {most} are started"
            ));
            most
        }
        Some(asked) => asked,
    };
    let roomy = address_space().map_or(wanted, |bytes| (bytes / SPACE) as usize);
    let wanted = wanted.min(roomy).max(1);
    let spare = available(wanted + OTHERS).saturating_sub(OTHERS);
    let given = spare.max(1);
    if given < wanted {
        message(format_args!(
            "warning: the system gives this process {given} of {wanted} threads (see ulimit -u, or the \
             container's limit of processes)"
        ));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(given);
    // Only where there is no other: work that another thread gives to the pool waits for this one
    // then.
    let pool = if spare == 0 { pool.use_current_thread() } else { pool };
    pool.build_global().map_err(|error| {
        Failure::failed(miette!(
            help = "raise the limit of processes (ulimit -u), or set RAYON_NUM_THREADS=1",
            "the system gives this process no threads: {error}"
        ))
    })
}

/// Whether the pool has threads of its own, so that other threads can give work to it at any time.
#[cfg(feature = "preview")]
pub fn are_spare() -> bool {
    // the main thread, which asks, is in the pool only where there is no other
    rayon::current_thread_index().is_none()
}

/// How many of `wanted` threads the system gives at a time.
fn available(wanted: usize) -> usize {
    let (release, held) = mpsc::channel::<()>();
    let held = Arc::new(Mutex::new(held));
    let waiting: Vec<_> = (0..wanted)
        .map_while(|_| {
            let held = held.clone();
            // returns when the sender is gone
            thread::Builder::new().spawn(move || drop(held.lock().map(|held| held.recv()))).ok()
        })
        .collect();
    let given = waiting.len();
    drop(release);
    for thread in waiting {
        // such a thread cannot panic
        let _ = thread.join();
    }
    given
}
