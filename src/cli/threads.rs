//! Setup of the global thread pool.
//!
//! The system may limit threads (`ulimit -u`, a container's `pids.max`). Then the pool is smaller;
//! if no thread can be created, all work runs on the main thread.

use std::hint::black_box;
use std::num::NonZero;
use std::sync::{Arc, Mutex, mpsc};
use std::thread;

use caustica::low_level::memory::{KEPT, address_space, check_reserve, words};
use miette::miette;

use super::Failure;
use super::output::message;

/// Maximum number of threads per available core.
const MOST_PER_CORE: usize = 4;
/// Address space per thread: its stack, and the allocator's reservation.
const SPACE: u64 = 160 << 20;
/// Number of threads needed in addition to the pool: for signals, and by drivers.
const OTHERS: usize = 2;

/// Creates the pool with one thread per available core (on Linux, subject to the affinity and the
/// cgroup's CPU quota), or as many as `RAYON_NUM_THREADS` specifies.
///
/// # Errors
/// If no pool can be created.
pub fn begin() -> Result<(), Failure> {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    let wanted = match std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok()) {
        None | Some(0) => cores,
        Some(asked) if asked > MOST_PER_CORE * cores => {
            let most = MOST_PER_CORE * cores;
            message(format_args!(
                "warning: RAYON_NUM_THREADS={asked} exceeds {MOST_PER_CORE} threads per available \
                 core ({cores} cores); using {most} threads"
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
            "warning: only {given} of {wanted} threads could be created (see ulimit -u, or the \
             container's process limit)"
        ));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(given);
    // the main thread joins the pool only if there is no other: work submitted by other threads
    // would wait for it
    let pool = if spare == 0 { pool.use_current_thread() } else { pool };
    pool.build_global().map_err(|error| {
        Failure::failed(miette!(
            help = "raise the limit of processes (ulimit -u), or set RAYON_NUM_THREADS=1",
            "this process cannot create threads: {error}"
        ))
    })?;
    check_memory()
}

/// Checks that there is enough memory to begin at all.
fn check_memory() -> Result<(), Failure> {
    // the allocator reserves address space when a thread first allocates
    rayon::broadcast(|_| drop(black_box(Box::new(0u8))));
    check_reserve().map_err(|(left, whose)| {
        let (left, least) = (words(left), words(KEPT));
        Failure::failed(miette!(
            help = "raise the limit of the process",
            "too little memory to begin: {whose} is {left}; at least {least} are needed"
        ))
    })
}

/// Returns true if the pool has separate threads, so that other threads can submit work at any
/// time.
#[cfg(feature = "preview")]
pub fn are_spare() -> bool {
    // the caller is the main thread, which is in the pool only if there is no other thread
    rayon::current_thread_index().is_none()
}

/// Number of threads, up to `wanted`, that can exist at the same time.
fn available(wanted: usize) -> usize {
    let (release, held) = mpsc::channel::<()>();
    let held = Arc::new(Mutex::new(held));
    let waiting: Vec<_> = (0..wanted)
        .map_while(|_| {
            let held = held.clone();
            // `recv` returns when the sender is dropped
            thread::Builder::new().spawn(move || drop(held.lock().map(|held| held.recv()))).ok()
        })
        .collect();
    let given = waiting.len();
    drop(release);
    for thread in waiting {
        // these threads cannot panic
        let _ = thread.join();
    }
    given
}
