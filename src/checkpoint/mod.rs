//! Checkpoints: the engine state between two passes, and the identity of its render, on disk.
//!
//! A resumed render is bit-identical to an uninterrupted one, and checkpoints of pass ranges can be
//! merged. docs/checkpoints.md describes the file content and the guarantees.

mod compat;
mod error;
mod file;
mod layers;
mod merge;
mod origin;
mod values;

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::engine::{PhotonEnds, State};
use crate::film::{Development, ErrorMap, Picture, Provenance, Rejections};
use crate::render::{Progress, Stop};

pub use error::CheckpointError;
pub use file::{EXTENSION, check_place, decode, lock, read, write};
pub use merge::merge;
pub use origin::Origin;

/// A render between two passes.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// Identity of the render.
    pub origin: Origin,
    /// Totals over all passes.
    pub totals: Totals,
    /// Engine state.
    pub state: State,
    /// For each pixel of a merged checkpoint, the numbers of passes that the film's `mean_at_pow2`
    /// and `mean_at_half_pow2` average; empty if not merged.
    pub cuts: Vec<[u32; 2]>,
}

/// Totals over all passes, including earlier sessions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    /// Photon paths emitted.
    pub photons: u64,
    /// Eye paths traced.
    pub eye_paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Photon path terminations by cause.
    pub ends: PhotonEnds,
    /// Gather radius of the last pass in scene units.
    pub radius: f64,
    /// Render time.
    pub elapsed: Duration,
}

impl Totals {
    /// Totals of a render in progress.
    pub fn of(progress: &Progress) -> Self {
        let Progress { photons, eye_paths, rays, ends, radius, elapsed, .. } = *progress;
        Self { photons, eye_paths, rays, ends, radius, elapsed }
    }
}

impl Checkpoint {
    /// Progress of a render that resumes from this checkpoint.
    pub fn progress(&self, stop: Stop) -> Progress {
        let Totals { photons, eye_paths, rays, ends, radius, elapsed } = self.totals;
        let passes = self.state.passes;
        Progress { stop, passes, photons, eye_paths, rays, ends, radius, elapsed, error: None }
    }

    /// Index of the pass after the last one in the checkpoint.
    pub fn end(&self) -> u32 {
        self.state.first_pass + self.state.passes
    }

    /// Image, error estimate and rejections; bit-identical to those of the render.
    pub fn develop(&self) -> (Picture, ErrorMap, Rejections) {
        let film = merge::wide_film(&self.state);
        let readout = merge::readout(&self.origin);
        let passes = self.state.passes;
        let errors = match self.cuts.as_slice() {
            [] => readout.errors(&film, passes),
            cuts => readout.errors_by_parts(&film, passes, cuts),
        };
        (readout.picture(&film), errors, readout.rejections(&film))
    }

    /// Provenance of images developed from the checkpoint.
    pub fn provenance(&self) -> Provenance {
        Provenance {
            scene: self.origin.scene.clone(),
            scene_text: self.origin.scene_text.clone(),
            film: Some(self.origin.film()),
            materials: self.origin.materials.clone(),
            settings: self.origin.settings.clone(),
            device: self.origin.device.clone(),
            first_pass: self.state.first_pass,
            passes_done: self.state.passes,
            ..Provenance::default()
        }
    }

    /// Tone mapping of images developed from the checkpoint.
    pub fn development(&self) -> Development {
        Development {
            exposure: self.origin.exposure,
            tonemap: self.origin.tonemap,
            ..Development::default()
        }
    }
}
