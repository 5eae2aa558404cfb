//! Conversion of a validated scene to the tables that the kernels read.

mod bodies;
mod flat_regions;
mod glow;
mod image;
mod light;
mod objects;
mod order;
mod shape;
mod walls;
mod warnings;

pub use crate::engine::error::PackError;
pub use objects::Objects;

use super::materials::Bsdf;
use super::real::{Real, ToReal, Vec3};
use super::shapes::simd4::{FourRectangles, FourSpheres, LANES};
use super::tables::*;
use super::{accel, lights, materials, math, real, shapes, tables};
use crate::prepare::bodies::{Bodies, joined};
use crate::prepare::contact::grown;
use crate::prepare::learned::LightSource;
use crate::prepare::normalize::Normalization;
use crate::scene::{self, MaterialKind, Reflectance};
use crate::telemetry::stage::stage;
use bytemuck::Zeroable;
use glam::{DVec2, DVec3};

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
    for (index, m) in scene.materials.iter().enumerate() {
        out.materials.push(material(m, n.unit));
        // the texture of an emission may have another period
        let glows = |s: &scene::Shape| s.material == index && s.glow.texture.is_some();
        let period = match scene.shapes.iter().any(glows) {
            true => DVec2::INFINITY,
            false => image::period(scene, m),
        };
        let origin = image::reduced(DVec2::new(n.center.x, n.center.z), period);
        if let Some(last) = out.materials.last_mut() {
            last.planar_origin = origin.to_real();
        }
    }
    let kinds = joined(scene);
    let bodies = Bodies::of(scene, &kinds);
    let kinds = grown(scene, kinds, &bodies, &n);
    let mut objects = Objects::default();
    let materials = bodies::pack_bodies(scene, &bodies, &mut out, &mut objects.materials);
    let (primitives, references, mut emitters) =
        shape::pack_shapes(scene, &kinds, &materials, &n, &mut out, &mut objects)?;
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
    let tan = (0.5 * c.fov_degrees.to_radians()).tan();
    Camera {
        position: n.point(c.position).to_real(),
        aperture: (c.aperture / n.unit) as Real,
        right: (right * (tan * width as f64 / height as f64)).to_real(),
        focus: (c.focus / n.unit) as Real,
        up: (up * tan).to_real(),
        pixel: (2.0 * tan / height as f64) as Real,
        forward: forward.to_real(),
        width,
        lens_right: right.to_real(),
        height,
        lens_up: up.to_real(),
        medium: NONE,
    }
}

fn material(m: &scene::Material, unit: f64) -> Material {
    let mut out = Material::EMPTY;
    match m.kind.reflectance() {
        Some(Reflectance::Color(c)) => out.reflectance = rgb(*c),
        Some(Reflectance::Texture(t)) => out.texture = *t as u32,
        None => {}
    }
    let bsdf = match &m.kind {
        MaterialKind::Diffuse { roughness, .. } if *roughness > 0.0 => {
            out.alpha = *roughness as Real;
            Bsdf::RoughDiffuse
        }
        MaterialKind::Diffuse { .. } => Bsdf::Diffuse,
        MaterialKind::Translucent { transmission, .. } => {
            out.alpha = *transmission as Real;
            Bsdf::Translucent
        }
        MaterialKind::Mirror { .. } => Bsdf::Mirror,
        MaterialKind::Glass { ior, absorption, .. } => {
            out.ior = *ior as Real;
            out.absorption = rgb(absorption.map(|a| a * unit));
            Bsdf::Glass
        }
        MaterialKind::Metal { roughness, .. } => {
            out.alpha = ((roughness * roughness) as Real).max(materials::metal::ALPHA_MIN);
            Bsdf::Metal
        }
    };
    Material { kind: bsdf as u32, ..out }
}

fn rgb(c: [f64; 3]) -> Vec3 {
    DVec3::from(c).to_real()
}
