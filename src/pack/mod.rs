//! Conversion of a validated scene to the tables that the kernels read.

pub mod albedo;
mod bodies;
mod flat_regions;
mod image;
mod instances;
mod layers;
mod light;
mod material;
mod objects;
mod order;
mod shape;
mod walls;
mod warnings;

pub use crate::engine::error::PackError;
pub use objects::Objects;

use super::camera::ProjectionKind;
use super::math::pixel_filter::FilterKind;
use super::real::{Real, ToReal, Vec3};
use super::shapes::simd4::{FourRectangles, FourSpheres, LANES};
use super::tables::*;
use super::{accel, camera, lights, materials, math, real, shapes, tables};
use crate::prepare::bodies::{Bodies, joined};
use crate::prepare::contact::grown;
use crate::prepare::learned::LightSource;
use crate::prepare::normalize::Normalization;
use crate::scene::{self, PixelFilter, Projection};
use crate::telemetry::stage::stage;
use bytemuck::Zeroable;
use glam::DVec3;

/// A packed scene, and the factors that convert results to world units.
#[derive(Clone, Debug)]
pub struct PackedScene {
    /// Tables for the kernels.
    pub tables: SceneTables,
    /// World point at the origin of scene space.
    pub center: DVec3,
    /// World units per scene unit.
    pub unit: f64,
    /// Factor from scene radiance to world radiance; it brings the brightest light near one.
    pub radiance_unit: f64,
    /// Luminance of the brightest extended light, in world units.
    pub brightest: f64,
    /// Statistics of the kd-tree.
    pub tree: accel::kdtree::Stats,
    /// Shapes and materials of table entries; without shapes unless the film requests them.
    pub objects: Objects,
    /// Position and scale of scene space in the world.
    pub normalization: Normalization,
    /// Power of each light; for light from infinity, per area.
    pub power: Vec<f64>,
    /// Scene element that each light comes from.
    pub sources: Vec<LightSource>,
    /// Fraction of the light seen by the camera that each light contributes, as far as pilots found
    /// it; empty if there were no pilots.
    pub contributions: Vec<f64>,
    /// First learned entry of the distributions.
    pub learned_from: usize,
}

/// Packs `scene` for an image of `width` by `height` pixels, in the scene space that `n` defines.
/// Photons start at lights in proportion to their power; [`pilots`](super::pilots) learn better
/// probabilities.
///
/// # Errors
/// [`PackError`] if the scene has more primitives or patches than references can name.
pub fn pack(
    scene: &scene::Scene,
    n: Normalization,
    width: u32,
    height: u32,
) -> Result<PackedScene, PackError> {
    let _stage = stage("pack");
    let mut out = SceneTables::empty();
    out.camera = camera(scene, &n, width, height);
    image::pack_textures(scene, &mut out);
    material::pack_materials(scene, &n, &mut out);
    let kinds = joined(scene);
    let bodies = Bodies::of(scene, &kinds);
    let kinds = grown(scene, kinds, &bodies, &n);
    let mut objects = Objects::default();
    let materials = bodies::pack_bodies(scene, &bodies, &mut out, &mut objects.materials);
    let groups = instances::pack_groups(scene, &kinds)?;
    let input = shape::Input {
        shapes: &scene.shapes,
        kinds: &kinds,
        materials: &materials,
        groups: Some(&groups),
    };
    let (primitives, references, mut emitters) =
        shape::pack_shapes(scene, input, &n, &mut out, Some(&mut objects))?;
    walls::find_walls(&mut out);
    let limit: usize = 1 << REFERENCE_BITS;
    if references.len() >= limit {
        return Err(PackError::TooMany { what: "primitives", count: references.len(), limit });
    }
    let mut stats = accel::kdtree::Stats::default();
    if !primitives.is_empty() {
        let tree = accel::kdtree::build(&primitives);
        stats = tree.stats;
        out.world.bounds_min = tree.bounds.min;
        out.world.bounds_max = tree.bounds.max;
        out.world.primitive_size = tree.primitive_size;
        out.nodes = tree.nodes;
        out.refs = tree.refs.iter().map(|&i| references[i as usize]).collect();
        let places = order::triangles_as_met(&mut out, &mut emitters);
        objects.move_triangles(&places);
    }
    out.four_rectangles = out.rectangles.chunks(LANES).map(FourRectangles::new).collect();
    out.four_spheres = out.spheres.chunks(LANES).map(FourSpheres::new).collect();
    groups.append(&mut out)?;
    out.world.unit = n.unit as Real;
    out.world.unbounded_count = out.unbounded.len() as u32;
    let light::PackedLights { radiance_unit, brightest, power, sources } =
        light::pack_lights(scene, &n, &emitters, &mut out);
    bodies::stand_camera(&mut out);
    bodies::stand_lights(&mut out);
    let learned_from = out.distributions.len();
    Ok(PackedScene {
        tables: out,
        center: n.center,
        unit: n.unit,
        radiance_unit,
        brightest,
        tree: stats,
        objects,
        normalization: n,
        power,
        sources,
        contributions: Vec::new(),
        learned_from,
    })
}

impl PackedScene {
    /// Moves the camera to that of `scene`. Everything else stays the same, including the results
    /// learned for the previous camera.
    pub fn move_camera(&mut self, scene: &scene::Scene, width: u32, height: u32) {
        self.tables.camera = camera(scene, &self.normalization, width, height);
        bodies::stand_camera(&mut self.tables);
    }
}

impl SceneTables {
    /// An empty scene.
    pub fn empty() -> Self {
        Self {
            world: World { environment: NONE, sun_discs: NONE, ..World::zeroed() },
            camera: Camera::zeroed(),
            spheres: Vec::new(),
            rectangles: Vec::new(),
            discs: Vec::new(),
            cuboids: Vec::new(),
            planes: Vec::new(),
            revolutions: Vec::new(),
            patches: Vec::new(),
            profile_points: Vec::new(),
            instances: Vec::new(),
            groups: Vec::new(),
            unbounded: Vec::new(),
            materials: Vec::new(),
            textures: Vec::new(),
            lights: Vec::new(),
            distributions: Vec::new(),
            cells: Vec::new(),
            nodes: Vec::new(),
            refs: Vec::new(),
            triangles: Vec::new(),
            attributes: Vec::new(),
            outlines: Vec::new(),
            texels: Vec::new(),
            four_rectangles: Vec::new(),
            four_spheres: Vec::new(),
        }
    }
}

fn camera(scene: &scene::Scene, n: &Normalization, width: u32, height: u32) -> Camera {
    let c = &scene.camera;
    let forward = (c.target - c.position).normalize();
    let right = forward.cross(c.up).normalize();
    let up = right.cross(forward);
    // lengths in the image: at distance one, in scene space or in radians
    let kind = projection(&c.projection);
    let unit = if kind == ProjectionKind::Orthographic { n.unit } else { 1.0 };
    let half_width = c.half_width(width, height) / unit;
    let half_height = c.half_height(width, height) / unit;
    let shift = right * (2.0 * c.shift[0] * half_width) + up * (2.0 * c.shift[1] * half_height);
    let position = match kind {
        ProjectionKind::Orthographic => n.point(c.position) + shift,
        ProjectionKind::Perspective | ProjectionKind::Panorama | ProjectionKind::Fisheye => {
            n.point(c.position)
        }
    };
    let focus = match c.projection {
        Projection::Fisheye { fov_degrees, .. } => 0.5 * fov_degrees.to_radians(),
        Projection::Perspective { .. } | Projection::Orthographic { .. } | Projection::Panorama => {
            c.focus / n.unit
        }
    };
    let (filter, [filter_size, filter_b, filter_c]) = pixel_filter(&scene.film.filter);
    Camera {
        position: position.to_real(),
        aperture: (c.aperture / n.unit) as Real,
        right: (right * half_width).to_real(),
        focus: focus as Real,
        up: (up * half_height).to_real(),
        pixel: (2.0 * half_height / height as f64) as Real,
        forward: forward.to_real(),
        width,
        lens_right: right.to_real(),
        height,
        lens_up: up.to_real(),
        medium: NONE,
        center: (forward + shift).to_real(),
        projection: kind as u32,
        filter_kind: filter as u32,
        filter_size: filter_size as Real,
        filter_b: filter_b as Real,
        filter_c: filter_c as Real,
    }
}

fn projection(projection: &Projection) -> ProjectionKind {
    match projection {
        Projection::Perspective { .. } => ProjectionKind::Perspective,
        Projection::Orthographic { .. } => ProjectionKind::Orthographic,
        Projection::Panorama => ProjectionKind::Panorama,
        Projection::Fisheye { .. } => ProjectionKind::Fisheye,
    }
}

/// Kind of a pixel filter, and its numbers as [`Camera::filter_size`], `filter_b` and `filter_c`.
fn pixel_filter(filter: &PixelFilter) -> (FilterKind, [f64; 3]) {
    match *filter {
        PixelFilter::Box { radius: 0.5 } => (FilterKind::Pixel, [0.5, 0.0, 0.0]),
        PixelFilter::Box { radius } => (FilterKind::Box, [radius, 0.0, 0.0]),
        PixelFilter::Tent { radius } => (FilterKind::Tent, [radius, 0.0, 0.0]),
        PixelFilter::Gaussian { sigma, radius } => {
            let inside = -(-0.5 * (radius / sigma).powi(2)).exp_m1();
            (FilterKind::Gaussian, [sigma, inside, 0.0])
        }
        PixelFilter::Mitchell { b, c } => {
            // the negative lobe is 6 c / (b + 6 c) wide
            let width = if c > 0.0 { 6.0 * c / (b + 6.0 * c) } else { 0.0 };
            (FilterKind::Mitchell, [3.0 + c * width.powi(3), b, c])
        }
    }
}

fn rgb(c: [f64; 3]) -> Vec3 {
    DVec3::from(c).to_real()
}
