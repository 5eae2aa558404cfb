//! IES lights, projectors and beams: closed forms by shadow rays and by photons, and densities.

use caustica::low_level::lights::image::pdf_image;
use caustica::low_level::lights::profile::sample_profile;
use caustica::low_level::math::rng::rng_next;
use caustica::low_level::pilots::prepare;
use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use glam::{DVec2, DVec3, Vec2, Vec3};

use super::densities::check as check_density;
use super::irradiance::{FLOOR, check};
use super::lab::*;

/// Theory: a beam lights the floor inside its slanted cylinder with E cos and nothing else.
#[test]
fn beam() {
    let (at, d) = (DVec3::new(-0.3, 0.7, 0.1), DVec3::new(0.4, -1.0, -0.1).normalize());
    let light = format!(
        "[[lights]]\ntype = \"beam\"\nposition = {}\ndirection = {}\nradius = 0.25\nirradiance = 3.0\n",
        list(at),
        list(d)
    );
    check("beam", &light, |p| {
        let along = (p - at).dot(d);
        let off = (p - at - d * along).length();
        if off < 0.25 && along > 0.0 { -3.0 * d.y } else { 0.0 }
    });
}

/// The image point that a projector at `at` throws on `p`, in [0, 1]^2 with v upward, and the
/// irradiance there on the floor for a white image.
fn projected(at: DVec3, target: DVec3, fov: f64, aspect: f64, p: DVec3) -> Option<(DVec2, f64)> {
    let forward = (target - at).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let half = (0.5 * fov).to_radians().tan();
    let d = p - at;
    let z = d.dot(forward);
    let xy = DVec2::new(d.dot(right), d.dot(up) * aspect) / (z * half);
    // a facing screen at depth z receives irradiance / z^2: so intensity is irradiance / cos^3
    let cos = z / d.length();
    let irradiance = -d.y / d.length() / (d.length_squared() * cos.powi(3));
    (xy.abs().max_element() < 1.0).then_some((0.5 * (xy + 1.0), irradiance))
}

/// Theory: a projector of irradiance E lights a screen that faces it at depth z with E / z^2 times
/// its image, upright and unmirrored seen from the projector; the intensity is E / cos^3.
#[test]
fn projector() {
    let at = DVec3::new(-0.2, 0.8, 0.5);
    let target = DVec3::new(0.05, 0.0, -0.05);
    let head = format!(
        "[[lights]]\ntype = \"projector\"\nposition = {}\ntarget = {}\nirradiance = 2.0\nfov = 30.0\n",
        list(at),
        list(target)
    );
    check("white", &(head.clone() + "aspect = 1.5\n"), |p| {
        projected(at, target, 30.0, 1.5, p).map_or(0.0, |(_, e)| 2.0 * e)
    });
    // two columns and three rows of unequal values
    let values = [[0.1, 0.9], [0.5, 0.0], [1.0, 0.3]];
    let path = folder().join("physics-slide.exr");
    let texel = |x: usize, y: usize| {
        let v = values[y][x] as f32;
        (v, v, v)
    };
    exr::prelude::write_rgb_file(path, 2, 3, texel).unwrap();
    let slide = "[textures.slide]\ntype = \"image\"\nfile = \"physics-slide.exr\"\n\
                 filter = \"nearest\"\nwrap = \"clamp\"\n";
    check("slide", &(slide.to_owned() + &head + "texture = \"slide\"\n"), |p| {
        projected(at, target, 30.0, 2.0 / 3.0, p).map_or(0.0, |(uv, e)| {
            2.0 * e * values[((1.0 - uv.y) * 3.0) as usize][(uv.x * 2.0) as usize]
        })
    });
}

/// An IES file of one symmetric table: 1000 cd times the cosine, every 2.5 degrees.
fn cosine() -> String {
    let angles: Vec<f64> = (0..=36).map(|k| 2.5 * f64::from(k)).collect();
    let list = |f: &dyn Fn(f64) -> f64| {
        angles.iter().map(|a| format!("{:.6}", f(*a))).collect::<Vec<_>>().join(" ")
    };
    format!(
        "IESNA:LM-63-2002\nTILT=NONE\n1 3141.6 1 37 1 1 2 0 0 0\n1 1 10\n{}\n0\n{}\n",
        list(&|a| a),
        list(&|a| 1000.0 * a.to_radians().cos().max(0.0))
    )
}

/// Theory: a luminaire of I_0 cos(v) candela brings I_0 / 683 cos(v) cos / d^2 watts per square
/// metre, also where it points aslant.
#[test]
fn ies() {
    let name = file("physics-cosine.ies", cosine().as_bytes());
    let at = DVec3::new(0.1, 0.5, -0.1);
    for d in [DVec3::NEG_Y, DVec3::new(0.5, -1.0, 0.3).normalize()] {
        let light = format!(
            "[[lights]]\ntype = \"ies\"\nfile = \"{name}\"\nposition = {}\ndirection = {}\n",
            list(at),
            list(d)
        );
        check("ies", &light, |p| {
            let to = p - at;
            let way = to.length();
            let cos = to.dot(d).max(0.0) / way;
            1000.0 / 683.0 * cos * (-to.y / way) / (way * way)
        });
    }
}

/// Theory: directions of photons from an IES light follow `pdf_image`, by intensity and solid
/// angle.
#[test]
fn directions_of_ies() {
    let name = file("physics-cosine-directions.ies", cosine().as_bytes());
    let text = format!(
        "version = 1\n[camera]\nposition = [0, -2, 0]\ntarget = [0, 0, 0]\nup = [1, 0, 0]\nfov = 40.0\n\
         [[lights]]\ntype = \"ies\"\nfile = \"{name}\"\nposition = [0, 0, 0]\ndirection = [0.3, 1, 0.2]\n"
    );
    let scene = prepare(&parse(&text), 8, 8).unwrap().tables;
    let light = &scene.lights[0];
    // the image's rows are rings of the bins if y is their axis
    let draw = |r: &mut _| {
        let u = rng_next(r);
        let w = sample_profile(&scene, light, Vec2::new(u.x, u.y));
        Some(Vec3::new(w.z, w.x, w.y))
    };
    check_density("ies", draw, |w| pdf_image(&scene, light, Vec3::new(w.y, w.z, w.x)));
}

/// Theory: shadow rays, photons and paths with shadow rays give one picture of a rough metal and a
/// diffuse floor under an IES light, a projector and a beam together.
#[test]
fn methods_agree() {
    let name = file("physics-cosine-agree.ies", cosine().as_bytes());
    let camera =
        Camera { position: DVec3::new(0.0, 2.0, 4.0), target: DVec3::ZERO, fov: 25.0, size: 8 };
    let text = camera.toml()
        + FLOOR
        + "[textures.tiles]\ntype = \"checker\"\ncolors = [1.0, 0.2]\nscale = [4.0, 4.0]\n\
           [materials.steel]\ntype = \"metal\"\nreflectance = 0.8\nroughness = 0.6\n\
           [[shapes]]\ntype = \"sphere\"\ncenter = [0.3, 0.3, 0]\nradius = 0.3\nmaterial = \"steel\"\n"
        + &format!(
            "[[lights]]\ntype = \"ies\"\nfile = \"{name}\"\nposition = [0.6, 1.5, 0.5]\n\
             [[lights]]\ntype = \"projector\"\nposition = [-1, 1.5, 1]\ntarget = [0, 0, 0]\nirradiance = 2.0\n\
             fov = 40.0\ntexture = \"tiles\"\n\
             [[lights]]\ntype = \"beam\"\nposition = [0.2, 2, 0.1]\ndirection = [0, -1, 0]\nradius = 0.3\n\
             irradiance = 1.0\n"
        );
    let by = |method, direct, passes| {
        let seed = 100 * (3 * method as u64 + direct as u64);
        let settings = RenderSettings { method, direct, passes, seed, ..settings(0.02) };
        runs_to(0.06, &text, &settings)
    };
    let sampled = by(Method::Sppm, Direct::Sampled, 8);
    for (name, other) in [
        ("photons", by(Method::Sppm, Direct::Photons, 4)),
        ("paths", by(Method::Path, Direct::Sampled, 32)),
    ] {
        assert_regions(&format!("shadow rays and {name}"), &sampled, &other, 0.06);
    }
}
