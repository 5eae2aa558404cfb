//! Progress and stop conditions of a render.

use std::time::Duration;

use crate::engine::{PassReport, PhotonEnds};
use crate::film::RelativeError;

/// Stop conditions; the first to hold ends the render. At least one pass is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Maximum number of passes.
    pub passes: u32,
    /// Time limit; no pass starts after it.
    pub time: Option<Duration>,
    /// Target for the stated relative error (see [`RelativeError::stated`]).
    pub target_error: Option<f64>,
}

/// Progress of a render after a pass. Totals include earlier sessions of a resumed render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Stop conditions.
    pub stop: Stop,
    /// Completed passes.
    pub passes: u32,
    /// Photon paths emitted.
    pub photons: u64,
    /// Eye paths traced.
    pub eye_paths: u64,
    /// Rays traced.
    pub rays: u64,
    /// Photon path terminations by cause.
    pub ends: PhotonEnds,
    /// Mean gather radius of the last pass over the visible points, in scene units.
    pub radius: f64,
    /// Time since the first pass began, including earlier sessions.
    pub elapsed: Duration,
    /// Most recent error estimate; `None` during the first passes.
    pub error: Option<RelativeError>,
}

impl Progress {
    /// Progress before the first pass.
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

    /// Completed fraction of the work, in [0, 1].
    pub fn share(&self) -> f64 {
        let passes = f64::from(self.passes) / f64::from(self.stop.passes.max(1));
        let time = self
            .stop
            .time
            .map_or(0.0, |time| self.elapsed.as_secs_f64() / time.as_secs_f64().max(1e-9));
        // the error of progressive photon mapping decreases at least as fast as N^(-1/3)
        // (Kaplanyan & Dachsbacher 2013)
        let error = match (self.stop.target_error, self.error) {
            (Some(target), Some(error)) => (target / error.stated).powi(3),
            _ => 0.0,
        };
        passes.max(time).max(error).min(1.0)
    }

    /// Estimated remaining time, extrapolated from the completed passes.
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
