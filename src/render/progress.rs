//! How far a render is, and where it will stop.

use std::time::Duration;

use crate::engine::{PassReport, PhotonEnds};
use crate::film::RelativeError;

/// When to stop; whichever comes first. At least one pass is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// After this many passes.
    pub passes: u32,
    /// No pass is begun after this time.
    pub time: Option<Duration>,
    /// Once the stated relative error (see [`RelativeError::stated`]) is no larger.
    pub target_error: Option<f64>,
}

/// How far a render is, after a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Where it will stop.
    pub stop: Stop,
    /// Passes made.
    pub passes: u32,
    /// Photon paths emitted.
    pub photons: u64,
    /// Eye paths traced.
    pub eye_paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// How the photon paths ended.
    pub ends: PhotonEnds,
    /// Gather radius of the last pass in scene units, mean over the visible points.
    pub radius: f64,
    /// Since the first pass began; of a render that was gone on from, that of all its parts
    /// together.
    pub elapsed: Duration,
    /// The newest estimate of the picture's error; none in the first passes.
    pub error: Option<RelativeError>,
}

impl Progress {
    /// Before the first pass.
    pub fn before(stop: Stop) -> Self {
        Self {
            stop,
            passes: 0,
            photons: 0,
            eye_paths: 0,
            rays: 0,
            ends: PhotonEnds::default(),
            radius: 0.0,
            elapsed: Duration::ZERO,
            error: None,
        }
    }

    /// Rays per second so far.
    pub fn rays_per_second(&self) -> f64 {
        self.rays as f64 / self.elapsed.as_secs_f64().max(1e-9)
    }

    /// Share of the work that is done, in [0, 1].
    pub fn share(&self) -> f64 {
        let passes = f64::from(self.passes) / f64::from(self.stop.passes.max(1));
        let time = self
            .stop
            .time
            .map_or(0.0, |time| self.elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9));
        // the error of progressive photon mapping falls as N^(-1/3) (Kaplanyan & Dachsbacher 2013),
        // or a little faster
        let error = match (self.stop.target_error, self.error) {
            (Some(target), Some(error)) => (target / error.stated).powi(3),
            _ => 0.0,
        };
        passes.max(time).max(error).min(1.0)
    }

    /// Time left if the passes go on as they did.
    pub fn remaining(&self) -> Duration {
        let share = self.share();
        let seconds = self.elapsed.as_secs_f64() * (1.0 - share) / share.max(1e-9);
        Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX)
    }

    pub(super) fn add(&mut self, report: &PassReport, elapsed: Duration) {
        self.passes += 1;
        self.photons = self.photons.saturating_add(report.photons);
        self.eye_paths = self.eye_paths.saturating_add(report.eye_paths);
        self.rays = self.rays.saturating_add(report.rays);
        self.ends.add(&report.ends);
        self.radius = report.radius;
        log::debug!(
            "pass {}: {:.3} s, {} photons, {} rays, radius {:.3e}",
            self.passes,
            elapsed.saturating_sub(self.elapsed).as_secs_f64(),
            report.photons,
            report.rays,
            report.radius
        );
        self.elapsed = elapsed;
    }

    pub(super) fn reached(&self) -> bool {
        let (target, error) = (self.stop.target_error, self.error);
        target.zip(error).is_some_and(|(target, error)| error.stated <= target)
    }
}
