//! What every engine (GPU or CPU) does for the render loop.

pub mod error;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::memory::OverBudget;
use crate::telemetry::clock::KernelSeconds;
use serde::{Deserialize, Serialize};

/// Photon paths by how they ended; together those that were emitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhotonEnds {
    /// Met nothing any more.
    pub escaped: u64,
    /// Ended by roulette, with the probability of being absorbed.
    pub absorbed: u64,
    /// Ended by `max_bounces`.
    pub cut: u64,
}

impl PhotonEnds {
    /// From the counts at the places that `kernels::photon_trace` gives them.
    pub fn of([escaped, absorbed, cut]: [u64; 3]) -> Self {
        Self { escaped, absorbed, cut }
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.escaped + self.absorbed + self.cut
    }

    /// Adds those of another pass.
    pub fn add(&mut self, other: &Self) {
        self.escaped = self.escaped.saturating_add(other.escaped);
        self.absorbed = self.absorbed.saturating_add(other.absorbed);
        self.cut = self.cut.saturating_add(other.cut);
    }
}

/// What one pass did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassReport {
    /// Photon paths emitted (photon mapping) in this pass.
    pub photons: u64,
    /// Photon records stored in this pass.
    pub records: u64,
    /// Eye paths traced in this pass.
    pub eye_paths: u64,
    /// Rays traced in this pass: eye, shadow and photon segments.
    pub rays: u64,
    /// Of these, those of eye paths and of their shadow rays.
    pub eye_rays: u64,
    /// How the photon paths ended.
    pub ends: PhotonEnds,
    /// Gather radius of this pass in scene units: the mean over the visible points.
    pub radius: f64,
}

/// What an engine keeps from pass to pass; everything else is made again from the scene, the
/// settings and the pass's number. The bytes are those of `kernels::bytes`, alike for all engines
/// that count in numbers of so many bits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct State {
    /// Number of the first pass in it, from 0.
    pub first_pass: u32,
    /// Passes in it.
    pub passes: u32,
    /// Bits of its numbers, 32 or 64.
    pub bits: u32,
    /// The film; empty before the first pass.
    pub film: Vec<u8>,
    /// Local radius rule: statistics of the visible points; else empty.
    pub statistics: Vec<u8>,
    /// What the film asks for in addition to radiance.
    pub layers: LayerState,
}

/// The part of a [`State`] that layers are made of; empty where none of them takes it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LayerState {
    /// By pixel: `AovPixel`.
    pub aovs: Vec<u8>,
    /// By pixel: `PartsPixel`.
    pub parts: Vec<u8>,
    /// By visible point: photons gathered in the last pass.
    pub counts: Vec<u32>,
    /// By pixel: the number of the surface seen through its centre, from 1; 0 is nothing.
    pub objects: Vec<u32>,
}

/// What tells an engine's numbers in those of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Space {
    /// The world point at the scene's origin.
    pub center: [f64; 3],
    /// World units in one scene unit.
    pub unit: f64,
    /// Scene radiance times this is world radiance.
    pub radiance_unit: f64,
    /// Whether photons are gathered.
    pub photons: bool,
    /// Luminance of the brightest thing that eye paths may meet by mirrors or through glass, world
    /// units; 0 where there is nothing of the kind.
    #[serde(default)]
    pub glint: f64,
}

impl State {
    /// Before any pass of a render that starts with pass number `first_pass`.
    pub fn before(first_pass: u32) -> Self {
        Self { first_pass, ..Self::default() }
    }
}

/// Why an engine stopped.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// The device cannot hold what the scene and the settings ask for.
    #[error("{what} needs {needed} bytes, but {device} allows {limit}; {mend}")]
    TooLarge {
        /// The buffer or picture that does not fit.
        what: String,
        /// Bytes asked for.
        needed: u64,
        /// The device's name.
        device: String,
        /// Bytes allowed.
        limit: u64,
        /// The setting to change.
        mend: String,
    },
    /// There may not be as much memory as the render takes.
    #[error(transparent)]
    OverBudget(Box<OverBudget>),
    /// The driver gave up; `0` says how.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// The device had no memory left; `0` says for what.
    #[error(
        "the device is out of memory: {0}; make the picture smaller, or take less by --memory-budget"
    )]
    OutOfMemory(String),
    /// A kernel did not compile; a fault of this program.
    #[error("shader: {0}")]
    Shader(String),
    /// The scene cannot be flattened.
    #[error(transparent)]
    Pack(#[from] crate::engine::error::PackError),
    /// The engine cannot carry out this method.
    #[error("{0}")]
    Unsupported(String),
    /// The pass was given up on request; the film holds the passes before it.
    #[error("the pass was given up")]
    Cancelled,
}

/// Asks an engine to give up the pass that it is at. Clones are one.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Asks for it, once and for all.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked for.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Fails once it was asked for.
    ///
    /// # Errors
    /// [`EngineError::Cancelled`].
    pub fn check(&self) -> Result<(), EngineError> {
        if self.is_asked() { Err(EngineError::Cancelled) } else { Ok(()) }
    }
}

impl From<OverBudget> for EngineError {
    fn from(over: OverBudget) -> Self {
        Self::OverBudget(Box::new(over))
    }
}

impl EngineError {
    /// Whether the device failed, so that the same render may go well on another one or another
    /// time.
    pub fn is_of_device(&self) -> bool {
        matches!(self, Self::DeviceLost(_) | Self::OutOfMemory(_))
    }

    /// Whether the same would be said of any device.
    pub fn is_of_scene(&self) -> bool {
        matches!(self, Self::Pack(_))
    }
}

/// Carries out passes over one scene with one set of settings.
pub trait Engine {
    /// The device's name, as printed.
    fn device(&self) -> &str;
    /// Runs the next pass.
    fn pass(&mut self) -> Result<PassReport, EngineError>;
    /// The same, and the seconds of each kernel in it; none where the engine cannot tell.
    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError> {
        Ok((self.pass()?, KernelSeconds::new()))
    }
    /// The estimate after the passes so far, in the scene's own radiometric units.
    fn picture(&mut self) -> Result<Picture, EngineError>;
    /// What the passes so far say of its error, in the same units.
    fn errors(&mut self) -> Result<ErrorMap, EngineError>;
    /// What the passes so far left out of it.
    fn rejections(&mut self) -> Result<Rejections, EngineError>;
    /// Both.
    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        Ok((self.picture()?, self.rejections()?))
    }
    /// Whether it can fail and take along what it holds. One that counts in the program's own
    /// memory does not.
    fn can_be_lost(&self) -> bool {
        true
    }
    /// After `error`: goes on from `state` on another device.
    ///
    /// # Errors
    /// Where there is none that can: the last one's error.
    fn go_on(&mut self, state: &State, error: EngineError) -> Result<(), EngineError> {
        let _ = state;
        Err(error)
    }
    /// What the passes so far left behind. After a pass that failed it is that of the passes
    /// before, or an error.
    fn save(&mut self) -> Result<State, EngineError> {
        Err(EngineError::Unsupported(format!("{} cannot hand over what it holds", self.device())))
    }
    /// Goes on from there, with the same bits as the engine that saved it, if both have one scene
    /// and one set of settings. For an engine that has made no pass.
    fn restore(&mut self, state: &State) -> Result<(), EngineError> {
        let _ = state;
        Err(EngineError::Unsupported(format!(
            "{} cannot take over what another one holds",
            self.device()
        )))
    }
    /// What the film asks for in addition to radiance, in world units.
    fn layers(&mut self) -> Result<Vec<Channel>, EngineError> {
        Ok(Vec::new())
    }
    /// Photons that the last pass found around all visible points; 0 where the engine does not
    /// tell.
    fn gathered(&mut self) -> Result<u64, EngineError> {
        Ok(0)
    }
}
