//! Theory: no NaN and no infinity reaches an image. Such samples are rejected and counted by cause,
//! in the same way on both engines.

use bytemuck::Zeroable;
use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::Engine;
use caustica::low_level::film::{Picture, Rejections};
use caustica::low_level::gpu::GpuEngine;
use caustica::low_level::kernels::records::*;
use caustica::low_level::kernels::resolve::resolve;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene;
use caustica::low_level::scene::settings::{Direct, Method, Radius, RenderSettings};
use glam::Vec3;

use crate::support::{bits, software};

/// A floor under a visible lamp, and a point light.
const SCENE: &str = r#"version = 1
[camera]
position = [0.0, 1.0, 4.0]
target = [0.0, 0.6, 0.0]
fov = 40.0
[film]
width = 24
height = 16
[materials.grey]
type = "diffuse"
reflectance = 0.5
[materials.black]
type = "diffuse"
reflectance = 0.0
[[shapes]]
type = "rectangle"
origin = [-2.0, 0.0, 2.0]
u = [4.0, 0.0, 0.0]
v = [0.0, 0.0, -4.0]
material = "grey"
[[shapes]]
type = "disc"
center = [0.0, 1.2, 0.0]
normal = [0.0, -0.3, 1.0]
radius = 0.3
material = "black"
emission = 3.0
[[lights]]
type = "point"
position = [0.5, 1.5, 0.5]
intensity = 1.0
"#;

fn packed(text: &str) -> PackedScene {
    let scene = scene::parse("scene.toml".as_ref(), text.as_bytes()).expect("a scene").scene;
    prepare(&scene, scene.film.width, scene.film.height).expect("packed")
}

fn settings(direct: Direct) -> RenderSettings {
    RenderSettings {
        passes: 3,
        photons: 4000,
        direct,
        radius: Radius::Units(0.2),
        ..RenderSettings::default()
    }
}

fn rendered(mut engine: impl Engine, passes: u32) -> (Picture, Rejections) {
    for _ in 0..passes {
        engine.pass().expect("a pass");
    }
    (engine.picture().expect("a picture"), engine.rejections().expect("counts"))
}

/// Renders on both engines, which must give the same bits and counts. The image must be finite.
fn on_both(packed: &PackedScene, settings: &RenderSettings) -> (Picture, Rejections) {
    let plan = Plan::probed(packed, settings);
    let choice = software();
    let cpu = rendered(CpuEngine::new(packed.clone(), plan.clone()), settings.passes);
    let driver =
        rendered(GpuEngine::new(&choice, packed, plan).expect("an engine"), settings.passes);
    assert_eq!(cpu.1, driver.1);
    assert_eq!(bits(&cpu.0), bits(&driver.0));
    assert_eq!(cpu.0.not_finite(), 0);
    cpu
}

/// Returns the scene's light of a kind.
fn light(packed: &mut PackedScene, kind: u32) -> &mut caustica::low_level::tables::Light {
    packed.tables.lights.iter_mut().find(|l| l.kind == kind).expect("such a light")
}

/// Theory: a sound scene rejects nothing.
#[test]
fn nothing_is_left_out_of_a_sound_scene() {
    for direct in [Direct::Sampled, Direct::Photons] {
        let (picture, rejections) = on_both(&packed(SCENE), &settings(direct));
        assert!(rejections.is_empty(), "{rejections:?}");
        assert!(picture.rgb.iter().any(|c| c[0] > 0.0));
    }
}

/// Theory: scene files cannot contain such numbers, so the test poisons the packed scene, one
/// number at a time. A visible lamp of infinite radiance invalidates the eye paths that meet it,
/// and a point light of NaN the direct light samples, or the photons with `direct = "photons"`.
/// Each pass of each pixel counts once, under the first cause.
#[test]
fn causes_are_told_apart() {
    use caustica::low_level::lights::LightKind;
    for poison in [f32::INFINITY, f32::NAN] {
        let mut scene = packed(SCENE);
        light(&mut scene, LightKind::Area as u32).color = Vec3::new(1.0, poison, 1.0);
        let (_, r) = on_both(&scene, &settings(Direct::Sampled));
        assert!(r.eye_path > 0 && r.direct_light > 0, "{poison}: {r:?}");
        assert_eq!(r.estimate + r.too_bright, 0, "{poison}: {r:?}");
        assert!(r.eye_path + r.direct_light + r.photons <= 3 * 24 * 16, "{poison}: {r:?}");

        let mut scene = packed(SCENE);
        light(&mut scene, LightKind::Point as u32).color = Vec3::new(poison, 1.0, 1.0);
        let (picture, r) = on_both(&scene, &settings(Direct::Sampled));
        assert!(r.direct_light > 0, "{poison}: {r:?}");
        assert_eq!((r.eye_path, r.estimate), (0, 0), "{poison}: {r:?}");
        // the lamp is still visible
        assert!(picture.rgb.iter().any(|c| (c[0] - 3.0).abs() < 1e-5));

        let (_, r) = on_both(&scene, &settings(Direct::Photons));
        assert!(r.photons > 0, "{poison}: {r:?}");
        assert_eq!((r.eye_path, r.direct_light, r.estimate), (0, 0, 0), "{poison}: {r:?}");
    }
}

/// Theory: flux and radius are finite, but a summed flux of 1e9 over the area of a disc of radius
/// 1e-19 (squared 1e-38) exceeds f32. Photons hardly meet such a disc, so the test calls the kernel
/// directly.
#[test]
fn an_estimate_that_overflows_is_left_out() {
    let d = Dispatch { eye_samples: 1, scale_sq: 1.0, photons: 1.0, ..Dispatch::zeroed() };
    let point = VisiblePoint { radius: 1e-19, radiance: Vec3::ONE, ..VisiblePoint::zeroed() };
    let mut film = FilmPixel::zeroed();
    resolve(
        &d,
        &[point],
        &[Gathered { flux: Vec3::splat(1e9), count: 1, ..Gathered::zeroed() }],
        None,
        &mut film,
    );
    assert_eq!((film.rejected, film.mean), ([0, 0, 0, 1], Vec3::ZERO));
    // the next pass counts as the first
    resolve(&Dispatch { passes_done: 1, ..d }, &[point], &[Gathered::zeroed()], None, &mut film);
    assert_eq!((film.rejected, film.mean + film.carry), ([0, 0, 0, 1], Vec3::ONE));
}

/// Theory: path tracing has one sum per path.
#[test]
fn paths_are_counted() {
    let mut scene = packed(SCENE);
    light(&mut scene, caustica::low_level::lights::LightKind::Point as u32).color =
        Vec3::splat(f32::NAN);
    let settings = RenderSettings { method: Method::Path, ..settings(Direct::Sampled) };
    let plan = Plan::probed(&scene, &settings);
    let (picture, r) = rendered(CpuEngine::new(scene, plan), 3);
    assert_eq!(picture.not_finite(), 0);
    assert!(r.eye_path > 0 && r.total() == r.eye_path, "{r:?}");
}

/// A point light of the greatest intensity at 1e-5 above a floor: I / d^2 = 1e40.
pub const TOO_BRIGHT: &str = r#"version = 1
[camera]
position = [0.0, 4e-5, 2e-5]
target = [0.0, 0.0, 0.0]
fov = 30.0
[film]
width = 8
height = 8
[render]
passes = 1
photons = 100
[materials.grey]
type = "diffuse"
reflectance = 0.5
[[shapes]]
type = "disc"
center = [0.0, 0.0, 0.0]
normal = [0.0, 1.0, 0.0]
radius = 1e-4
material = "grey"
[[lights]]
type = "point"
position = [0.0, 1e-5, 0.0]
intensity = 1e30
"#;

/// Theory: radiance 1e30 / (1e-5)^2 0.5 / pi = 1.6e39 exceeds the 3.4e38 of f32. The pixel below
/// the light holds the largest f32 and is counted; the dim pixels at the border are not.
#[test]
fn too_bright_pixels_are_counted() {
    let scene = packed(TOO_BRIGHT);
    let (picture, r) =
        on_both(&scene, &RenderSettings { passes: 1, photons: 100, ..RenderSettings::default() });
    let largest = picture.rgb.iter().filter(|c| c[0] == f32::MAX).count() as u64;
    assert!(largest > 0 && largest < 64, "{largest}");
    assert_eq!(r, Rejections { too_bright: largest, ..Rejections::default() });
}
