//! Progress while a driver compiles kernels, which may take a minute: a live line on a terminal,
//! otherwise occasional lines, or events with `--json`.

use std::io::IsTerminal;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use caustica::low_level::telemetry::compilation::{Compilation, observe};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use super::log;
use super::output::{message, result};

/// Delay before the first output; kernels from the driver's cache are usually ready earlier.
const FIRST: Duration = Duration::from_millis(600);
/// Time between two updates of the live line.
const TICK: Duration = Duration::from_millis(100);
/// Time between two events.
const EVENT: Duration = Duration::from_secs(1);

/// Form of the progress output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Live,
    Lines,
    Events,
}

/// A compilation in progress.
#[derive(Clone, Debug)]
struct State {
    begun: Instant,
    device: String,
    kernel: &'static str,
    done: usize,
    of: usize,
    ended: bool,
}

impl State {
    fn text(&self) -> String {
        let Self { device, kernel, done, of, .. } = self;
        let seconds = self.begun.elapsed().as_secs();
        format!("compiling for {device}: {kernel}, {done} of {of} kernels done, {seconds} s")
    }

    fn event(&self) -> Value {
        json!({
            "event": "compiling",
            "device": self.device,
            "kernel": self.kernel,
            "done": self.done,
            "of": self.of,
            "elapsed": self.begun.elapsed().as_secs_f64(),
        })
    }
}

/// State shared by the observer and the thread that shows progress.
#[derive(Default)]
struct Shared {
    state: Mutex<Option<State>>,
    changed: Condvar,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, Option<State>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the compilation ends, at most for `time`. Returns its state if it still runs.
    fn going_on(&self, time: Duration) -> Option<State> {
        let goes_on = |state: &mut Option<State>| state.as_ref().is_some_and(|state| !state.ended);
        let waited = self.changed.wait_timeout_while(self.state(), time, goes_on);
        let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
        state.clone().filter(|state| !state.ended)
    }
}

/// Starts to show the progress of compilations. `quiet` suppresses it, unless `json` requests
/// events.
pub fn begin(quiet: bool, json: bool) {
    let form = match (json, quiet) {
        (true, _) => Form::Events,
        (false, true) => return,
        (false, false) if std::io::stderr().is_terminal() && !log::is_on() => Form::Live,
        (false, false) => Form::Lines,
    };
    let shown: Mutex<Option<(Arc<Shared>, thread::JoinHandle<()>)>> = Mutex::new(None);
    observe(move |compilation| {
        let mut shown = shown.lock().unwrap_or_else(PoisonError::into_inner);
        match (compilation, shown.as_ref()) {
            (Some(compilation), None) => *shown = start(form, compilation),
            (Some(Compilation { kernel, done, .. }), Some((shared, _))) => {
                if let Some(state) = shared.state().as_mut() {
                    (state.kernel, state.done) = (*kernel, *done);
                }
            }
            (None, _) => {
                if let Some((shared, thread)) = shown.take() {
                    shared.state().iter_mut().for_each(|state| state.ended = true);
                    shared.changed.notify_all();
                    // remove the live line before anything else is printed
                    let _ = thread.join();
                }
            }
        }
    });
}

/// Starts a thread that shows a compilation. Shows nothing if no thread can be created.
fn start(form: Form, compilation: &Compilation) -> Option<(Arc<Shared>, thread::JoinHandle<()>)> {
    let Compilation { device, kernel, done, of } = *compilation;
    let state =
        State { begun: Instant::now(), device: device.to_owned(), kernel, done, of, ended: false };
    let shared = Arc::new(Shared { state: Mutex::new(Some(state)), changed: Condvar::new() });
    let theirs = shared.clone();
    let thread = thread::Builder::new().spawn(move || match form {
        Form::Live => live(&theirs),
        Form::Lines => lines(&theirs),
        Form::Events => events(&theirs),
    });
    thread.ok().map(|thread| (shared, thread))
}

fn live(shared: &Shared) {
    let mut wait = FIRST;
    let mut bar = None;
    while let Some(state) = shared.going_on(wait) {
        wait = TICK;
        let bar = bar.get_or_insert_with(|| {
            let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{spinner} {wide_msg}");
            bar.set_style(style.unwrap_or(ProgressStyle::default_spinner()));
            bar
        });
        bar.set_message(state.text());
        bar.tick();
    }
    bar.inspect(ProgressBar::finish_and_clear);
}

/// Prints lines at growing intervals, to keep logs readable.
fn lines(shared: &Shared) {
    let mut wait = FIRST;
    while let Some(state) = shared.going_on(wait) {
        message(state.text());
        wait = state.begun.elapsed().max(Duration::from_secs(4));
    }
}

fn events(shared: &Shared) {
    let mut wait = FIRST;
    while let Some(state) = shared.going_on(wait) {
        // a failure of standard output is reported with the results at the end
        let _ = result(state.event());
        wait = EVENT;
    }
}
