//! Interface between the render loop and the GPU and CPU engines.

pub mod error;
#[cfg(test)]
pub mod scripted;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::film::exr_file::Channel;
use crate::film::{ErrorMap, Picture, Rejections};
use crate::memory::OverBudget;
use crate::telemetry::clock::KernelSeconds;
use serde::{Deserialize, Serialize};

/// Number of photon paths by termination cause. The sum is the number of emitted paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhotonEnds {
    /// Paths that left the scene.
    pub escaped: u64,
    /// Paths absorbed by Russian roulette.
    pub absorbed: u64,
    /// Paths ended by `max_bounces`.
    pub cut: u64,
}

impl PhotonEnds {
    /// Creates the counts from an array in the order of `kernels::photon_trace`.
    pub fn of([escaped, absorbed, cut]: [u64; 3]) -> Self {
        Self { escaped, absorbed, cut }
    }

    /// Sum of all counts.
    pub fn total(&self) -> u64 {
        self.escaped + self.absorbed + self.cut
    }

    /// Adds the counts of another pass.
    pub fn add(&mut self, other: &Self) {
        self.escaped = self.escaped.saturating_add(other.escaped);
        self.absorbed = self.absorbed.saturating_add(other.absorbed);
        self.cut = self.cut.saturating_add(other.cut);
    }
}

/// Statistics of one pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassReport {
    /// Photon paths emitted in this pass.
    pub photons: u64,
    /// Photon records stored in this pass.
    pub records: u64,
    /// Eye paths traced in this pass.
    pub eye_paths: u64,
    /// Rays traced in this pass: eye, shadow and photon segments.
    pub rays: u64,
    /// Rays of eye paths and their shadow rays, included in `rays`.
    pub eye_rays: u64,
    /// Photon path terminations by cause.
    pub ends: PhotonEnds,
    /// Mean gather radius over the visible points, in scene units.
    pub radius: f64,
}

/// Engine state between two passes. Everything else follows from the scene, the settings and the
/// pass number. The byte formats are those of `kernels::bytes`, and are the same for all engines of
/// equal precision.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct State {
    /// Index of the first pass, from 0.
    pub first_pass: u32,
    /// Number of passes.
    pub passes: u32,
    /// Precision in bits, 32 or 64.
    pub bits: u32,
    /// Film; empty before the first pass.
    pub film: Vec<u8>,
    /// Statistics of the visible points for the local radius rule, otherwise empty.
    pub statistics: Vec<u8>,
    /// Data for the layers requested by the film in addition to radiance.
    pub layers: LayerState,
}

/// Data for layers in a [`State`]. Each vector is empty unless a layer needs it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LayerState {
    /// `AovPixel` for each pixel.
    pub aovs: Vec<u8>,
    /// `PartsPixel` for each pixel.
    pub parts: Vec<u8>,
    /// Photons gathered in the last pass, for each visible point.
    pub counts: Vec<u32>,
    /// Object ID at the center of each pixel, from 1; 0 for none.
    pub objects: Vec<u32>,
}

/// Conversion of scene units to world units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Space {
    /// World position of the scene's origin.
    pub center: [f64; 3],
    /// World units per scene unit.
    pub unit: f64,
    /// Factor from scene radiance to world radiance.
    pub radiance_unit: f64,
    /// True if photons are gathered.
    pub photons: bool,
    /// Luminance of the brightest emitter that eye paths may hit via mirrors or glass, in world
    /// units; 0 if there is none.
    #[serde(default)]
    pub glint: f64,
}

impl State {
    /// State before the first pass of a render that starts at pass `first_pass`.
    pub fn before(first_pass: u32) -> Self {
        Self { first_pass, ..Self::default() }
    }
}

/// Error of an engine.
#[derive(Debug, thiserror::Error)]
pub enum EngineError {
    /// A buffer or image exceeds a limit of the device.
    #[error("{what} needs {needed} bytes, but {device} allows {limit}; {mend}")]
    TooLarge {
        /// Buffer or image that does not fit.
        what: String,
        /// Required size in bytes.
        needed: u64,
        /// Device name.
        device: String,
        /// Maximum size in bytes.
        limit: u64,
        /// Suggested remedy.
        mend: String,
    },
    /// The render needs more memory than its budget.
    #[error(transparent)]
    OverBudget(Box<OverBudget>),
    /// The device was lost; the field contains the driver's message.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// The device is out of memory; the field describes the allocation.
    #[error("the device is out of memory: {0}; reduce the image size, or set --memory-budget")]
    OutOfMemory(String),
    /// A kernel failed to compile, which is a bug in caustica.
    #[error("shader: {0}")]
    Shader(String),
    /// The scene cannot be packed.
    #[error(transparent)]
    Pack(#[from] crate::engine::error::PackError),
    /// The engine does not support the operation.
    #[error("{0}")]
    Unsupported(String),
    /// The pass was cancelled; the film contains the passes before it.
    #[error("the pass was cancelled")]
    Cancelled,
}

/// Request to cancel the current pass of an engine. Clones share the request.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// Requests the cancellation. It cannot be withdrawn.
    pub fn ask(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns true if the cancellation is requested.
    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Fails if the cancellation is requested.
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
    /// Returns true if the device failed, so that the render may succeed on another device or at
    /// another time.
    pub fn is_of_device(&self) -> bool {
        matches!(self, Self::DeviceLost(_) | Self::OutOfMemory(_))
    }

    /// Returns true if the error would occur on any device.
    pub fn is_of_scene(&self) -> bool {
        matches!(self, Self::Pack(_))
    }
}

/// Renders passes of one scene with one set of settings.
pub trait Engine {
    /// Device name for display.
    fn device(&self) -> &str;
    /// Renders the next pass.
    fn pass(&mut self) -> Result<PassReport, EngineError>;
    /// Radiance estimate of the passes so far, in world units.
    fn picture(&mut self) -> Result<Picture, EngineError>;
    /// Error estimate of the passes so far, in world units.
    fn errors(&mut self) -> Result<ErrorMap, EngineError>;
    /// Counts of samples rejected in the passes so far.
    fn rejections(&mut self) -> Result<Rejections, EngineError>;
    /// Radiance estimate and rejections; an engine may read its film once for both.
    fn results(&mut self) -> Result<(Picture, Rejections), EngineError> {
        Ok((self.picture()?, self.rejections()?))
    }
    /// Returns true if the state can be lost with the device. False for engines whose state is in
    /// host memory.
    fn can_be_lost(&self) -> bool;
    /// Copies the state after the passes so far. After a failed pass, returns the state before that
    /// pass, or an error.
    fn save(&mut self) -> Result<State, EngineError>;
    /// Restores a saved state in an engine that has not rendered any pass. Further passes are
    /// bit-identical to those of the engine that saved it, for equal scenes and settings.
    fn restore(&mut self, state: &State) -> Result<(), EngineError>;
    /// Layers requested by the film in addition to radiance, in world units.
    fn layers(&mut self) -> Result<Vec<Channel>, EngineError>;
}

/// Engine whose work can be measured.
pub trait MeasuredEngine: Engine {
    /// Renders the next pass and measures the seconds of each kernel.
    fn timed_pass(&mut self) -> Result<(PassReport, KernelSeconds), EngineError>;
    /// Number of photons gathered by all visible points in the last pass.
    ///
    /// # Errors
    /// [`EngineError::Unsupported`] if tiles reuse the buffer that holds the counts.
    fn gathered(&mut self) -> Result<u64, EngineError>;
}
