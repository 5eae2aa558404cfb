//! What specialisation leaves out, put back: scenes with one thing more that nothing refers to, so
//! that its code is compiled and its tables are bound but the picture stays. Holding the two
//! against each other gives the gain as a figure.

use std::collections::BTreeMap;
use std::time::Instant;

use bytemuck::Zeroable;
use glam::{Vec2, Vec3};

use crate::cpu::CpuEngine;
use crate::engine::{Engine, EngineError};
use crate::features::Features;
use crate::film::Picture;
use crate::gpu::{AdapterChoice, GpuEngine};
use crate::pack::Packed;
use crate::plan::Plan;
use crate::settings::RenderSettings;
use crate::tables::*;

/// Features that a scene can be given without a change of its picture. The others change what is
/// rendered (`local`, `sampled`, `far`, `kdtree`, `unbounded`, `lens`, `environment`), or come with
/// one of these (`specular`, `lights`).
pub const BURDENS: [&str; 19] = [
    "sphere",
    "rectangle",
    "disc",
    "cuboid",
    "plane",
    "triangle",
    "attributes",
    "revolution",
    "mirror",
    "glass",
    "absorption",
    "metal",
    "checker",
    "texels",
    "area_sphere",
    "area_rectangle",
    "area_disc",
    "point",
    "spot",
];

/// The scene with one thing more of a feature of [`BURDENS`], which nothing refers to.
pub fn burdened(scene: &Scene, feature: &str) -> Scene {
    let mut scene = scene.clone();
    let material =
        |kind| Material { kind, ior: 1.5, alpha: 0.1, texture: NONE, ..Material::zeroed() };
    let light = |kind| Light { kind, ..Light::zeroed() };
    let area = |shape: u32| Light {
        kind: LIGHT_AREA,
        reference: shape << REFERENCE_BITS,
        ..Light::zeroed()
    };
    match feature {
        "sphere" => scene.spheres.push(Sphere::zeroed()),
        "rectangle" => scene.rectangles.push(Rectangle::zeroed()),
        "disc" => scene.discs.push(Disc::zeroed()),
        "cuboid" => scene.cuboids.push(Cuboid::zeroed()),
        "plane" => scene.planes.push(crate::tables::Plane::zeroed()),
        "triangle" => scene.triangles.push(Triangle::zeroed()),
        "attributes" => {
            scene.triangles.push(Triangle::zeroed());
            scene.attributes.push(Attributes::zeroed());
        }
        "revolution" => {
            scene.revolutions.push(Revolution::zeroed());
            scene.patches.push(Patch::zeroed());
            scene.profile_points.push(Vec2::ZERO);
        }
        "mirror" => scene.materials.push(material(MATERIAL_MIRROR)),
        "glass" => scene.materials.push(material(MATERIAL_GLASS)),
        "absorption" => {
            scene.materials.push(Material { absorption: Vec3::ONE, ..material(MATERIAL_GLASS) });
        }
        "metal" => scene.materials.push(material(MATERIAL_METAL)),
        "checker" => scene.textures.push(Texture { kind: TEXTURE_CHECKER, ..Texture::zeroed() }),
        "texels" => {
            scene.textures.push(Texture {
                kind: TEXTURE_IMAGE,
                width: 1,
                height: 1,
                ..Texture::zeroed()
            });
            scene.texels.resize(scene.texels.len() + 257, 0);
        }
        "area_sphere" => {
            scene.spheres.push(Sphere::zeroed());
            scene.lights.push(area(KIND_SPHERE));
        }
        "area_rectangle" => {
            scene.rectangles.push(Rectangle::zeroed());
            scene.lights.push(area(KIND_RECTANGLE));
        }
        "area_disc" => {
            scene.discs.push(Disc::zeroed());
            scene.lights.push(area(KIND_DISC));
        }
        "point" => scene.lights.push(light(LIGHT_POINT)),
        "spot" => scene.lights.push(light(LIGHT_SPOT)),
        _ => (),
    }
    scene
}

/// The scene with everything of [`BURDENS`] that `features` do without.
pub fn fully_burdened(scene: &Scene, features: &Features) -> Scene {
    left_out(features).into_iter().fold(scene.clone(), |scene, feature| burdened(&scene, feature))
}

/// What of [`BURDENS`] is left out.
pub fn left_out(features: &Features) -> Vec<&'static str> {
    BURDENS.into_iter().filter(|feature| !features.has(feature)).collect()
}

/// Seconds of one kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KernelCost {
    /// To compose, check and compile it, until it has run over nothing.
    pub compile: f64,
    /// In one pass, the least of several.
    pub run: f64,
}

/// A scene on a device: what each kernel takes, and the picture.
pub struct Costs {
    /// By the kernels' stems; on the CPU, whose code is compiled once for all scenes, by none.
    pub kernels: BTreeMap<&'static str, KernelCost>,
    /// Seconds of a pass, the least of several.
    pub pass: f64,
    /// The estimate after these passes.
    pub picture: Picture,
}

/// Times `passes` passes (at least one) on a GPU or a software driver, kernel by kernel.
pub fn on_gpu(
    choice: &AdapterChoice,
    packed: &Packed,
    settings: &RenderSettings,
    passes: u32,
) -> Result<Costs, EngineError> {
    let mut engine = GpuEngine::measured(choice, packed, Plan::new(packed, settings))?;
    let compiled = engine.compile_seconds().clone();
    let mut kernels: BTreeMap<&'static str, KernelCost> = compiled
        .iter()
        .map(|(kernel, seconds)| {
            (kernel.stem(), KernelCost { compile: seconds.total(), run: f64::INFINITY })
        })
        .collect();
    let mut pass = f64::INFINITY;
    for _ in 0..passes.max(1) {
        let (_, seconds) = engine.timed_pass()?;
        pass = pass.min(seconds.values().sum());
        for (kernel, seconds) in seconds {
            let cost = kernels.entry(kernel).or_default();
            cost.run = cost.run.min(seconds);
        }
    }
    Ok(Costs { kernels, pass, picture: engine.picture()? })
}

/// Times `passes` passes (at least one) on the CPU.
pub fn on_cpu(
    packed: Packed,
    settings: &RenderSettings,
    passes: u32,
) -> Result<Costs, EngineError> {
    let plan = Plan::new(&packed, settings);
    let mut engine = CpuEngine::new(packed, plan);
    let mut pass = f64::INFINITY;
    for _ in 0..passes.max(1) {
        let start = Instant::now();
        engine.pass()?;
        pass = pass.min(start.elapsed().as_secs_f64());
    }
    Ok(Costs { kernels: BTreeMap::new(), pass, picture: engine.picture()? })
}

/// Theory: what nothing refers to changes no bit, but is compiled.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::pack;
    use crate::scene;

    #[test]
    fn burdens_are_needed_and_change_no_bit() {
        let mut loaded = scene::load("scenes/soft-shadows.toml".as_ref()).unwrap();
        (loaded.scene.film.width, loaded.scene.film.height) = (24, 16);
        loaded.settings.photons = 500;
        loaded.settings.indirect_radius = Some(1.0);
        let packed = pack(&loaded.scene, 24, 16).unwrap();
        let features = Features::of(&packed.scene, &loaded.settings);
        let missing = left_out(&features);
        assert!(missing.len() > 5, "{missing:?}");
        for feature in &missing {
            let with = Features::of(&burdened(&packed.scene, feature), &loaded.settings);
            assert!(with.has(feature), "{feature}");
        }
        let mut heavy = packed.clone();
        heavy.scene = fully_burdened(&packed.scene, &features);
        let plain = on_cpu(packed.clone(), &loaded.settings, 2).unwrap();
        let burdened = on_cpu(heavy, &loaded.settings, 2).unwrap();
        assert!(plain.picture == burdened.picture);
        assert!(plain.picture.rgb.iter().flatten().any(|value| *value > 0.0));
        // A light that the choice does refer to would show.
        let mut brighter = packed.clone();
        brighter.scene.lights[0].color *= 2.0;
        assert!(on_cpu(brighter, &loaded.settings, 2).unwrap().picture != plain.picture);
    }
}
