//! Pilot eye paths: the points that the camera sees, and the points that those face, where indirect
//! light comes from. The emission of photons and the selection of lights depend on them. The
//! camera's own position is not among them.

use super::geometry::intersect::intersect_scene;
use super::geometry::surface::surface_at;
use super::kernels::eye_trace::eye_trace;
use super::kernels::records::{Dispatch, VisiblePoint};
use super::materials::shading::toward;
use super::math::rng::pcg4d;
use super::math::sampling::sample_cosine;
use super::math::{FAR, from_frame, oct_decode, offset_origin};
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Ray;
use super::tables::{NONE, SceneTables};
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Number of pilot eye paths.
const EYE_PATHS: u64 = 8192;
/// Maximum number of scattering events of a pilot eye path.
const BOUNCES: u32 = 32;
/// Fraction of the visible points that the near sphere contains before [`MARGIN`] enlarges it.
const NEAR: f64 = 0.9;
/// Factor on the radius of the near sphere, because gather discs extend beyond the visible points.
const MARGIN: Real = 2.0;
/// A stream of random numbers that no kernel uses.
const STREAM: u32 = 0x2000_0000;

/// A surface point that a pilot path found.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Position in scene space.
    pub position: Vec3,
    /// Geometric normal, on the side that the path came from.
    pub normal: Vec3,
    /// Width of the pixel's footprint, in scene units.
    pub footprint: Real,
}

/// Results of the pilot eye paths.
#[derive(Clone, Debug, Default)]
pub struct EyePilots {
    /// First non-specular hits.
    pub seen: Vec<Seen>,
    /// Points that the surfaces at `seen` face, where indirect light comes from.
    pub faced: Vec<Seen>,
}

/// A sphere that contains most of the surfaces that matter for the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Center, in scene space.
    pub center: Vec3,
    /// Radius, in scene units.
    pub radius: Real,
}

/// Traces the pilot eye paths.
pub fn trace_eye_pilots(scene: &SceneTables) -> EyePilots {
    let dispatch = Dispatch {
        pass_number: u32::MAX,
        max_bounces: BOUNCES,
        eye_samples: 1,
        strata: 1,
        radius_pixels: 1.0,
        radius_max: Real::MAX,
        window_width: scene.camera.width,
        ..Dispatch::zeroed()
    };
    let total = u64::from(scene.camera.width) * u64::from(scene.camera.height);
    // more paths than pixels: the seed moves them within the pixels
    let found: Vec<(Seen, Option<Seen>)> = (0..EYE_PATHS)
        .into_par_iter()
        .filter_map(|i| {
            let id = ((i * total + total / 2) / EYE_PATHS).min(total - 1) as u32;
            let point = eye_trace(scene, &Dispatch { seed: i as u32, ..dispatch }, false, id).0;
            let seen = seen(&point)?;
            Some((seen, faced(scene, &seen, i as u32)))
        })
        .collect();
    EyePilots {
        seen: found.iter().map(|(seen, _)| *seen).collect(),
        faced: found.iter().filter_map(|(_, faced)| *faced).collect(),
    }
}

fn seen(point: &VisiblePoint) -> Option<Seen> {
    let normal = oct_decode(point.normal);
    let (position, footprint) = (point.position, point.radius);
    (footprint > 0.0).then_some(Seen { position, normal, footprint })
}

/// A random point that the surface at `seen` faces; `None` if the ray leaves the scene.
fn faced(scene: &SceneTables, seen: &Seen, id: u32) -> Option<Seen> {
    let number = |word: u32| (word >> 8) as Real * (1.0 / 16777216.0);
    let u = pcg4d([id, 0, STREAM, 0]);
    let direction = from_frame(seen.normal, sample_cosine(Vec2::new(number(u[0]), number(u[1]))));
    let origin = offset_origin(seen.position, seen.footprint * 1e-3, seen.normal, direction);
    let ray = Ray { origin, t_min: 0.0, direction, t_max: FAR };
    let hit = intersect_scene(scene, &ray);
    if hit.reference == NONE {
        return None;
    }
    let s = surface_at(scene, &ray, &hit);
    Some(Seen { position: s.position, normal: toward(s.normal, -direction), ..*seen })
}

impl EyePilots {
    /// A sphere about the median of the visible points, with twice the radius that contains nine
    /// tenths of them; `None` if the camera sees no surface.
    pub fn region(&self) -> Option<Region> {
        let median = |axis: usize| {
            let values: Vec<Real> = self.seen.iter().map(|seen| seen.position[axis]).collect();
            quantile(values, 0.5)
        };
        let center = Vec3::new(median(0)?, median(1)?, median(2)?);
        let distances = self.seen.iter().map(|seen| (seen.position - center).length());
        let radius = MARGIN * quantile(distances.collect(), NEAR)?;
        (radius > 0.0).then_some(Region { center, radius })
    }

    /// All points of both kinds.
    pub fn points(&self) -> impl Iterator<Item = &Seen> {
        self.seen.iter().chain(&self.faced)
    }

    /// Median footprint of a pixel, in scene units; 0 if nothing is seen.
    pub fn footprint(&self) -> Real {
        quantile(self.seen.iter().map(|seen| seen.footprint).collect(), 0.5).unwrap_or(0.0)
    }
}

fn quantile(mut values: Vec<Real>, share: f64) -> Option<Real> {
    let at = (share * values.len() as f64) as usize;
    if at >= values.len() {
        return None;
    }
    Some(*values.select_nth_unstable_by(at, Real::total_cmp).1)
}
