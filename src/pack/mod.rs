//! A validated scene flattened into the tables that the kernels read.

mod image;
mod light;
mod medium;
mod objects;
mod order;
mod shape;
mod walls;

pub use crate::error::PackError;
pub use objects::Objects;

use super::real::{Real, ToReal, Vec2, Vec3};
use super::shapes::fours::{FourRectangles, FourSpheres, LANES};
use super::tables::*;
use super::{build, lights, materials, math, real, shapes, tables};
use crate::build::normalize::Normalization;
use crate::scene::{self, MaterialKind, Reflectance};
use crate::stage::stage;
use bytemuck::Zeroable;
use glam::DVec3;

/// A flattened scene and what undoes its normalisation.
#[derive(Clone, Debug)]
pub struct Packed {
    /// The tables.
    pub scene: Scene,
    /// The world point at the scene's origin.
    pub center: DVec3,
    /// World units in one scene unit.
    pub unit: f64,
    /// Scene radiance times this is world radiance: brings the brightest light near one.
    pub radiance_unit: f64,
    /// Facts about the kd-tree.
    pub tree: build::kdtree::Stats,
    /// Which shape each reference belongs to; empty unless the film asks for it.
    pub objects: Objects,
}

/// Flattens `scene` for a picture of `width` by `height` pixels.
pub fn pack(scene: &scene::Scene, width: u32, height: u32) -> Result<Packed, PackError> {
    let _stage = stage("pack");
    let n = Normalization::of(scene);
    let mut out = Scene::empty();
    out.camera = camera(scene, &n, width, height);
    image::pack_textures(scene, &mut out);
    for m in &scene.materials {
        out.materials.push(material(m, n.unit));
    }
    let mut objects = Objects::default();
    let (primitives, references, mut emitters) = shape::pack_shapes(scene, &n, &mut out, &mut objects)?;
    walls::find_walls(&mut out);
    let limit = 1 << REFERENCE_BITS;
    if references.len() >= limit {
        return Err(PackError::TooMany { what: "primitives", count: references.len(), limit });
    }
    let mut stats = build::kdtree::Stats::default();
    if !primitives.is_empty() {
        let tree = build::kdtree::build(&primitives);
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
    out.world.planar_origin = Vec2::new(n.center.x as Real, n.center.z as Real);
    out.world.near_radius = n.near_radius as Real;
    out.world.unbounded_count = out.unbounded.len() as u32;
    let radiance_unit = light::pack_lights(scene, &n, &emitters, &mut out);
    out.world.disc_levels = disc_levels(&out, &n);
    out.world.nested = medium::glass_meets_glass(scene) as u32;
    stand_camera(&mut out);
    for i in 0..out.lights.len() {
        out.lights[i].medium = match light::place(&out, &out.lights[i]) {
            Some(position) => medium::medium_at(&out, position),
            None => NONE,
        };
    }
    lights::guide::learn_guides(&mut out);
    Ok(Packed { scene: out, center: n.center, unit: n.unit, radiance_unit, tree: stats, objects })
}

impl Packed {
    /// Takes the picture from where `scene`'s camera is now, everything else staying as it is. What `n` is not
    /// [the normalisation of](Normalization::of) any more has other roundings than a scene flattened anew.
    pub fn move_camera(&mut self, scene: &scene::Scene, n: &Normalization, width: u32, height: u32) {
        self.scene.camera = camera(scene, n, width, height);
        stand_camera(&mut self.scene);
    }
}

/// Finds the glass that the camera stands in.
fn stand_camera(out: &mut Scene) {
    out.camera.medium = medium::medium_at(out, out.camera.position);
}

impl Scene {
    /// A scene with nothing in it.
    pub fn empty() -> Self {
        Self {
            world: World { environment: NONE, ..World::zeroed() },
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
            nodes: Vec::new(),
            refs: Vec::new(),
            triangles: Vec::new(),
            attributes: Vec::new(),
            facets: Vec::new(),
            texels: Vec::new(),
            four_rectangles: Vec::new(),
            four_spheres: Vec::new(),
        }
    }
}

/// Emission discs that reach everything, if any light comes from infinity.
fn disc_levels(out: &Scene, n: &Normalization) -> u32 {
    let infinite = |l: &Light| matches!(l.kind, LIGHT_SUN | LIGHT_CONSTANT | LIGHT_IMAGE);
    if !out.lights.iter().any(infinite) {
        return 1;
    }
    // rounding alone must not add a disc twice as wide
    let doublings = (n.far_radius / n.near_radius).log2() - 1e-9;
    doublings.ceil().max(0.0) as u32 + 1
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
    let mut out = Material { texture: NONE, ior: 1.0, ..Material::zeroed() };
    let reflect = |out: &mut Material, r: &Reflectance| match r {
        Reflectance::Color(c) => out.reflectance = rgb(*c),
        Reflectance::Texture(t) => out.texture = *t as u32,
    };
    match &m.kind {
        MaterialKind::Diffuse { reflectance } => {
            out.kind = MATERIAL_DIFFUSE;
            reflect(&mut out, reflectance);
        }
        MaterialKind::Mirror { reflectance } => {
            out.kind = MATERIAL_MIRROR;
            reflect(&mut out, reflectance);
        }
        MaterialKind::Glass { ior, absorption } => {
            out.kind = MATERIAL_GLASS;
            out.ior = *ior as Real;
            out.absorption = rgb(absorption.map(|a| a * unit));
        }
        MaterialKind::Metal { reflectance, roughness } => {
            out.kind = MATERIAL_METAL;
            out.alpha = ((roughness * roughness) as Real).max(materials::metal::ALPHA_MIN);
            reflect(&mut out, reflectance);
        }
    }
    out
}

fn rgb(c: [f64; 3]) -> Vec3 {
    DVec3::from(c).to_real()
}
