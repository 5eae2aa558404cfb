//! What a render thread shows, and where it puts it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::device::Wanted;
use crate::engine::{Engine, EngineError};
use crate::film::estimate::LEAST_PASSES;
use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, RelativeError};
use crate::scene::settings::RenderSettings;
use crate::scene::{Camera, Film};

/// Least time between two pictures of one render.
const EVERY: Duration = Duration::from_millis(100);
/// Showing takes at most one part in so many of the time, and so does estimating the error.
const SHARE: u32 = 10;

/// What is to be seen of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderRequest {
    /// From where.
    pub camera: Camera,
    /// Size, and what is wanted in addition to radiance.
    pub film: Film,
    /// How; `settings.passes` may change while it is rendered.
    pub settings: RenderSettings,
    /// On which device.
    pub device: Wanted,
}

impl RenderRequest {
    /// Whether the same passes serve both; only their number may differ.
    pub fn same_passes(&self, other: &Self) -> bool {
        let passes = self.settings.passes;
        let settings = RenderSettings { passes, ..other.settings.clone() };
        *self == Self { settings, ..other.clone() }
    }
}

/// What a render runs on and with.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The device's name.
    pub device: String,
    /// Why that one.
    pub why: String,
    /// The settings in force, a radius in the place of "auto".
    pub settings: RenderSettings,
    /// Bytes of the flattened scene and of the buffers.
    pub bytes: u64,
}

/// A picture on its way.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Number of the [`RenderRequest`] that it is for.
    pub number: u64,
    /// Whether it is a small one, made to be there soon.
    pub quick: bool,
    /// Linear radiance.
    pub picture: Picture,
    /// What is wanted beside it.
    pub layers: Vec<Channel>,
    /// What the passes say of its error; from the fourth pass on, and not always the newest.
    pub errors: Option<Arc<ErrorMap>>,
    /// The pass after which it was found.
    pub estimated: u32,
    /// The same of the whole picture.
    pub error: Option<RelativeError>,
    /// What it was made with.
    pub setup: Arc<Setup>,
    /// Passes made.
    pub passes: u32,
    /// Photons emitted.
    pub photons: u64,
    /// Rays traced.
    pub rays: u64,
    /// Gather radius of the last pass, scene units.
    pub radius: f64,
    /// Spent in passes.
    pub elapsed: Duration,
}

impl Frame {
    /// Rays per second.
    pub fn rays_per_second(&self) -> f64 {
        self.rays as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }
}

/// Where render threads put what there is to see; the newest of each.
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
    /// An empty one; `wake` is called after each change.
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

    /// From now on only what wish `number` brings counts. The last picture stays until then.
    pub fn begin(&self, number: u64) {
        let mut state = self.state();
        state.number = number;
        state.failure = None;
    }

    /// Shows a picture, unless a newer one is shown already: while wishes come faster than
    /// pictures, as in a drag, the last one that there is. Whether it is of the newest wish.
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

    /// Tells why there are no more pictures.
    pub fn fail(&self, number: u64, why: String) -> bool {
        self.change(number, |state| state.failure = Some(why))
    }

    /// Tells the depth that was looked for.
    pub fn tell_depth(&self, depth: f64) {
        self.state().depth = Some(depth);
        (self.wake)();
    }

    /// The newest picture.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.state().frame.clone()
    }

    /// Why there are no more.
    pub fn failure(&self) -> Option<String> {
        self.state().failure.clone()
    }

    /// The depth that was looked for, once.
    pub fn take_depth(&self) -> Option<f64> {
        self.state().depth.take()
    }
}

/// The passes of one engine and what is shown of them.
pub(super) struct Passes {
    number: u64,
    quick: bool,
    setup: Arc<Setup>,
    /// Passes made.
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

    /// Makes the next pass and shows the picture if it is time, after the first pass and after the
    /// last one always.
    pub fn step(
        &mut self,
        engine: &mut dyn Engine,
        last: u32,
        board: &FrameSlot,
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
        board.show(Frame {
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
