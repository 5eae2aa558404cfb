//! What the camera sees: visible points of pilot eye paths, and where the light that scatters
//! toward them comes from. Emission and the choice of lights follow from it. The camera's own place
//! does not count.

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
use super::tables::{NONE, Scene};
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Pilot eye paths.
const EYE_PATHS: u64 = 8192;
/// Scattering events of a pilot eye path.
const BOUNCES: u32 = 32;
/// Share of the points that the near sphere holds.
const NEAR: f64 = 0.9;
/// The near sphere is this many times as wide as that: discs gather beyond what is seen.
const MARGIN: Real = 2.0;
/// A stream of random numbers that no kernel has.
const STREAM: u32 = 0x2000_0000;

/// A surface point that a pilot found.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// In scene space.
    pub position: Vec3,
    /// Geometric normal on the side that the pilot came from.
    pub normal: Vec3,
    /// Width of the pixel's footprint, scene units.
    pub footprint: Real,
}

/// What pilots found.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// First non-specular hits.
    pub seen: Vec<Seen>,
    /// What surfaces at `seen` face: where indirect light comes from.
    pub faced: Vec<Seen>,
}

/// A sphere that holds most of what matters for the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Center, scene space.
    pub center: Vec3,
    /// Radius, scene units.
    pub radius: Real,
}

/// Traces the pilots.
pub fn look(scene: &Scene) -> Look {
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
    Look {
        seen: found.iter().map(|(seen, _)| *seen).collect(),
        faced: found.iter().filter_map(|(_, faced)| *faced).collect(),
    }
}

fn seen(point: &VisiblePoint) -> Option<Seen> {
    let normal = oct_decode(point.normal);
    let (position, footprint) = (point.position, point.radius);
    (footprint > 0.0).then_some(Seen { position, normal, footprint })
}

/// A point that the surface at `seen` faces.
fn faced(scene: &Scene, seen: &Seen, id: u32) -> Option<Seen> {
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

impl Look {
    /// A sphere about the median of the visible points, twice as wide as holds nine of ten of them;
    /// nothing where the camera sees no surface.
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

    /// All points.
    pub fn points(&self) -> impl Iterator<Item = &Seen> {
        self.seen.iter().chain(&self.faced)
    }

    /// Median footprint of a pixel; 0 where nothing is seen.
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
