//! Conversion of a validated scene to the tables that the kernels read.

mod bodies;
mod cells;
mod discs;
mod flat_regions;
mod image;
mod light;
mod look;
mod objects;
mod order;
mod pilots;
mod shape;
mod visibility;
mod walls;

pub use crate::engine::error::PackError;
pub use objects::Objects;

use super::lights::select::CELL_LEAF;
use super::materials::Bsdf;
use super::real::{Real, ToDouble, ToReal, Vec3};
use super::shapes::simd4::{FourRectangles, FourSpheres, LANES};
use super::tables::*;
use super::{accel, geometry, kernels, lights, materials, math, real, shapes, tables};
use crate::prepare::bodies::{Bodies, joined};
use crate::prepare::contact::grown;
use crate::prepare::learned::{Learned, LightSource};
use crate::prepare::normalize::{Normalization, reach};
use crate::scene::settings::{Method, RenderSettings};
use crate::scene::{self, MaterialKind, Reflectance};
use crate::telemetry::stage::stage;
use bytemuck::Zeroable;
use glam::{DVec2, DVec3};
use look::{Look, Region, look};
use std::f64::consts::PI;
use visibility::Visibility;

/// Photons of a light per pass below which its caustics may be missed.
const FEW_PHOTONS: f64 = 64.0;
/// Fraction of the light seen by the camera above which a light can cause a warning.
const LEAST_SHARE: f64 = 0.002;

/// A packed scene, and the factors that convert results to world units.
#[derive(Clone, Debug)]
pub struct Packed {
    /// Tables for the kernels.
    pub scene: Scene,
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
    normalization: Normalization,
    /// Power of each light; for light from infinity, per area.
    power: Vec<f64>,
    /// Scene element that each light comes from.
    sources: Vec<LightSource>,
    /// Fraction of the light seen by the camera that each light contributes, as far as pilots found
    /// it; empty if there were no pilots.
    brought: Vec<f64>,
    /// Number of entries of the distributions before the learned ones.
    flattened: usize,
}

/// Packs `scene` for an image of `width` by `height` pixels, and learns from pilot paths how to
/// sample its lights.
pub fn pack(scene: &scene::Scene, width: u32, height: u32) -> Result<Packed, PackError> {
    let mut packed = flatten(scene, Normalization::of(scene), width, height)?;
    let mut look = look(&packed.scene);
    if let Some(other) = packed.better_place(&look) {
        packed = flatten(scene, other, width, height)?;
        look = self::look(&packed.scene);
    }
    packed.learn(scene, &look);
    Ok(packed)
}

/// Like [`pack`], with the results that another precision has learned.
pub fn pack_like(
    scene: &scene::Scene,
    width: u32,
    height: u32,
    learned: &Learned,
) -> Result<Packed, PackError> {
    let mut packed = flatten(scene, learned.normalization, width, height)?;
    packed.take(learned);
    Ok(packed)
}

/// Packs `scene` without learning.
fn flatten(
    scene: &scene::Scene,
    n: Normalization,
    width: u32,
    height: u32,
) -> Result<Packed, PackError> {
    let _stage = stage("pack");
    let mut out = Scene::empty();
    out.camera = camera(scene, &n, width, height);
    image::pack_textures(scene, &mut out);
    for m in &scene.materials {
        out.materials.push(material(m, n.unit));
        let origin = image::reduced(DVec2::new(n.center.x, n.center.z), image::period(scene, m));
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
    let flattened = out.distributions.len();
    Ok(Packed {
        scene: out,
        center: n.center,
        unit: n.unit,
        radiance_unit,
        brightest,
        tree: stats,
        objects,
        normalization: n,
        power,
        sources,
        brought: Vec::new(),
        flattened,
    })
}

impl Packed {
    /// Moves the camera to that of `scene`. Everything else stays the same, including the results
    /// learned for the previous camera.
    pub fn move_camera(&mut self, scene: &scene::Scene, width: u32, height: u32) {
        self.scene.camera = camera(scene, &self.normalization, width, height);
        bodies::stand_camera(&mut self.scene);
    }

    /// Learns again for the current camera, so that the tables equal those of [`pack`]. Returns
    /// false, without learning, if `pack` might choose a different normalization.
    pub fn learn_again(&mut self, scene: &scene::Scene) -> bool {
        if self.normalization != Normalization::of(scene) {
            return false;
        }
        let look = look(&self.scene);
        if self.better_place(&look).is_some() {
            return false;
        }
        self.learn(scene, &look);
        true
    }

    /// A normalization that suits the region seen by the camera, if the current one does not.
    fn better_place(&self, look: &Look) -> Option<Normalization> {
        let region = look.region()?;
        let center = self.normalization.world(region.center.to_double());
        let radius = f64::from(region.radius) * self.unit;
        (!self.normalization.suits(center, radius)).then(|| Normalization::about(center, radius))
    }

    /// Learns emission discs, probabilities of lights, and guide maps.
    fn learn(&mut self, scene: &scene::Scene, look: &Look) {
        let _stage = stage("pilots");
        let n = &self.normalization;
        let out = &mut self.scene;
        out.distributions.truncate(self.flattened);
        // if nothing is seen, use the whole scene
        let all = Region { center: Vec3::ZERO, radius: (n.radius / n.unit) as Real };
        let region = look.region().unwrap_or(all);
        let (center, radius) =
            (n.world(region.center.to_double()), f64::from(region.radius) * n.unit);
        discs::learn_discs(out, look, region, reach(scene, center, radius) / n.unit);
        let area = PI * f64::from(region.radius) * f64::from(region.radius);
        let lights = out.lights.iter().zip(&self.power);
        let power: Vec<f64> = lights
            .map(|(light, power)| if light.kind >= LIGHT_SUN { area * power } else { *power })
            .collect();
        self.brought = pilots::learn_emission(out, &Visibility::new(look, region), &power);
        cells::learn_cells(out, look, &power);
    }

    /// Warnings about light that may be missing from an image with these settings and from its
    /// error estimate. Each one describes the light in terms of the scene file, and gives a remedy.
    pub fn warnings(&self, scene: &scene::Scene, settings: &RenderSettings) -> Vec<String> {
        let bsdfs = || self.scene.materials.iter().map(|m| Bsdf::of(m.kind));
        let path = settings.method == Method::Path;
        let focusing = bsdfs().any(|b| b.is_specular() || (!path && !b.is_wide()));
        let warning = |i: usize| {
            let (light, name) = (&self.scene.lights[i], self.sources[i].describe(scene));
            let photons = f64::from(settings.photons) * f64::from(light.selection);
            let brought = self.brought.get(i).copied().unwrap_or(0.0);
            if path && matches!(light.kind, LIGHT_POINT | LIGHT_SPOT | LIGHT_SUN) {
                return Some(format!(
                    "path tracing cannot meet {name}, which has no size: the light that it casts \
                     by mirrors or through glass is missing from the picture and from its stated \
                     error; use --method sppm"
                ));
            }
            (!path && photons < FEW_PHOTONS && brought > LEAST_SHARE).then(|| {
                format!(
                    "{name} sends {photons:.0} photons a pass but brings {:.1} % of the light: \
                     what it casts by mirrors or through glass may be missing from the picture and \
                     from its stated error; raise --photons",
                    100.0 * brought
                )
            })
        };
        if focusing { (0..self.sources.len()).filter_map(warning).collect() } else { Vec::new() }
    }

    /// The learned results.
    pub fn learned(&self) -> Learned {
        let (world, distributions) = (&self.scene.world, &self.scene.distributions);
        let base = self.flattened as u32;
        let double = |x: &Real| f64::from(*x);
        let guide = |light: &Light| (light.guide != 0).then(|| light.guide - base);
        let cell = |c: &Cell| {
            (f64::from(c.split), c.axis, if c.axis == CELL_LEAF { c.first - base } else { c.first })
        };
        Learned {
            normalization: self.normalization,
            near_center: world.near_center.to_double().to_array(),
            near_radius: f64::from(world.near_radius),
            disc_radius: f64::from(world.disc_radius),
            disc_levels: world.disc_levels,
            far: world.far,
            guided: world.guided,
            lights: distributions[..self.scene.lights.len()].iter().map(double).collect(),
            distributions: distributions[self.flattened..].iter().map(double).collect(),
            disc_first: world.disc_first.saturating_sub(base),
            guides: self.scene.lights.iter().map(guide).collect(),
            cells: self.scene.cells.iter().map(cell).collect(),
        }
    }

    /// Applies results that were learned in another precision.
    fn take(&mut self, learned: &Learned) {
        let base = self.flattened as u32;
        let out = &mut self.scene;
        out.world.near_center = DVec3::from(learned.near_center).to_real();
        out.world.near_radius = learned.near_radius as Real;
        out.world.disc_radius = learned.disc_radius as Real;
        out.world.disc_levels = learned.disc_levels;
        out.world.disc_first = base + learned.disc_first;
        out.world.far = learned.far;
        out.world.guided = learned.guided;
        let mut before = 0.0;
        for (i, end) in learned.lights.iter().enumerate() {
            out.distributions[i] = *end as Real;
            out.lights[i].selection = (end - before) as Real;
            out.lights[i].guide = learned.guides[i].map_or(0, |first| base + first);
            before = *end;
        }
        out.distributions.extend(learned.distributions.iter().map(|x| *x as Real));
        let cell = |&(split, axis, first): &(f64, u32, u32)| Cell {
            split: split as Real,
            axis,
            first: if axis == CELL_LEAF { base + first } else { first },
            pad: 0,
        };
        out.cells = learned.cells.iter().map(cell).collect();
    }
}

impl Scene {
    /// An empty scene.
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
