//! A short look at the scene before planning: how wide a pixel is where the picture is, and how
//! many records a photon leaves. Always on the CPU, so that every engine plans alike.

use super::kernels::eye_trace::eye_trace;
use super::kernels::photon_trace::photon_trace;
use super::kernels::records::{Dispatch, VisiblePoint};
use super::math::oct_decode;
use super::pack::Packed;
use super::real::{Real, Vec3, consts};
use super::tables::Scene;
use crate::prepare::radius::{Automatic, automatic};
use crate::scene::settings::{Direct, Radius, RenderSettings};
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Eye paths looked at.
const EYE_PATHS: u32 = 1024;
/// Photons looked at.
const PHOTONS: u32 = 8192;
/// Visible points at which the photons' density is looked at.
const DENSITIES: usize = 256;
/// The density is that of the disc out to this many photons.
const NEAREST: usize = 8;
/// Bits of a record's key that hold the bounce.
const KEY_BITS: u32 = 16;
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
    /// The start radius in pixels, where the settings leave it open.
    pub automatic: Option<Automatic>,
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
        window_width: scene.camera.width,
        ..Dispatch::zeroed()
    };
    let sampled = settings.direct == Direct::Sampled;
    let photon = |id| {
        let mut positions = Vec::new();
        let _ =
            photon_trace(scene, &dispatch, sampled, id, |record| positions.push(record.position));
        positions
    };
    let photons = if scene.lights.is_empty() { 0 } else { PHOTONS };
    let records: Vec<Vec3> = (0..photons).into_par_iter().flat_map_iter(photon).collect();
    let total = scene.camera.width as u64 * scene.camera.height as u64;
    let points: Vec<VisiblePoint> = match settings.radius {
        Radius::Units(_) => Vec::new(),
        _ => (0..EYE_PATHS as u64)
            .into_par_iter()
            .map(|i| {
                let id = ((i * total + total / 2) / EYE_PATHS as u64).min(total - 1) as u32;
                eye_trace(scene, &dispatch, false, id).0
            })
            .filter(|point| point.radius > 0.0)
            .collect(),
    };
    let automatic = (settings.radius == Radius::Auto).then(|| {
        let density = density(&points, &records) * settings.photons as f64 / PHOTONS as f64;
        automatic(
            density,
            settings.photons as f64 / total as f64,
            caustic_share(scene, &dispatch, photons),
        )
    });
    let widths = points.iter().map(|point| point.radius).collect();
    let width = median(widths).unwrap_or(scene.camera.pixel) as f64;
    let (radius, radius_max) = match (settings.radius, automatic) {
        (Radius::Units(units), _) => (units / packed.unit, units / packed.unit),
        (Radius::Pixels(pixels), _) | (Radius::Auto, Some(Automatic { pixels, .. })) => {
            (pixels * width, RADIUS_SPREAD * pixels * width)
        }
        (Radius::Auto, None) => (width, RADIUS_SPREAD * width),
    };
    Probe {
        radius,
        radius_max,
        records_per_photon: records.len() as f64 / PHOTONS as f64,
        automatic,
    }
}

/// Share of the light not straight from lights that met nothing but mirrors and glass before.
fn caustic_share(scene: &Scene, dispatch: &Dispatch, photons: u32) -> f64 {
    let dispatch = Dispatch { key_bits: KEY_BITS, ..*dispatch };
    let photon = |id| {
        let (mut caustic, mut all, mut first) = (0.0, 0.0, true);
        let _ = photon_trace(scene, &dispatch, false, id, |record| {
            let flux = record.flux.dot(Vec3::ONE) as f64;
            let straight = first && record.key & ((1 << KEY_BITS) - 1) == 0;
            all += if straight { 0.0 } else { flux };
            caustic += if first && !straight { flux } else { 0.0 };
            first = false;
        });
        [caustic, all]
    };
    // In order, so that the sum is always the same.
    let sums: Vec<[f64; 2]> = (0..photons).into_par_iter().map(photon).collect();
    let [caustic, all] = sums.iter().fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
    if all > 0.0 { caustic / all } else { 0.0 }
}

/// Photons on a pixel's footprint, median over the points: each counts as far as its [`NEAREST`]th.
fn density(points: &[VisiblePoint], records: &[Vec3]) -> f64 {
    let every = points.len().div_ceil(DENSITIES).max(1);
    let at = |point: &VisiblePoint| {
        let normal = oct_decode(point.normal);
        // As in `gather`, what is off the tangent plane lies on another surface.
        let near = |d: &Vec3| (4.0 * d.dot(normal)).powi(2) <= d.dot(*d);
        let differences = records.iter().map(|position| *position - point.position);
        let mut distances: Vec<Real> = differences.filter(near).map(|d| d.dot(d)).collect();
        if distances.len() < NEAREST {
            return 0.0;
        }
        let (_, reach_sq, _) = distances.select_nth_unstable_by(NEAREST - 1, Real::total_cmp);
        NEAREST as Real * point.radius * point.radius
            / (consts::PI * reach_sq.max(Real::MIN_POSITIVE))
    };
    let chosen: Vec<&VisiblePoint> = points.iter().step_by(every).collect();
    median(chosen.into_par_iter().map(at).collect()).unwrap_or(0.0) as f64
}

fn median(mut values: Vec<Real>) -> Option<Real> {
    values.sort_unstable_by(Real::total_cmp);
    values.get(values.len() / 2).copied()
}
