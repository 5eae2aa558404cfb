//! Smooth-shaded meshes: photon mapping and path tracing must agree, although interpolated normals
//! make the scattering of light non-symmetric (Veach 1997, section 5.3).

use std::f64::consts::TAU;

use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use glam::DVec3;

use super::lab::*;

/// A torus about the y axis with `m` by `n` quads and exact normals; radii 1 and 0.4.
fn torus(m: u32, n: u32) -> Vec<u8> {
    let (mut v, mut vn, mut f) = (String::new(), String::new(), String::new());
    for i in 0..m {
        for j in 0..n {
            let (sa, ca) = (TAU * i as f64 / m as f64).sin_cos();
            let (sb, cb) = (TAU * j as f64 / n as f64).sin_cos();
            let normal = DVec3::new(cb * ca, sb, cb * sa);
            let p = DVec3::new(ca, 0.0, sa) + normal * 0.4;
            v += &format!("v {} {} {}\n", p.x, p.y, p.z);
            vn += &format!("vn {} {} {}\n", normal.x, normal.y, normal.z);
            let at = |i: u32, j: u32| (i % m) * n + j % n + 1;
            let q = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]
                .map(|k| format!("{k}//{k}"));
            f += &format!("f {}\n", q.join(" "));
        }
    }
    (v + &vn + &f).into_bytes()
}

/// The scene: a room's corner with a torus of few faces under a small lamp and a dim sky.
fn scene(name: &str, material: &str) -> String {
    let mesh = file(&format!("physics-torus-{name}.obj"), &torus(12, 8));
    let camera = Camera {
        position: DVec3::new(0.3, 2.4, 3.2),
        target: DVec3::new(0.0, 0.1, 0.0),
        fov: 44.0,
        size: 24,
    };
    camera.toml()
        + &format!(
            r#"
[environment]
radiance = 0.1
[materials.floor]
type = "diffuse"
reflectance = 0.7
[materials.torus]
{material}
[[shapes]]
type = "rectangle"
origin = [-3.0, -0.6, 3.0]
u = [6.0, 0.0, 0.0]
v = [0.0, 0.0, -6.0]
material = "floor"
[[shapes]]
type = "mesh"
file = "{mesh}"
material = "torus"
transform = {{ rotate = {{ axis = [1, 0, 0], degrees = 20 }} }}
[[shapes]]
type = "sphere"
center = [1.2, 1.9, 0.6]
radius = 0.35
material = "floor"
emission = 6.0
"#
        )
}

/// Theory: both methods estimate one integral with one BSDF, so their images agree region by
/// region, except for the photons' bias (radius a hundredth of the torus). Without the correction
/// for shading normals, diffuse light scattered from so coarse a mesh is off by several percent.
fn agree(name: &str, material: &str, modes: &[Direct], power: f64) {
    let text = scene(name, material);
    let run = |method, direct, passes, photons| {
        let settings = RenderSettings {
            method,
            direct,
            passes,
            photons,
            radius_rule: RadiusRule::Global,
            max_bounces: 12,
            ..settings(0.03)
        };
        runs_to(power, &text, &settings)
    };
    let path = run(Method::Path, Direct::Sampled, 8, 1);
    for &direct in modes {
        let photons = run(Method::Sppm, direct, 8, 1 << 14);
        assert_regions(&format!("{name}, path and {direct:?}"), &path, &photons, power);
    }
}

#[test]
fn diffuse() {
    agree("diffuse", "type = \"diffuse\"\nreflectance = 0.8", &DIRECT, 0.04);
}

#[test]
fn metal() {
    agree("metal", "type = \"metal\"\nreflectance = 0.9\nroughness = 0.6", &DIRECT, 0.04);
}

#[test]
fn mirror() {
    agree("mirror", "type = \"mirror\"\nreflectance = 0.9", &[Direct::Sampled], 0.04);
}

#[test]
fn glass() {
    agree("glass", "type = \"glass\"\nior = 1.5\nabsorption = 0.3", &[Direct::Photons], 0.04);
}
