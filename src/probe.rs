//! A short look at the scene before planning: how wide a pixel is where the picture is, and how many records a
//! photon leaves. Always on the CPU, so that every engine plans alike.

use super::kernels::eye_trace::eye_trace;
use super::kernels::photon_trace::photon_trace;
use super::kernels::records::Dispatch;
use super::pack::Packed;
use super::real::Real;
use crate::settings::{Direct, Radius, RenderSettings};
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Eye paths looked at.
const EYE_PATHS: u32 = 1024;
/// Photons looked at.
const PHOTONS: u32 = 8192;
/// A pass number that no render reaches.
const PASS: u32 = u32::MAX;
/// The start radius, in pixels, is at most this many times the median one.
const RADIUS_SPREAD: f64 = 4.0;

/// What the look found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Median start radius over the picture, scene units.
    pub radius: f64,
    /// Greatest start radius allowed, scene units.
    pub radius_max: f64,
    /// Mean number of records a photon leaves.
    pub records_per_photon: f64,
}

/// Looks at the scene.
pub fn probe(packed: &Packed, settings: &RenderSettings) -> Probe {
    let scene = &packed.scene;
    let dispatch = Dispatch {
        pass_number: PASS,
        max_bounces: settings.max_bounces,
        eye_samples: 1,
        strata: 1,
        radius_pixels: 1.0,
        radius_max: Real::MAX,
        ..Dispatch::zeroed()
    };
    let (radius, radius_max) = match settings.radius {
        Radius::Units(units) => (units / packed.unit, units / packed.unit),
        Radius::Pixels(pixels) => {
            let total = scene.camera.width as u64 * scene.camera.height as u64;
            let mut widths: Vec<Real> = (0..EYE_PATHS as u64)
                .into_par_iter()
                .map(|i| {
                    let id = ((i * total + total / 2) / EYE_PATHS as u64).min(total - 1) as u32;
                    eye_trace(scene, &dispatch, false, id).0.radius
                })
                .filter(|r| *r > 0.0)
                .collect();
            widths.sort_unstable_by(Real::total_cmp);
            let median = widths.get(widths.len() / 2).copied().unwrap_or(scene.camera.pixel) as f64;
            (pixels * median, RADIUS_SPREAD * pixels * median)
        }
    };
    let sampled = settings.direct == Direct::Sampled;
    let records: u64 = if scene.lights.is_empty() {
        0
    } else {
        (0..PHOTONS)
            .into_par_iter()
            .map(|id| {
                let mut count = 0u64;
                let _ = photon_trace(scene, &dispatch, sampled, id, |_| count += 1);
                count
            })
            .sum()
    };
    Probe { radius, radius_max, records_per_photon: records as f64 / PHOTONS as f64 }
}
