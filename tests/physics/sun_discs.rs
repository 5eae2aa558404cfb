//! Suns with an angular size: penumbra, the disc that the camera sees, and agreement of methods.

use std::f64::consts::PI;

use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use glam::{DVec2, DVec3};

use super::irradiance::check_from;
use super::lab::*;

/// Irradiance, relative to a surface that faces it, from the part of a sun at the zenith that a
/// half-plane does not hide, whose edge is x = 0 at height `height` above the point `x`. Directions
/// of a disc of angular radius a fill the disc of radius sin a in (d.x, d.z), and the irradiance is
/// proportional to the area there: rays in the strip at d.x are free if x + height d.x / d.y > 0.
fn penumbra(x: f64, height: f64, radius: f64) -> f64 {
    let s = radius.sin();
    const STEPS: usize = 200;
    let step = 2.0 * s / STEPS as f64;
    // along z, d.y = sqrt(1 - d.x^2 - d.z^2) makes the edge a hyperbola
    let at = |i: usize, j: usize| {
        let dx = (i as f64 + 0.5) * step - s;
        let dz = (j as f64 + 0.5) * step - s;
        let off = dx * dx + dz * dz;
        f64::from(off < s * s && x * (1.0 - off).sqrt() + height * dx > 0.0)
    };
    let sum = |weight: &dyn Fn(usize, usize) -> f64| -> f64 {
        (0..STEPS).map(|i| (0..STEPS).map(|j| weight(i, j)).sum::<f64>()).sum()
    };
    let disc = |i: usize, j: usize| {
        let d = DVec2::new(i as f64 + 0.5, j as f64 + 0.5) * step - s;
        f64::from(d.length_squared() < s * s)
    };
    sum(&at) / sum(&disc)
}

/// Theory: the floor next to the edge x = -0.3 of a half-plane receives the part of the disc that
/// the edge does not hide ([`penumbra`]), by shadow rays and by photons.
#[test]
fn penumbra_of_an_edge() {
    let (height, degrees) = (0.5, 40.0f64);
    let camera = Camera { position: DVec3::new(3.0, 1.6, 0.0), ..super::irradiance::camera() };
    let light = format!(
        "[[lights]]\ntype = \"sun\"\ndirection = [0, -1, 0]\nirradiance = 3.0\n\
         angle = {degrees:?}\n\
         [[shapes]]\ntype = \"rectangle\"\norigin = [-3.3, {height:?}, 2]\nu = [3, 0, 0]\n\
         v = [0, 0, -4]\nmaterial = \"black\"\n"
    );
    // a table of the profile, linear in between
    let radius = (0.5 * degrees).to_radians();
    let table: Vec<f64> =
        (0..=240).map(|i| penumbra(f64::from(i - 120) * 0.01, height, radius)).collect();
    check_from(camera, "penumbra", &light, |p| {
        let at = ((p.x + 0.3) / 0.01 + 120.0).clamp(0.0, 239.999);
        let i = at as usize;
        3.0 * (table[i] + (table[i + 1] - table[i]) * at.fract())
    });
}

/// Theory: a camera that looks at the sun sees the radiance E / (pi sin^2 a) inside its disc and
/// nothing outside, in every method.
#[test]
fn the_disc_is_seen() {
    let d = DVec3::new(0.5, 0.9, 0.3).normalize();
    let camera = Camera { position: DVec3::ZERO, target: d, fov: 60.0, size: 12 };
    let light = format!(
        "[[lights]]\ntype = \"sun\"\ndirection = {}\nirradiance = 3.0\nangle = 40.0\n",
        list(-d)
    );
    let radiance = 3.0 / (PI * 20f64.to_radians().sin().powi(2));
    let n = camera.size as usize;
    let sub = 32;
    let truth: Vec<f64> = (0..n * n)
        .map(|i| {
            let points = (0..sub * sub).map(|k| {
                let at = DVec2::new((k % sub) as f64 + 0.5, (k / sub) as f64 + 0.5) / sub as f64;
                let at = (at + DVec2::new((i % n) as f64, (i / n) as f64)) / n as f64;
                let cos = camera.direction(at).normalize().dot(d);
                radiance * f64::from(cos > 20f64.to_radians().cos())
            });
            points.sum::<f64>() / (sub * sub) as f64
        })
        .collect();
    for method in [Method::Sppm, Method::Path] {
        let settings = RenderSettings { method, passes: 32, photons: 1, ..settings(0.1) };
        let name = format!("disc, {method:?}");
        runs_to(0.02, &(camera.toml() + light.as_str()), &settings)
            .assert_picture(&name, &truth, 0.02);
    }
}

/// Theory: shadow rays, photons and paths estimate one integral. Two suns and a sky light a rough
/// metal, whose scattered rays find the discs too, and a glass ball, whose caustic path tracing
/// finds because the discs have a size.
#[test]
fn methods_agree() {
    let camera =
        Camera { position: DVec3::new(0.0, 2.0, 4.0), target: DVec3::ZERO, fov: 30.0, size: 12 };
    let text = camera.toml()
        + super::irradiance::FLOOR
        + "[materials.steel]\ntype = \"metal\"\nreflectance = 0.8\nroughness = 0.4\n\
           [materials.glass]\ntype = \"glass\"\nior = 1.5\n\
           [[shapes]]\ntype = \"sphere\"\ncenter = [0.45, 0.3, 0]\nradius = 0.3\n\
           material = \"steel\"\n\
           [[shapes]]\ntype = \"sphere\"\ncenter = [-0.45, 0.35, 0]\nradius = 0.3\n\
           material = \"glass\"\n\
           [[lights]]\ntype = \"sun\"\ndirection = [0.3, -1, -0.2]\nirradiance = 2.0\n\
           angle = 30.0\n\
           [[lights]]\ntype = \"sun\"\ndirection = [-0.6, -1, -0.4]\nirradiance = 1.0\n\
           angle = 50.0\n\
           [environment]\nradiance = 0.2\n";
    let by = |method, direct, passes| {
        let seed = 100 * (3 * method as u64 + direct as u64);
        let settings = RenderSettings { method, direct, passes, seed, ..settings(0.02) };
        runs_to(0.06, &text, &settings)
    };
    let paths = by(Method::Path, Direct::Sampled, 64);
    for (name, other) in [
        ("sampled", by(Method::Sppm, Direct::Sampled, 8)),
        ("photons", by(Method::Sppm, Direct::Photons, 8)),
        ("scattering", by(Method::Path, Direct::Photons, 256)),
    ] {
        assert_regions(&format!("suns: paths and {name}"), &paths, &other, 0.06);
    }
}
