//! What every engine (GPU or CPU) does for the render loop.

use crate::film::Picture;

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
    /// Gather radius of this pass in scene units: the mean over the visible points.
    pub radius: f64,
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
    /// The driver gave up; `0` says how.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// A kernel did not compile; a fault of this program.
    #[error("shader: {0}")]
    Shader(String),
    /// The scene cannot be flattened.
    #[error(transparent)]
    Pack(#[from] crate::error::PackError),
    /// The engine cannot carry out this method.
    #[error("{0}")]
    Unsupported(String),
}

/// Carries out passes over one scene with one set of settings.
pub trait Engine {
    /// The device's name, as printed.
    fn device(&self) -> &str;
    /// Runs the next pass.
    fn pass(&mut self) -> Result<PassReport, EngineError>;
    /// The estimate after the passes so far, in the scene's own radiometric units.
    fn picture(&mut self) -> Result<Picture, EngineError>;
}
