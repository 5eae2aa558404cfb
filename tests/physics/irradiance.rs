//! Irradiance on a diffuse floor under every kind of light, with sampled direct light and by
//! photons.

use std::f64::consts::PI;

use caustica::low_level::scene::settings::{Direct, RenderSettings};
use glam::{DMat3, DVec2, DVec3};

use super::closed_forms as form;
use super::lab::*;

pub const ALBEDO: f64 = 0.6;
const RADIUS: f64 = 0.03;

/// Looks below the lights at the floor around the origin: |x| < 0.3, |z| < 0.6.
pub fn camera() -> Camera {
    Camera { position: DVec3::new(0.0, 1.6, 3.0), target: DVec3::ZERO, fov: 9.0, size: 16 }
}

pub const FLOOR: &str = r#"
[materials.floor]
type = "diffuse"
reflectance = 0.6
[materials.black]
type = "diffuse"
reflectance = 0.0
[[shapes]]
type = "rectangle"
origin = [-1.0, 0.0, 1.0]
u = [2.0, 0.0, 0.0]
v = [0.0, 0.0, -2.0]
material = "floor"
"#;

/// Theory: a floor of irradiance E has the radiance albedo E / pi, however its light was found.
pub fn check(name: &str, light: &str, irradiance: impl Fn(DVec3) -> f64 + Sync) {
    check_from(camera(), name, light, irradiance);
}

/// The same with another camera.
pub fn check_from(
    camera: Camera,
    name: &str,
    light: &str,
    irradiance: impl Fn(DVec3) -> f64 + Sync,
) {
    let text = camera.toml() + FLOOR + light;
    for direct in DIRECT {
        let sampled = direct == Direct::Sampled;
        let passes = if sampled { 8 } else { 1 };
        let photons = if sampled { 1 } else { 1 << 15 };
        let settings = RenderSettings { direct, passes, photons, ..settings(RADIUS) };
        // shadow rays end at the visible point itself, photons are averaged over the disc
        let blur = if sampled { 0.0 } else { RADIUS };
        let truth = camera.floor_picture(blur, |p| ALBEDO / PI * irradiance(p));
        let power = if sampled { 0.02 } else { 0.03 };
        runs_to(power, &text, &settings).assert_picture(
            &format!("{name}, {direct:?}"),
            &truth,
            power,
        );
    }
}

/// Theory: E = I cos / d^2 (inverse square law).
#[test]
fn point() {
    let at = DVec3::new(0.1, 0.5, -0.1);
    let light = format!("[[lights]]\ntype = \"point\"\nposition = {}\nintensity = 2.0\n", list(at));
    check("point", &light, |p| 2.0 * at.y / (at - p).length().powi(3));
}

/// Theory: as a point light times 1 up to (1 - blend) angle, 0 from angle on, and a smoothstep of
/// the cosine between.
#[test]
fn spot() {
    let at = DVec3::new(-0.2, 0.7, 0.1);
    let target = DVec3::new(0.1, 0.0, 0.0);
    let light = format!(
        "[[lights]]\ntype = \"spot\"\nposition = {}\ntarget = {}\nintensity = 2.0\nangle = 40.0\n\
         blend = 0.6\n",
        list(at),
        list(target)
    );
    let axis = (target - at).normalize();
    let (outer, inner) = (40f64.to_radians().cos(), 16f64.to_radians().cos());
    check("spot", &light, |p| {
        let cos = (p - at).normalize().dot(axis);
        let x = ((cos - outer) / (inner - outer)).clamp(0.0, 1.0);
        2.0 * x * x * (3.0 - 2.0 * x) * at.y / (at - p).length().powi(3)
    });
}

/// Theory: E = irradiance at normal incidence times the cosine.
#[test]
fn sun() {
    let d = DVec3::new(0.4, -1.0, -0.3);
    let light = format!("[[lights]]\ntype = \"sun\"\ndirection = {}\nirradiance = 3.0\n", list(d));
    check("sun", &light, |_| -3.0 * d.normalize().y);
}

/// Theory: E = pi L under a whole hemisphere of radiance L.
#[test]
fn constant_environment() {
    check("constant", "[environment]\nradiance = 0.7\n", |_| PI * 0.7);
}

const WIDTH: usize = 16;
const HEIGHT: usize = 8;

/// An image with one bright patch of texels.
fn sky() -> Vec<f64> {
    let mut texels = vec![0.25; WIDTH * HEIGHT];
    for (i, j, v) in [(3, 1, 16.0), (4, 1, 8.0), (3, 2, 4.0), (10, 2, 2.0)] {
        texels[j * WIDTH + i] = v;
    }
    texels
}

/// Rotations of the image as a scene file writes them, and as matrices: about y, about a slanted
/// axis, by a matrix with the same meaning as an angle, and by one without a symmetry.
fn rotations() -> Vec<(String, DMat3)> {
    let about = |axis: DVec3, degrees: f64| {
        (
            format!("{{ axis = {}, degrees = {degrees:?} }}", list(axis)),
            DMat3::from_axis_angle(axis.normalize(), degrees.to_radians()),
        )
    };
    let rows = |matrix: DMat3| {
        let rows = matrix.transpose();
        let text = format!("[{}, {}, {}]", list(rows.x_axis), list(rows.y_axis), list(rows.z_axis));
        (text, matrix)
    };
    vec![
        ("75.0".to_owned(), DMat3::from_rotation_y(75f64.to_radians())),
        about(DVec3::new(0.0, -2.0, 0.0), 140.0),
        about(DVec3::new(1.0, 0.4, -0.7), 50.0),
        rows(DMat3::from_rotation_y(-0.6)),
        rows(DMat3::from_rotation_x(0.5) * DMat3::from_rotation_z(2.0)),
    ]
}

/// Radiance of the image from direction `d`: equirectangular, bilinear, turned by `rotation`.
fn sky_radiance(texels: &[f64], d: DVec3, rotation: DMat3) -> f64 {
    let d = rotation.transpose() * d;
    let u = 0.5 - d.z.atan2(d.x) / (2.0 * PI);
    let down = d.y.clamp(-1.0, 1.0).acos() / PI;
    let (x, y) = (u * WIDTH as f64 - 0.5, down * HEIGHT as f64 - 0.5);
    let texel = |i: f64, j: f64| {
        let i = (i as i64).rem_euclid(WIDTH as i64) as usize;
        let j = (j as i64).clamp(0, HEIGHT as i64 - 1) as usize;
        texels[j * WIDTH + i]
    };
    let (i, j, fx, fy) = (x.floor(), y.floor(), x - x.floor(), y - y.floor());
    let row = |j| texel(i, j) * (1.0 - fx) + texel(i + 1.0, j) * fx;
    row(j) * (1.0 - fy) + row(j + 1.0) * fy
}

/// Theory: E = integral of L(w) cos over the hemisphere, by quadrature, with a rotated image.
#[test]
fn image_environment() {
    let texels = sky();
    let picture =
        caustica::low_level::film::Picture::from_fn(WIDTH as u32, HEIGHT as u32, |x, y| {
            [texels[y as usize * WIDTH + x as usize] as f32; 3]
        });
    write_exr("physics-sky.exr", &picture);
    for (text, rotation) in rotations() {
        let mut irradiance = 0.0;
        let (n_theta, n_phi) = (400, 1600);
        for i in 0..n_theta {
            let (sin, cos) = ((i as f64 + 0.5) / n_theta as f64 * 0.5 * PI).sin_cos();
            for k in 0..n_phi {
                let (s, c) = ((k as f64 + 0.5) / n_phi as f64 * 2.0 * PI).sin_cos();
                irradiance +=
                    sky_radiance(&texels, DVec3::new(sin * c, cos, sin * s), rotation) * sin * cos;
            }
        }
        irradiance *= 0.5 * PI / n_theta as f64 * 2.0 * PI / n_phi as f64;
        let light = format!("[environment]\nfile = \"physics-sky.exr\"\nrotate = {text}\n");
        check(&format!("image turned by {text}"), &light, |_| irradiance);
    }
}

/// Theory: a camera without a scene that looks at the bright texels sees the image's radiance
/// there, which fixes the sense of rotation.
#[test]
fn image_environment_seen() {
    let texels = sky();
    let picture =
        caustica::low_level::film::Picture::from_fn(WIDTH as u32, HEIGHT as u32, |x, y| {
            [texels[y as usize * WIDTH + x as usize] as f32; 3]
        });
    write_exr("physics-sky-seen.exr", &picture);
    for (text, rotation) in rotations() {
        let d = DVec3::new(0.5, 0.9, 0.3);
        let camera = Camera {
            position: DVec3::new(1.0, 2.0, 3.0),
            target: DVec3::new(1.0, 2.0, 3.0) + d,
            fov: 90.0,
            size: 12,
        };
        let light = format!("[environment]\nfile = \"physics-sky-seen.exr\"\nrotate = {text}\n");
        let settings = RenderSettings { passes: 16, photons: 1, ..settings(RADIUS) };
        let n = camera.size as usize;
        let sub = 16;
        let truth: Vec<f64> = (0..n * n)
            .map(|i| {
                let points = (0..sub * sub).map(|k| {
                    let at =
                        DVec2::new((k % sub) as f64 + 0.5, (k / sub) as f64 + 0.5) / sub as f64;
                    let at = (at + DVec2::new((i % n) as f64, (i / n) as f64)) / n as f64;
                    sky_radiance(&texels, camera.direction(at).normalize(), rotation)
                });
                points.sum::<f64>() / (sub * sub) as f64
            })
            .collect();
        runs_to(0.01, &(camera.toml() + light.as_str()), &settings).assert_picture(
            &format!("sky turned by {text}"),
            &truth,
            0.01,
        );
    }
}

fn write_exr(name: &str, picture: &caustica::low_level::film::Picture) {
    let at = |x: usize, y: usize| {
        let c = picture.rgb[y * picture.width as usize + x];
        (c[0], c[1], c[2])
    };
    let path = folder().join(name);
    exr::prelude::write_rgb_file(path, picture.width as usize, picture.height as usize, at)
        .unwrap();
}

fn emitting(shape: &str) -> String {
    format!("[[shapes]]\n{shape}\nmaterial = \"black\"\nemission = 5.0\n")
}

/// Theory: pi L (R/d)^2 cos.
#[test]
fn sphere() {
    let at = DVec3::new(0.1, 0.6, -0.1);
    let shape = format!("type = \"sphere\"\ncenter = {}\nradius = 0.2", list(at));
    check("sphere", &emitting(&shape), |p| 5.0 * form::sphere(p, DVec3::Y, at, 0.2));
}

/// Theory: Lambert's polygon sum, for a tilted rectangle that emits downward.
#[test]
fn rectangle() {
    let (o, u, v) =
        (DVec3::new(-0.3, 0.55, -0.3), DVec3::new(0.5, 0.1, 0.0), DVec3::new(0.05, 0.0, 0.45));
    let shape =
        format!("type = \"rectangle\"\norigin = {}\nu = {}\nv = {}", list(o), list(u), list(v));
    let corners = [o, o + u, o + u + v, o + v];
    check("rectangle", &emitting(&shape), |p| 5.0 * form::polygon(p, DVec3::Y, &corners));
}

/// Theory: the configuration factor of a parallel disc off its axis.
#[test]
fn disc() {
    let shape = "type = \"disc\"\ncenter = [0.1, 0.5, -0.1]\nnormal = [0, -2, 0]\nradius = 0.3";
    check("disc", &emitting(shape), |p| 5.0 * form::disc((p.x - 0.1).hypot(p.z + 0.1), 0.5, 0.3));
}

/// Theory: a convex body is the sum of its faces that face the point.
#[test]
fn cuboid() {
    let (a, b) = (DVec3::new(-0.2, 0.4, -0.3), DVec3::new(0.2, 0.6, 0.0));
    let shape = format!("type = \"box\"\nmin = {}\nmax = {}", list(a), list(b));
    let corner = |k: u32| {
        let pick = |bit: u32, a: f64, b: f64| if k >> bit & 1 == 1 { b } else { a };
        DVec3::new(pick(0, a.x, b.x), pick(1, a.y, b.y), pick(2, a.z, b.z))
    };
    let faces = [[0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6], [0, 4, 6, 2], [1, 3, 7, 5]];
    check("box", &emitting(&shape), |p| {
        let face = |f: &[u32; 4]| form::polygon(p, DVec3::Y, &f.map(corner)).max(0.0);
        5.0 * faces.iter().map(face).sum::<f64>()
    });
}

/// Theory: a tetrahedron of four triangles is the sum of those that face the point.
#[test]
fn mesh() {
    let p =
        [[0.3, 0.7, 0.2], [-0.3, 0.6, 0.1], [0.0, 0.65, -0.3], [0.05, 0.35, 0.0]].map(DVec3::from);
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let middle = (p[0] + p[1] + p[2] + p[3]) / 4.0;
    let faces = faces.map(|[a, b, c]| {
        let outward = (p[b] - p[a]).cross(p[c] - p[a]).dot(p[a] - middle) > 0.0;
        if outward { [a, b, c] } else { [a, c, b] }
    });
    let mut obj = String::new();
    p.iter().for_each(|p| obj += &format!("v {:?} {:?} {:?}\n", p.x, p.y, p.z));
    faces.iter().for_each(|f| obj += &format!("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1));
    let name = file("physics-tetrahedron.obj", obj.as_bytes());
    for smooth in [false, true] {
        let shape = format!("type = \"mesh\"\nfile = \"{name}\"\nsmooth = {smooth}");
        check(&format!("mesh, smooth {smooth}"), &emitting(&shape), |x| {
            let face = |f: &[usize; 3]| form::polygon(x, DVec3::Y, &f.map(|i| p[i])).max(0.0);
            5.0 * faces.iter().map(face).sum::<f64>()
        });
    }
}

/// Theory: quadrature over the surface; convex profiles with one and with two segments.
#[test]
fn revolution() {
    let base = DVec3::new(0.1, 0.35, -0.05);
    let egg = [[0.0, 0.0], [0.35, 0.0], [0.3, 0.4], [0.0, 0.4]];
    let shape = |profile: String| {
        format!("type = \"revolution\"\n{profile}\ntransform = {{ translate = {} }}", list(base))
    };
    let one = shape(format!("profile = {egg:?}"));
    let surface = form::Surface::new(form::revolution(base, egg), 128, 48);
    check("egg", &emitting(&one), |p| 5.0 * surface.irradiance(p, DVec3::Y));
    // a double cone drawn as two straight segments; a straight cubic has its control points evenly
    // spaced
    let line = |a: [f64; 2], b: [f64; 2]| {
        let at = |s: f64| [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
        [at(0.0), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0)]
    };
    let two = shape("segments = [[[0.0, 0.0], [0.25, 0.1]], [[0.25, 0.1], [0.0, 0.4]]]".into());
    let surface = |from, to| form::Surface::new(form::revolution(base, line(from, to)), 64, 48);
    let lower = surface([0.0, 0.0], [0.25, 0.1]);
    let upper = surface([0.25, 0.1], [0.0, 0.4]);
    check("double cone", &emitting(&two), |p| {
        5.0 * (lower.irradiance(p, DVec3::Y) + upper.irradiance(p, DVec3::Y))
    });
}
