//! The render thread: takes render requests, and shows a small image at once and the full-size one
//! after a short time without changes.
//!
//! It renders the small image itself with the CPU engine, and leaves the full-size one to [`Full`],
//! so that no request waits for a full-size pass, a shader compiler, or the construction of a
//! kd-tree.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::frame::{Frame, FrameSlot, RenderRequest};
use super::full::Full;
use super::orbit::depth_at;
use super::packed_cache::Prepared;
use super::quick::{Divisor, Quick};
use crate::engine::Cancel;
use crate::gpu::GpuEngine;
use crate::scene::Scene;

/// Time without changes before the full-size render starts.
const STILL: Duration = Duration::from_millis(250);
/// Polling interval while an old render ends.
const SOON: Duration = Duration::from_millis(10);
/// Polling interval while idle.
const LONG: Duration = Duration::from_secs(3600);

enum Command {
    Scene(u64, Arc<Scene>, RenderRequest),
    Change(u64, RenderRequest),
    Passes(u32),
    Pause(bool),
    Look(f64, f64),
}

/// A render thread; ends when this handle is dropped.
pub struct Worker {
    commands: Option<Sender<Command>>,
    slot: Arc<FrameSlot>,
    number: u64,
    last: Option<RenderRequest>,
    /// Cancels the current small image.
    closing: Cancel,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread; `wake` is called, on any thread, whenever there is something new to show.
    pub fn start(wake: impl Fn() + Send + Sync + 'static) -> Self {
        let (sender, receiver) = mpsc::channel();
        let slot = Arc::new(FrameSlot::new(wake));
        let own = slot.clone();
        let closing = Cancel::default();
        let closes = closing.clone();
        let thread = thread::spawn(move || {
            // use a separate pool, because the threads of the global one may be busy with a
            // full-size pass
            let work = move || Hand::new(own, closes).work(&receiver);
            let threads = rayon::current_num_threads();
            match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                Ok(pool) => pool.install(work),
                Err(_) => work(),
            }
        });
        Self { commands: Some(sender), slot, number: 0, last: None, closing, thread: Some(thread) }
    }

    /// Renders another scene; returns the number of the request.
    pub fn scene(&mut self, scene: Arc<Scene>, request: RenderRequest) -> u64 {
        self.number += 1;
        self.slot.begin(self.number);
        self.last = Some(request.clone());
        self.send(Command::Scene(self.number, scene, request));
        self.number
    }

    /// Changes the request; returns its number, which stays the same if only the number of passes
    /// differs.
    pub fn change(&mut self, request: RenderRequest) -> u64 {
        let passes = request.settings.passes;
        let command = match self.last.replace(request.clone()) {
            Some(last) if last.same_passes(&request) => Command::Passes(passes),
            _ => {
                self.number += 1;
                self.slot.begin(self.number);
                Command::Change(self.number, request)
            }
        };
        self.send(command);
        self.number
    }

    /// Pauses or continues the full-size render. Small images are not affected.
    pub fn pause(&self, paused: bool) {
        self.send(Command::Pause(paused));
    }

    /// Measures the depth at an image position, from (0, 0) at the top left to (1, 1);
    /// [`FrameSlot::take_depth`] returns it.
    pub fn look(&self, x: f64, y: f64) {
        self.send(Command::Look(x, y));
    }

    /// Slot with the newest results.
    pub fn slot(&self) -> &FrameSlot {
        &self.slot
    }

    /// The newest frame.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.slot.frame()
    }

    fn send(&self, command: Command) {
        if let Some(commands) = &self.commands {
            // The thread outlives its command channel, so this cannot fail unless the thread
            // panicked.
            let _ = commands.send(command);
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.commands = None;
        self.closing.ask();
        // A panic has been reported already.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// State of the render thread.
struct Hand {
    slot: Arc<FrameSlot>,
    prepared: Option<Prepared>,
    request: Option<RenderRequest>,
    number: u64,
    divisor: Divisor,
    quick: Option<Quick>,
    full: Option<Full>,
    /// A cancelled render that has not ended yet.
    ending: Option<Full>,
    spare: Option<Box<GpuEngine>>,
    /// Start time of the full-size render.
    settle: Option<Instant>,
    paused: bool,
    closing: Cancel,
}

impl Hand {
    fn new(slot: Arc<FrameSlot>, closing: Cancel) -> Self {
        Self {
            slot,
            prepared: None,
            request: None,
            number: 0,
            divisor: Divisor::default(),
            quick: None,
            full: None,
            ending: None,
            spare: None,
            settle: None,
            paused: false,
            closing,
        }
    }

    fn work(mut self, commands: &Receiver<Command>) {
        loop {
            let mut command = match commands.recv_timeout(self.leisure()) {
                Ok(command) => Some(command),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break,
            };
            // of the changes that arrived meanwhile, only the last counts
            let mut change = None;
            while let Some(taken) = command {
                match taken {
                    Command::Change(number, request) => change = Some((number, request)),
                    Command::Scene(number, scene, request) => {
                        change = None;
                        self.take_scene(number, scene, request);
                    }
                    Command::Passes(passes) => match &mut change {
                        Some((_, request)) => request.settings.passes = passes,
                        None => self.set_passes(passes),
                    },
                    Command::Pause(paused) => self.pause(paused),
                    Command::Look(x, y) => {
                        let depth = self
                            .prepared
                            .as_ref()
                            .and_then(|prepared| depth_at(prepared.packed(), x, y));
                        depth.into_iter().for_each(|depth| self.slot.tell_depth(depth));
                    }
                }
                command = commands.try_recv().ok();
            }
            if let Some((number, request)) = change {
                self.take_change(number, request);
            }
            self.go_on();
        }
        for full in [self.full.take(), self.ending.take()].into_iter().flatten() {
            full.end();
            full.join();
        }
    }

    /// Time to wait for the next command.
    fn leisure(&self) -> Duration {
        if self.quick.is_some() {
            return Duration::ZERO;
        }
        match (self.ending.is_some(), self.settle.filter(|_| !self.paused)) {
            (true, _) => SOON,
            (false, Some(at)) => at.saturating_duration_since(Instant::now()),
            (false, None) => LONG,
        }
    }

    fn take_scene(&mut self, number: u64, scene: Arc<Scene>, request: RenderRequest) {
        self.halt(number);
        let mut scene = scene;
        let own = Arc::make_mut(&mut scene);
        (own.camera, own.film) = (request.camera, request.film);
        match Prepared::new(scene) {
            Ok(prepared) => {
                self.prepared = Some(prepared);
                self.begin(request, Duration::ZERO);
            }
            Err(error) => {
                self.prepared = None;
                self.slot.fail(number, error.to_string());
            }
        }
    }

    fn take_change(&mut self, number: u64, request: RenderRequest) {
        self.halt(number);
        self.begin(request, STILL);
    }

    fn set_passes(&mut self, passes: u32) {
        self.request.iter_mut().for_each(|request| request.settings.passes = passes);
        self.full.iter().for_each(|full| full.set_passes(passes));
    }

    /// Ends the current renders; results now belong to request `number`.
    fn halt(&mut self, number: u64) {
        self.number = number;
        self.quick = None;
        self.settle = None;
        if let Some(full) = self.full.take() {
            full.end();
            self.ending = Some(full);
        }
    }

    fn begin(&mut self, request: RenderRequest, after: Duration) {
        let Some(prepared) = &mut self.prepared else {
            return;
        };
        match Quick::first(
            self.number,
            prepared,
            &request,
            &mut self.divisor,
            &self.closing,
            &self.slot,
        ) {
            Ok(quick) => {
                self.quick = Some(quick);
                self.settle = Some(Instant::now() + after);
            }
            Err(error) => {
                self.slot.fail(self.number, error.to_string());
            }
        }
        self.request = Some(request);
    }

    fn pause(&mut self, paused: bool) {
        self.paused = paused;
        self.full.iter().for_each(|full| full.pause(paused));
    }

    /// Advances the renders between commands.
    fn go_on(&mut self) {
        if self.ending.as_ref().is_some_and(Full::is_finished) {
            self.spare = self.ending.take().and_then(Full::join);
        }
        let due = self.settle.is_some_and(|at| at <= Instant::now());
        if due && self.ending.is_none() && !self.paused {
            self.settle = None;
            if let (Some(prepared), Some(request)) = (&self.prepared, &self.request) {
                let (prepared, spare) = (prepared.copy(), self.spare.take());
                let slot = self.slot.clone();
                self.full = Some(Full::start(self.number, prepared, request.clone(), spare, slot));
            }
        }
        let whole = self.full.as_ref().is_some_and(Full::is_made);
        if let Some(quick) = &mut self.quick {
            if whole || quick.is_done() {
                self.quick = None;
            } else if let Err(error) = quick.step(&self.slot) {
                self.quick = None;
                self.slot.fail(self.number, error.to_string());
            }
        }
    }
}
