//! Frames: images in progress, and the slot through which render threads publish them.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::device::Wanted;
use crate::engine::{Engine, EngineError};
use crate::film::estimate::LEAST_PASSES;
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, RelativeError};
use crate::scene::settings::RenderSettings;
use crate::scene::{Camera, Film};

/// Minimum time between two frames of one render.
const EVERY: Duration = Duration::from_millis(100);
/// Reciprocal of the largest fraction of the time that publishing frames takes, and of that for
/// error estimates.
const SHARE: u32 = 10;

/// A scene view to render.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderRequest {
    /// Viewpoint and lens.
    pub camera: Camera,
    /// Image size, and channels in addition to radiance.
    pub film: Film,
    /// Render settings; `settings.passes` may change during the render.
    pub settings: RenderSettings,
    /// Device to render on.
    pub device: Wanted,
}

impl RenderRequest {
    /// Returns whether both requests need the same passes; only the number of passes may differ.
    pub fn same_passes(&self, other: &Self) -> bool {
        let passes = self.settings.passes;
        let settings = RenderSettings { passes, ..other.settings.clone() };
        *self == Self { settings, ..other.clone() }
    }
}

/// Device, settings and memory of a render.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// Name of the device.
    pub device: String,
    /// Reason for the choice of the device.
    pub why: String,
    /// Effective settings, with a number in place of an automatic radius.
    pub settings: RenderSettings,
    /// Bytes of the packed scene and the buffers.
    pub bytes: u64,
}

/// An image in progress.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Number of the [`RenderRequest`] that it belongs to.
    pub number: u64,
    /// True if it is a small preview image.
    pub quick: bool,
    /// Linear radiance.
    pub picture: Picture,
    /// Channels in addition to radiance.
    pub layers: Vec<Channel>,
    /// Error estimate of the passes; available from pass 4, and not always of the newest pass.
    pub errors: Option<Arc<ErrorMap>>,
    /// Number of passes at the time of the error estimate.
    pub estimated: u32,
    /// Relative error of the whole image, from the same estimate.
    pub error: Option<RelativeError>,
    /// Device, settings and memory of the render.
    pub setup: Arc<Setup>,
    /// Number of passes done.
    pub passes: u32,
    /// Number of photons emitted.
    pub photons: u64,
    /// Number of rays traced.
    pub rays: u64,
    /// Gather radius of the last pass, in scene units.
    pub radius: f64,
    /// Time spent in passes.
    pub elapsed: Duration,
}

impl Frame {
    /// Rays per second.
    pub fn rays_per_second(&self) -> f64 {
        self.rays as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }
}

/// Slot for the newest frame, failure and depth from the render threads.
pub struct FrameSlot {
    state: Mutex<State>,
    wake: Box<dyn Fn() + Send + Sync>,
}

#[derive(Default)]
struct State {
    number: u64,
    frame: Option<Arc<Frame>>,
    failure: Option<String>,
    depth: Option<f64>,
}

impl FrameSlot {
    /// An empty slot; `wake` is called after each change.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> Self {
        Self { state: Mutex::default(), wake: Box::new(wake) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, number: u64, change: impl FnOnce(&mut State)) -> bool {
        let mut state = self.state();
        let current = state.number == number;
        if current {
            change(&mut state);
        }
        drop(state);
        (self.wake)();
        current
    }

    /// Makes `number` the current request and clears the failure. The previous frame stays until
    /// there is a newer one.
    pub fn begin(&self, number: u64) {
        let mut state = self.state();
        state.number = number;
        state.failure = None;
    }

    /// Publishes a frame, unless a newer one is shown already. While requests arrive faster than
    /// frames, as in a drag, frames of older requests are shown. Returns whether the frame belongs
    /// to the newest request.
    pub fn show(&self, frame: Frame) -> bool {
        let mut state = self.state();
        let current = state.number == frame.number;
        if state.frame.as_ref().is_none_or(|shown| shown.number <= frame.number) {
            state.frame = Some(Arc::new(frame));
        }
        drop(state);
        (self.wake)();
        current
    }

    /// Reports a failure of request `number`; returns whether that is still the current request.
    pub fn fail(&self, number: u64, why: String) -> bool {
        self.change(number, |state| state.failure = Some(why))
    }

    /// Reports a measured depth, in units of the scene file.
    pub fn tell_depth(&self, depth: f64) {
        self.state().depth = Some(depth);
        (self.wake)();
    }

    /// The newest frame.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.state().frame.clone()
    }

    /// Reason why rendering failed, if it did.
    pub fn failure(&self) -> Option<String> {
        self.state().failure.clone()
    }

    /// The measured depth; returned once.
    pub fn take_depth(&self) -> Option<f64> {
        self.state().depth.take()
    }
}

/// Runs the passes of one engine and publishes their frames.
pub(super) struct Passes {
    number: u64,
    quick: bool,
    setup: Arc<Setup>,
    /// Number of passes done.
    pub done: u32,
    photons: u64,
    rays: u64,
    elapsed: Duration,
    errors: Option<Arc<ErrorMap>>,
    error: Option<RelativeError>,
    estimated: u32,
    estimating: Duration,
    next: Duration,
    begun: Instant,
}

impl Passes {
    pub fn new(number: u64, quick: bool, setup: Setup) -> Self {
        Self {
            number,
            quick,
            setup: Arc::new(setup),
            done: 0,
            photons: 0,
            rays: 0,
            elapsed: Duration::ZERO,
            errors: None,
            error: None,
            estimated: 0,
            estimating: Duration::ZERO,
            next: Duration::ZERO,
            begun: Instant::now(),
        }
    }

    /// Runs the next pass. Publishes a frame if enough time has passed, and always after the first
    /// and the last pass.
    pub fn step(
        &mut self,
        engine: &mut dyn Engine,
        last: u32,
        slot: &FrameSlot,
    ) -> Result<(), EngineError> {
        let begun = Instant::now();
        let report = engine.pass()?;
        self.elapsed += begun.elapsed();
        self.done += 1;
        self.photons += report.photons;
        self.rays += report.rays;
        let ended = self.done >= last;
        if self.begun.elapsed() < self.next && !ended {
            return Ok(());
        }
        let begun = Instant::now();
        let estimated = self.done >= LEAST_PASSES;
        if estimated && (ended || self.estimating * SHARE <= self.elapsed) {
            let errors = engine.errors()?;
            self.error = Some(errors.relative());
            self.estimated = self.done;
            self.errors = Some(Arc::new(errors));
            self.estimating += begun.elapsed();
        }
        slot.show(Frame {
            number: self.number,
            quick: self.quick,
            picture: engine.picture()?,
            layers: engine.layers()?,
            errors: self.errors.clone(),
            estimated: self.estimated,
            error: self.error,
            setup: self.setup.clone(),
            passes: self.done,
            photons: self.photons,
            rays: self.rays,
            radius: report.radius,
            elapsed: self.elapsed,
        });
        self.next = self.begun.elapsed() + EVERY.max(SHARE * begun.elapsed());
        Ok(())
    }
}
