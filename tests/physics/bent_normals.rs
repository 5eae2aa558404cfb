//! Flat walls whose corner normals all lean the same way: the effect of interpolated normals on
//! light, in closed form.
//!
//! An eye path scatters about the shading normal n_s only, so a flat wall with n_s leaning from its
//! geometric normal n_g acts as one whose every point is turned by that angle. Photons must arrive
//! at the same radiances, although their density follows n_g (Veach 1997, section 5.3).

use std::f64::consts::PI;

use caustica::low_level::scene::settings::RenderSettings;
use glam::DVec3;

use super::closed_forms as form;
use super::lab::*;

/// So dark that light reflected by the floor contributes less than a thousandth.
const FLOOR: f64 = 0.002;
const SUN: f64 = 3.0;

/// The scene: a floor at y = 0 seen around (0.3, 0, 0), the sun, and a square with these corners
/// and the shading normal `ns`.
fn scene(
    name: &str,
    material: &str,
    corners: &[DVec3; 4],
    ns: DVec3,
    sun: DVec3,
) -> (Camera, String) {
    let mut obj = String::new();
    corners.iter().for_each(|c| obj += &format!("v {} {} {}\n", c.x, c.y, c.z));
    obj += &format!("vn {} {} {}\nf 1//1 2//1 3//1 4//1\n", ns.x, ns.y, ns.z);
    let mesh = file(&format!("physics-bent-{name}.obj"), obj.as_bytes());
    let camera = Camera {
        position: DVec3::new(0.3, 0.9, 2.9),
        target: DVec3::new(0.3, 0.0, 0.0),
        fov: 6.0,
        size: 8,
    };
    let text = camera.toml()
        + &format!(
            "[materials.floor]\ntype = \"diffuse\"\nreflectance = {FLOOR}\n[materials.wall]\n\
             {material}\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 2\n\
             material = \"floor\"\n\
             [[shapes]]\ntype = \"mesh\"\nfile = \"{mesh}\"\nmaterial = \"wall\"\n\
             [[lights]]\ntype = \"sun\"\ndirection = {}\nirradiance = {SUN}\n",
            list(sun)
        );
    (camera, text)
}

fn check(name: &str, camera: &Camera, text: &str, irradiance: impl Fn(DVec3) -> f64 + Sync) {
    for direct in DIRECT {
        let settings = RenderSettings { direct, passes: 2, photons: 1 << 14, ..settings(0.04) };
        let truth = camera.floor_picture(0.04, |p| FLOOR / PI * irradiance(p));
        runs_to(0.04, text, &settings).assert_picture(&format!("{name}, {direct:?}"), &truth, 0.04);
    }
}

/// The upright wall x = -1, facing +x.
const WALL: [DVec3; 4] = [
    DVec3::new(-1.0, 0.01, 1.5),
    DVec3::new(-1.0, 0.01, -1.5),
    DVec3::new(-1.0, 1.6, -1.5),
    DVec3::new(-1.0, 1.6, 1.5),
];

fn at_degrees(a: f64) -> DVec3 {
    DVec3::new(a.to_radians().cos(), a.to_radians().sin(), 0.0)
}

/// Theory: the mirrored sun is a sun in the direction mirrored at n_s, of the same irradiance, so
/// the floor receives E (cos + cos'). Here the sun stands 60 degrees over n_g and the normal leans
/// by 15: uncorrected photons would bring cos 60 / cos 30 = 0.58 of the mirrored part.
#[test]
fn mirror() {
    let (to_sun, ns) = (at_degrees(60.0), at_degrees(15.0));
    let (camera, text) =
        scene("mirror", "type = \"mirror\"\nreflectance = 1.0", &WALL, ns, -to_sun);
    check("mirror", &camera, &text, |_| {
        SUN * (60f64.to_radians().sin() + 30f64.to_radians().sin())
    });
}

/// Theory: a wall under irradiance E n_s . w has the radiance rho / pi times that. The floor
/// receives it by Lambert's polygon formula, in addition to the sun.
#[test]
fn diffuse() {
    const RHO: f64 = 0.9;
    let (to_sun, ns) = (at_degrees(75.0), at_degrees(25.0));
    let (camera, text) =
        scene("diffuse", "type = \"diffuse\"\nreflectance = 0.9", &WALL, ns, -to_sun);
    let radiance = RHO / PI * SUN * to_sun.dot(ns);
    // seen from the floor in front, the wall's corners run in the opposite sense
    check("diffuse", &camera, &text, |p| {
        SUN * to_sun.y + radiance * form::polygon(p, DVec3::Y, &WALL).abs()
    });
}

/// Theory: behind a flat face of glass with normal n_s the sun stands in the refracted direction
/// with the irradiance T E cos_i / cos_t; the floor receives the cosine of that.
#[test]
fn glass() {
    const N: f64 = 1.5;
    let (to_sun, ns) = (at_degrees(60.0), at_degrees(105.0));
    let face = [
        DVec3::new(-3.0, 1.2, 3.0),
        DVec3::new(3.0, 1.2, 3.0),
        DVec3::new(3.0, 1.2, -3.0),
        DVec3::new(-3.0, 1.2, -3.0),
    ];
    let (camera, text) = scene("glass", "type = \"glass\"\nior = 1.5", &face, ns, -to_sun);
    let cos_i = to_sun.dot(ns);
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (N * N)).sqrt();
    let s = (cos_i - N * cos_t) / (cos_i + N * cos_t);
    let p = (N * cos_i - cos_t) / (N * cos_i + cos_t);
    let transmitted = 1.0 - 0.5 * (s * s + p * p);
    let inside = ns * (cos_i / N - cos_t) - to_sun / N;
    check("glass", &camera, &text, |_| SUN * transmitted * cos_i / cos_t * -inside.y);
}
