//! Scene probe before planning: measures the width of a pixel at the visible surfaces and the
//! number of records per photon. It always runs on the CPU, so that every engine plans alike.

use super::super::pack::PackedScene;
use super::kernels::eye_trace::eye_trace;
use super::kernels::photon_trace::photon_trace;
use super::kernels::records::{Dispatch, VisiblePoint};
use super::math::oct_decode;
use super::real::{Real, Vec3, consts};
use super::tables::SceneTables;
use crate::prepare::radius::{Automatic, automatic};
use crate::scene::settings::{Direct, Radius, RenderSettings};
use crate::telemetry::stage::stage;
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Number of eye paths.
const EYE_PATHS: u32 = 1024;
/// Number of photons.
const PHOTONS: u32 = 8192;
/// Maximum number of visible points at which the photon density is measured.
const DENSITIES: usize = 256;
/// Number of nearest photons in the disc of a density estimate.
const NEAREST: usize = 8;
/// Number of low bits of a record's key that hold the bounce.
const KEY_BITS: u32 = 16;
/// A pass number that no render reaches.
const PASS: u32 = u32::MAX;
/// Maximum start radius, for radii in pixels, relative to the median one.
const RADIUS_SPREAD: f64 = 4.0;

/// Results of the probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Median start radius over the image, in scene units.
    pub radius: f64,
    /// Maximum start radius, in scene units.
    pub radius_max: f64,
    /// Mean number of records per photon.
    pub records_per_photon: f64,
    /// The automatic start radius, if the settings request it.
    pub automatic: Option<Automatic>,
}

/// Probes the scene with a few eye paths and photons.
pub fn probe(packed: &PackedScene, settings: &RenderSettings) -> Probe {
    let _stage = stage("probe");
    let scene = &packed.tables;
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

/// Fraction of the photon flux, without light straight from lights, that has met only mirrors and
/// glass before.
fn caustic_share(scene: &SceneTables, dispatch: &Dispatch, photons: u32) -> f64 {
    let dispatch = Dispatch { key_bits: KEY_BITS, bounce_shift: 1, ..*dispatch };
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
    // Collect in order, so that the sum is always the same.
    let sums: Vec<[f64; 2]> = (0..photons).into_par_iter().map(photon).collect();
    let [caustic, all] = sums.iter().fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
    if all > 0.0 { caustic / all } else { 0.0 }
}

/// Number of photons on a pixel's footprint, as the median over the points; each point uses the
/// disc out to its [`NEAREST`]th photon.
fn density(points: &[VisiblePoint], records: &[Vec3]) -> f64 {
    let every = points.len().div_ceil(DENSITIES).max(1);
    let at = |point: &VisiblePoint| {
        let normal = oct_decode(point.normal);
        // As in `gather`, photons off the tangent plane lie on another surface.
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
