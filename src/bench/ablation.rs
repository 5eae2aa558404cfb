//! Ablation: measures the gain of specialisation. Adds unused items to a scene, so that their code
//! is compiled and their tables are bound, but the image stays the same.

use std::collections::BTreeMap;
use std::time::Instant;

use bytemuck::Zeroable;
use glam::{Vec2, Vec3};

use crate::cpu::CpuEngine;
use crate::engine::{Engine, EngineError, MeasuredEngine};
use crate::film::Picture;
use crate::gpu::{AdapterChoice, GpuEngine};
use crate::lights::LightKind;
use crate::materials::Bsdf;
use crate::pack::PackedScene;
use crate::plan::Plan;
use crate::plan::features::{Feature, Features};
use crate::scene::settings::RenderSettings;
use crate::tables::*;

/// Returns the scene with one unused item that requires `feature`. `None` for features that cannot
/// be added alone or that change the image.
pub fn with_unused(scene: &SceneTables, feature: Feature) -> Option<SceneTables> {
    let mut scene = scene.clone();
    let material = |bsdf| Material { kind: bsdf as u32, ior: 1.5, alpha: 0.1, ..Material::EMPTY };
    let light = |kind| Light { kind, ..Light::zeroed() };
    let area = |shape: u32| Light {
        kind: LightKind::Area as u32,
        reference: reference(shape, 0),
        ..Light::zeroed()
    };
    match feature {
        Feature::Sphere => scene.spheres.push(Sphere::zeroed()),
        Feature::Rectangle => scene.rectangles.push(Rectangle::zeroed()),
        Feature::Disc => scene.discs.push(Disc::zeroed()),
        Feature::Cuboid => scene.cuboids.push(Cuboid::zeroed()),
        Feature::Plane => scene.planes.push(crate::tables::Plane::zeroed()),
        Feature::Triangle => scene.triangles.push(Triangle::zeroed()),
        Feature::Attributes => {
            scene.triangles.push(Triangle::zeroed());
            scene.attributes.push(Attributes::zeroed());
        }
        Feature::Revolution => {
            scene.revolutions.push(Revolution::zeroed());
            scene.patches.push(Patch::zeroed());
            scene.profile_points.push(Vec2::ZERO);
        }
        Feature::Material(bsdf) => scene.materials.push(material(bsdf)),
        Feature::Coated => {
            scene.materials.push(Material { coated: 1.0 / 1.5, ..material(Bsdf::Metal) });
        }
        Feature::LobeParameters => scene.materials.push(material(Bsdf::Conductor)),
        Feature::Layered => scene.materials.push(material(Bsdf::Mix)),
        Feature::Absorption => {
            scene.materials.push(Material { absorption: Vec3::ONE, ..material(Bsdf::Glass) });
        }
        Feature::Checker => {
            scene.textures.push(Texture { kind: TEXTURE_CHECKER, ..Texture::zeroed() });
        }
        Feature::Texels => {
            scene.textures.push(Texture {
                kind: TEXTURE_IMAGE,
                width: 1,
                height: 1,
                ..Texture::zeroed()
            });
            scene.texels.resize(scene.texels.len() + 257, 0);
        }
        Feature::NormalMap | Feature::BumpMap => {
            let map = scene.textures.len() as u32;
            scene.textures.push(Texture { kind: TEXTURE_CHECKER, ..Texture::zeroed() });
            let maps = match feature {
                Feature::NormalMap => Material { normal_map: map, ..material(Bsdf::Diffuse) },
                _ => Material { bump_map: map, ..material(Bsdf::Diffuse) },
            };
            scene.materials.push(Material { bent: 1, ..maps });
        }
        Feature::AreaSphere => {
            scene.spheres.push(Sphere::zeroed());
            scene.lights.push(area(KIND_SPHERE));
        }
        Feature::AreaRectangle => {
            scene.rectangles.push(Rectangle::zeroed());
            scene.lights.push(area(KIND_RECTANGLE));
        }
        Feature::AreaDisc => {
            scene.discs.push(Disc::zeroed());
            scene.lights.push(area(KIND_DISC));
        }
        Feature::Point => scene.lights.push(light(LightKind::Point as u32)),
        Feature::Spot => scene.lights.push(light(LightKind::Spot as u32)),
        // implied by one of the features above
        Feature::Textures
        | Feature::Maps
        | Feature::PartMaps
        | Feature::Specular
        | Feature::Lobes
        | Feature::Continued
        | Feature::Lights
        | Feature::Photons => return None,
        // select how the same thing is computed
        Feature::KdTree
        | Feature::Few
        | Feature::PatchSet
        | Feature::Unbounded
        | Feature::Outlines
        | Feature::Cells
        | Feature::Guided
        | Feature::Nested
        | Feature::Astride
        | Feature::Far => return None,
        // need geometry that a ray can reach
        Feature::Instances
        | Feature::AreaTriangle
        | Feature::AreaCuboid
        | Feature::AreaRevolution => return None,
        // change what is rendered
        Feature::Infinite
        | Feature::SunDisc
        | Feature::Environment
        | Feature::EnvironmentImage
        | Feature::TiltedSky
        | Feature::Lens
        | Feature::Projection
        | Feature::Filter
        | Feature::SignedFilter
        | Feature::Sampled
        | Feature::Local
        | Feature::Split
        | Feature::First
        | Feature::DirectLayer => return None,
    }
    Some(scene)
}

/// Returns the scene with one unused item for every addable feature that `features` lack.
pub fn with_all_unused(scene: &SceneTables, features: Features) -> SceneTables {
    unused(features)
        .into_iter()
        .fold(scene.clone(), |scene, feature| with_unused(&scene, feature).unwrap_or(scene))
}

/// Returns the features that [`with_unused`] can add and that `features` lack.
pub fn unused(features: Features) -> Vec<Feature> {
    let empty = SceneTables::empty();
    let can_add = |feature: &Feature| with_unused(&empty, *feature).is_some();
    Feature::all().filter(|f| !features.has(*f) && can_add(f)).collect()
}

/// Times of one kernel, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KernelCost {
    /// Time to compose, validate and compile it, including a first run over nothing.
    pub compile: f64,
    /// Time in one pass, the minimum of several passes.
    pub run: f64,
}

/// Times of a scene on a device, and its image.
pub struct Costs {
    /// Times by kernel stem; empty on the CPU, whose code is compiled once for all scenes.
    pub kernels: BTreeMap<&'static str, KernelCost>,
    /// Time of a pass in seconds, the minimum of several passes.
    pub pass: f64,
    /// Image after these passes.
    pub picture: Picture,
}

/// Times `passes` passes (at least one) on a GPU or a software driver, kernel by kernel.
pub fn on_gpu(
    choice: &AdapterChoice,
    packed: &PackedScene,
    settings: &RenderSettings,
    passes: u32,
) -> Result<Costs, EngineError> {
    let mut engine = GpuEngine::measured(choice, packed, Plan::probed(packed, settings))?;
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
    packed: PackedScene,
    settings: &RenderSettings,
    passes: u32,
) -> Result<Costs, EngineError> {
    let plan = Plan::probed(&packed, settings);
    let mut engine = CpuEngine::new(packed, plan);
    let mut pass = f64::INFINITY;
    for _ in 0..passes.max(1) {
        let start = Instant::now();
        engine.pass()?;
        pass = pass.min(start.elapsed().as_secs_f64());
    }
    Ok(Costs { kernels: BTreeMap::new(), pass, picture: engine.picture()? })
}

/// Theory: items without references change no bit of the image, but are compiled.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::pilots::prepare;
    use crate::scene;

    #[test]
    fn unused_things_change_no_bit() {
        let mut loaded = scene::load("scenes/soft-shadows.toml".as_ref()).unwrap();
        (loaded.scene.film.width, loaded.scene.film.height) = (24, 16);
        loaded.settings.photons = 500;
        loaded.settings.indirect_radius = Some(1.0);
        let packed = prepare(&loaded.scene, 24, 16).unwrap();
        let features = Features::of(&packed.tables, &loaded.settings);
        let missing = unused(features);
        assert!(missing.len() > 5, "{missing:?}");
        for feature in &missing {
            let scene = with_unused(&packed.tables, *feature).unwrap();
            assert!(Features::of(&scene, &loaded.settings).has(*feature), "{feature:?}");
        }
        let mut heavy = packed.clone();
        heavy.tables = with_all_unused(&packed.tables, features);
        let plain = on_cpu(packed.clone(), &loaded.settings, 2).unwrap();
        let with_all = on_cpu(heavy, &loaded.settings, 2).unwrap();
        assert!(plain.picture == with_all.picture);
        assert!(plain.picture.rgb.iter().flatten().any(|value| *value > 0.0));
        // a change to a light that is referenced is detected
        let mut brighter = packed.clone();
        brighter.tables.lights[0].color *= 2.0;
        assert!(on_cpu(brighter, &loaded.settings, 2).unwrap().picture != plain.picture);
    }
}
