//! Renders on disk: what an engine holds between two passes, and what tells whose it is.
//!
//! A render that goes on from one ends in the bits of a render that never stopped, and those of
//! ranges of passes merge into one. docs/checkpoints.md tells what is in the file and what is
//! promised.

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
    /// Which render.
    pub origin: Origin,
    /// What was done.
    pub totals: Totals,
    /// What the engine held.
    pub state: State,
    /// Merged: of each pixel, how many passes the film's `mean_at_pow2` and `mean_at_half_pow2` are means of; else
    /// empty.
    pub cuts: Vec<[u32; 2]>,
}

/// What the passes took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Totals {
    /// Photon paths emitted.
    pub photons: u64,
    /// Eye paths traced.
    pub eye_paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// How the photon paths ended.
    pub ends: PhotonEnds,
    /// Gather radius of the last pass in scene units.
    pub radius: f64,
    /// Time, of all parts together.
    pub elapsed: Duration,
}

impl Totals {
    /// Those of a render in progress.
    pub fn of(progress: &Progress) -> Self {
        let Progress { photons, eye_paths, rays, ends, radius, elapsed, .. } = *progress;
        Self { photons, eye_paths, rays, ends, radius, elapsed }
    }
}

impl Checkpoint {
    /// Where a render is that goes on from here.
    pub fn progress(&self, stop: Stop) -> Progress {
        let Totals { photons, eye_paths, rays, ends, radius, elapsed } = self.totals;
        let passes = self.state.passes;
        Progress { stop, passes, photons, eye_paths, rays, ends, radius, elapsed, error: None }
    }

    /// Number of the pass after the last one in it.
    pub fn end(&self) -> u32 {
        self.state.first_pass + self.state.passes
    }

    /// The picture, what it says of its error, and what was left out of it; the same bits that the
    /// render would have given.
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

    /// How its pictures came about.
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

    /// How its pictures are tone-mapped.
    pub fn development(&self) -> Development {
        Development {
            exposure: self.origin.exposure,
            tonemap: self.origin.tonemap,
            ..Development::default()
        }
    }
}
