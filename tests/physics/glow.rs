//! Emission with textures, on both sides, and hidden from the camera.

use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::surface_at;
use caustica::low_level::lights::area::{eval_area, pdf_area};
use caustica::low_level::lights::light::sample_light;
use caustica::low_level::lights::select::shares_at;
use caustica::low_level::math::rng::rng_next;
use caustica::low_level::pilots::prepare;
use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::shapes::table::NONE;
use glam::{DVec3, Vec3};

use super::closed_forms as form;
use super::densities::{check as check_density, rng};
use super::irradiance::{FLOOR, check};
use super::lab::*;

/// A slanted rectangle above the floor that faces down, and its corners in the order that
/// [`form::polygon`] takes.
fn lamp() -> ([DVec3; 3], [DVec3; 4]) {
    let (o, u, v) =
        (DVec3::new(-0.3, 0.5, -0.4), DVec3::new(0.7, 0.1, 0.0), DVec3::new(0.0, 0.05, 0.6));
    ([o, u, v], [o, o + u, o + u + v, o + v])
}

fn rectangle(o: DVec3, u: DVec3, v: DVec3, keys: &str) -> String {
    format!(
        "[[shapes]]\ntype = \"rectangle\"\norigin = {}\nu = {}\nv = {}\nmaterial = \"black\"\n{keys}\n",
        list(o),
        list(u),
        list(v)
    )
}

/// Theory: both sides of a two-sided rectangle give the floor the same irradiance, that of
/// Lambert's polygon.
#[test]
fn both_sides() {
    let ([o, u, v], corners) = lamp();
    let form = |p: DVec3| 5.0 * form::polygon(p, DVec3::Y, &corners).abs();
    let keys = "emission = 5.0\ntwo_sided_emission = true";
    check("front", &rectangle(o, u, v, keys), form);
    check("back", &rectangle(o, v, u, keys), form);
}

/// Theory: inside a two-sided sphere of radiance L the floor has the irradiance pi L, and outside
/// that of a sphere; so does it under a two-sided box, twice as far as its sides emit alike.
#[test]
fn both_sides_of_closed_shapes() {
    let keys = "material = \"black\"\nemission = 5.0\ntwo_sided_emission = true\n";
    let around = format!("[[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = 4\n{keys}");
    let text = super::irradiance::camera().toml() + FLOOR + &around;
    for (method, direct, photons, power) in [
        (Method::Sppm, Direct::Sampled, 1, 0.02),
        (Method::Sppm, Direct::Photons, 1 << 17, 0.06),
        (Method::Path, Direct::Photons, 1, 0.02),
    ] {
        let settings = RenderSettings { method, direct, photons, passes: 2, ..settings(0.1) };
        let truth = vec![0.6 * 5.0; 256];
        runs_to(power, &text, &settings).assert_picture("inside a sphere", &truth, power);
    }
    let at = DVec3::new(0.1, 0.6, -0.1);
    let ball =
        format!("[[shapes]]\ntype = \"sphere\"\ncenter = {}\nradius = 0.2\n{keys}", list(at));
    check("outside a sphere", &ball, |p| 5.0 * form::sphere(p, DVec3::Y, at, 0.2));
}

/// Theory: a lamp that the camera does not see leaves the floor behind it visible, with the light
/// of the lamp on it.
#[test]
fn the_camera_sees_through_hidden_lamps() {
    // between the camera, at (0, 1.6, 3), and all that it sees of the floor
    let (o, u, v) = (DVec3::new(-0.4, 0.9, 2.2), DVec3::X * 0.8, DVec3::new(0.0, -0.1, -1.3));
    let corners = [o, o + v, o + u + v, o + u];
    let keys = "emission = 5.0\ncamera_visible = false";
    check("hidden", &rectangle(o, v, u, keys), |p| {
        5.0 * form::polygon(p, DVec3::Y, &corners).abs()
    });
}

/// Theory: a mirror of reflectance 0.9 shows the radiance 0.9 L of a lamp that the camera looks
/// through, and of which it sees nothing itself.
#[test]
fn mirrors_show_hidden_lamps() {
    let camera =
        Camera { position: DVec3::new(0.0, 0.0, 3.0), target: DVec3::ZERO, fov: 10.0, size: 8 };
    let mirror = "[materials.mirror]\ntype = \"mirror\"\nreflectance = 0.9\n[materials.black]\n\
                  type = \"diffuse\"\nreflectance = 0.0\n[[shapes]]\ntype = \"rectangle\"\n\
                  origin = [-2, -2, 0]\nu = [4, 0, 0]\nv = [0, 4, 0]\nmaterial = \"mirror\"\n";
    // faces the mirror
    let (o, u, v) = (DVec3::new(-1.0, -1.0, 1.5), DVec3::Y * 2.0, DVec3::X * 2.0);
    for (keys, seen) in [
        ("emission = 5.0\ncamera_visible = false", 4.5),
        ("emission = 5.0\ncamera_visible = false\ntwo_sided_emission = true", 4.5),
        ("emission = 5.0\ntwo_sided_emission = true", 5.0),
    ] {
        let text = camera.toml() + mirror + &rectangle(o, u, v, keys);
        for method in [Method::Sppm, Method::Path] {
            let settings = RenderSettings { method, passes: 1, photons: 16, ..settings(0.1) };
            let picture = grey(&render(&parse(&text), &settings));
            assert!(picture.iter().all(|x| (x / seen - 1.0).abs() < 1e-5), "{keys}: {picture:?}");
        }
    }
}

const HALF: &str = "[textures.half]\ntype = \"checker\"\ncolors = [1.0, 0.0]\nscale = [2.0, 1.0]\n";

/// Theory: a texture that is one in the half s < 1/2 of a rectangle and zero elsewhere makes it the
/// rectangle of that half.
#[test]
fn half_a_rectangle() {
    let ([o, u, v], _) = lamp();
    let corners = [o, o + u * 0.5, o + u * 0.5 + v, o + v];
    let keys = "emission = \"half\"\nemission_strength = 5.0";
    let light = format!("{HALF}{}", rectangle(o, u, v, keys));
    check("half", &light, |p| 5.0 * form::polygon(p, DVec3::Y, &corners).abs());
}

/// An image without a symmetry, with smooth values up to `top`.
fn picture(name: &str, top: f32) -> String {
    let at = |x: usize, y: usize| {
        let v = top * (0.1 + 0.9 * (x as f32 / 15.0) * (y as f32 / 7.0).powi(2));
        (v, v, v)
    };
    exr::prelude::write_rgb_file(folder().join(name), 16, 8, at).unwrap();
    format!("[textures.glow]\ntype = \"image\"\nfile = \"{name}\"\n")
}

/// Emitting shapes of every kind, without material and emission.
fn shapes() -> Vec<String> {
    let mesh = "v -1 1.2 0\nv 1 1 0.5\nv 0 1.5 -1\nv 0 0.6 0\nvt 0 0\nvt 0.9 0.1\nvt 0.4 1\nvt 0.5 0.3\n\
                f 1/1 2/2 3/3\nf 1/1 4/4 2/2\nf 2/2 4/4 3/3\nf 3/3 4/4 1/1\n";
    let mesh = file("physics-glow.obj", mesh.as_bytes());
    vec![
        "type = \"sphere\"\ncenter = [0.3, 1, 0.2]\nradius = 0.7".to_owned(),
        "type = \"rectangle\"\norigin = [-1, 0.7, -1]\nu = [2, 0.3, 0]\nv = [0, 0.2, 2]".into(),
        "type = \"rectangle\"\norigin = [-1, 0.7, -1]\nu = [2, 0.3, 0]\nv = [0, 0.2, 2]\nuv = \"planar\"".into(),
        "type = \"disc\"\ncenter = [0.2, 0.8, 0]\nnormal = [0.2, -1, 0.1]\nradius = 1.1".into(),
        "type = \"box\"\nmin = [-0.8, 0.6, -0.6]\nmax = [0.6, 1.4, 0.8]".into(),
        "type = \"box\"\nmin = [-0.8, 0.6, -0.6]\nmax = [0.6, 1.4, 0.8]\nuv = \"planar\"".into(),
        format!("type = \"mesh\"\nfile = \"{mesh}\"\nsmooth = false"),
        "type = \"revolution\"\nsegments = [[[0, 0], [0.9, 0], [0.9, 0.5]], [[0.9, 0.5], [0.9, 1.2], [0, 1.2]]]\ntransform = { translate = [0, 0.5, 0], rotate = { axis = [1, 0, 1], degrees = 40 } }".into(),
        "type = \"revolution\"\nsegments = [[[0.5, 0.6], [0.9, 0.6], [0.9, 1]], [[0.9, 1], [0.5, 1], [0.5, 0.6]]]".into(),
    ]
}

/// Theory: a shadow ray carries the radiance that a ray in its direction meets, whatever the shape,
/// in front of it and, if both sides emit, behind it or inside; and its directions follow
/// `pdf_area`.
#[test]
fn samples_carry_what_rays_meet() {
    let texture = picture("physics-glow.exr", 3.0);
    let head = "version = 1\n[camera]\nposition = [0, -2, 0]\ntarget = [0, 0, 0]\nup = [1, 0, 0]\nfov = 40.0\n\
                [materials.m]\ntype = \"diffuse\"\nreflectance = 0.0\n";
    for (shape, two_sided) in shapes().into_iter().flat_map(|s| [(s.clone(), false), (s, true)]) {
        let text = format!(
            "{head}{texture}[[shapes]]\n{shape}\nmaterial = \"m\"\nemission = \"glow\"\n\
             emission_strength = 2.0\ntwo_sided_emission = {two_sided}\n"
        );
        let packed = prepare(&parse(&text), 8, 8).unwrap();
        let scene = &packed.tables;
        for place in [DVec3::new(0.06, -0.3, 0.08), DVec3::new(0.1, 1.05, 0.1), DVec3::Y * 2.5] {
            let from = ((place - packed.center) / packed.unit).as_vec3();
            let shares = shares_at(scene, from);
            let (mut met, mut edges, mut r) = (0, 0, rng());
            for _ in 0..2000 {
                let s = sample_light(scene, shares, from, rng_next(&mut r));
                if s.radiance.x <= 0.0 {
                    continue;
                }
                let ray = Ray { origin: from, t_min: 0.0, direction: s.direction, t_max: 1e30 };
                let hit = intersect_scene(scene, &ray);
                if hit.reference == NONE || (hit.t - s.distance).abs() > 1e-3 * s.distance {
                    continue;
                }
                let at = surface_at(scene, &ray, &hit);
                let seen = eval_area(scene, &at, s.direction);
                let pdf = pdf_area(scene, shares, from, s.direction, hit.t, &at);
                let cos = s.direction.dot(at.normal).abs();
                // rounding of the hit moves the texture and, at grazing angles, the density
                let off = (seen - s.radiance).length() / s.radiance.length();
                let unlike = off > 1e-2 || (pdf / s.pdf - 1.0).abs() > 5e-3;
                edges += u32::from(cos > 0.05 && unlike);
                met += 1;
            }
            // rounding moves some points over edges of a box or of an emission map's cells
            assert!(edges <= 1 + met / 200, "{shape}: {edges} of {met} samples");
            // a one-sided shape may face away from a point
            assert!(met > 100 || !two_sided, "{shape} from {place}: {met} samples");
        }
    }
}

/// Theory: directions to a textured rectangle follow `pdf_area`, which contains the emission map.
#[test]
fn directions_follow_the_map() {
    let head = "version = 1\n[camera]\nposition = [0, -2, 0]\ntarget = [0, 0, 0]\nup = [1, 0, 0]\nfov = 40.0\n\
                [materials.m]\ntype = \"diffuse\"\nreflectance = 0.0\n";
    let text = format!(
        "{head}{}[[shapes]]\n{}\nmaterial = \"m\"\nemission = \"glow\"\n",
        picture("physics-map.exr", 3.0),
        shapes()[1]
    );
    let packed = prepare(&parse(&text), 8, 8).unwrap();
    let from = ((DVec3::new(0.06, -0.3, 0.08) - packed.center) / packed.unit).as_vec3();
    let scene = packed.tables;
    // turn the upward axis to z, the axis of the bins
    let turn = |w: Vec3| Vec3::new(w.z, w.x, w.y);
    let pdf = |w: Vec3| {
        let direction = Vec3::new(w.y, w.z, w.x);
        let ray = Ray { origin: from, t_min: 0.0, direction, t_max: 1e30 };
        let hit = intersect_scene(&scene, &ray);
        if hit.reference == NONE {
            return 0.0;
        }
        let s = surface_at(&scene, &ray, &hit);
        let facing = s.normal.dot(direction) < 0.0;
        let pdf = pdf_area(&scene, shares_at(&scene, from), from, direction, hit.t, &s);
        if facing { pdf } else { 0.0 }
    };
    let draw = |r: &mut _| {
        let s = sample_light(&scene, shares_at(&scene, from), from, rng_next(r));
        (s.radiance.x > 0.0 && pdf(turn(s.direction)) > 0.0).then_some(turn(s.direction))
    };
    check_density("map", draw, pdf);
}

/// Theory: shadow rays, photons and scattered rays estimate one integral under a textured shape of
/// every kind that emits on both sides.
#[test]
fn methods_agree() {
    let camera =
        Camera { position: DVec3::new(0.0, 1.6, 3.0), target: DVec3::ZERO, fov: 12.0, size: 8 };
    let texture = picture("physics-methods.exr", 3.0);
    for shape in shapes().into_iter().filter(|shape| !shape.contains("planar")).take(6) {
        let text = camera.toml()
            + FLOOR
            + &texture
            + &format!(
                "[[shapes]]\n{shape}\nmaterial = \"black\"\nemission = \"glow\"\n\
                 two_sided_emission = true\ncamera_visible = false\n"
            );
        let by = |method, direct, passes| {
            let seed = 100 * (3 * method as u64 + direct as u64);
            let photons = 1 << 14;
            let settings =
                RenderSettings { method, direct, passes, seed, photons, ..settings(0.03) };
            runs_to(0.1, &text, &settings)
        };
        let sampled = by(Method::Sppm, Direct::Sampled, 4);
        for (name, other) in [
            ("photons", by(Method::Sppm, Direct::Photons, 1)),
            ("scattering", by(Method::Path, Direct::Photons, 16)),
        ] {
            assert_regions(&format!("{shape}: shadow rays and {name}"), &sampled, &other, 0.1);
        }
    }
}
