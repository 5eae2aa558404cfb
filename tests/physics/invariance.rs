//! Invariance under scale and place.

use caustica::low_level::scene::settings::{Direct, Method, Radius, RenderSettings};
use glam::DVec3;

use super::everything::{MESH, everything_with};
use super::lab::*;

/// [`everything_with`] its mesh file.
pub fn everything(scale: f64, shift: DVec3, size: u32) -> String {
    everything_with(&file("physics-everything.obj", MESH.as_bytes()), scale, shift, size)
}

fn settings_at(scale: f64, method: Method) -> RenderSettings {
    RenderSettings {
        method,
        direct: Direct::Photons,
        passes: 2,
        photons: 1 << 13,
        radius: Radius::Units(0.05 * scale),
        ..settings(0.05)
    }
}

/// Theory: scaling by a power of two changes no mantissa, neither of lengths nor, by its square, of
/// intensities. So every bit of the image stays.
#[test]
fn powers_of_two_change_no_bit() {
    for method in [Method::Sppm, Method::Path] {
        let picture = |scale: f64| {
            render(&parse(&everything(scale, DVec3::ZERO, 32)), &settings_at(scale, method))
        };
        let (one, other) = (picture(1.0), picture(3.0));
        for scale in [1.0 / 1024.0, 0.5, 4096.0] {
            let scaled = picture(scale);
            let differ = one.rgb.iter().zip(&scaled.rgb).filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "{method:?}: pixels that scale {scale} changes");
        }
        assert_ne!(one.rgb, other.rgb, "the comparison sees what another scale does to rounding");
    }
}

/// Theory: other scales and places change roundings only. Paths part where a rounding changes a
/// decision, so images agree within noise, which equal random numbers keep small.
#[test]
fn scale_and_place_change_nothing() {
    let size = 4.0;
    for method in [Method::Sppm, Method::Path] {
        let base = runs(&everything(1.0, DVec3::ZERO, 16), &settings_at(1.0, method));
        for (scale, shift) in [
            (1e-3, DVec3::ZERO),
            (1e3, DVec3::ZERO),
            (1.0, DVec3::new(1e4, -3e3, 5e3) * size),
            (1e-3, DVec3::new(-1e4, 1e4, 2e3) * size * 1e-3),
        ] {
            let moved = runs(&everything(scale, shift, 16), &settings_at(scale, method));
            let difference: Vec<f64> = (0..RUNS as usize)
                .map(|k| {
                    let (a, b) = (&base.pixels[k], &moved.pixels[k]);
                    a.iter().sum::<f64>() / b.iter().sum::<f64>()
                })
                .collect();
            // every run has its own random numbers: far below the noise between runs
            assert_agrees(
                &format!("{method:?}, scale {scale}, shift {shift}"),
                Estimate::of(&difference),
                1.0,
                0.01,
            );
            let worst = (0..256)
                .map(|i| {
                    let sum = |r: &Runs| r.pixels.iter().map(|p| p[i]).sum::<f64>();
                    (sum(&base) / sum(&moved) - 1.0).abs()
                })
                .fold(0.0, f64::max);
            println!("    worst pixel: {worst:.4}");
        }
    }
}

/// Theory: no point of a convex ball that faces a lamp is in shadow. Under a sun along the camera's
/// axis every pixel on the ball has radiance rho E cos / pi > 0, and a shadowed one 0: at any
/// scale, and next to giants.
#[test]
fn no_ball_shadows_itself() {
    for exponent in -6..=6 {
        for place in [0.0, 1e3] {
            let scale = 10f64.powi(exponent);
            let at = DVec3::new(0.7, 0.4, -0.2) * place * scale;
            let camera = Camera {
                position: at + DVec3::new(0.0, 0.0, 4.0) * scale,
                target: at,
                fov: 20.0,
                size: 96,
            };
            let text = camera.toml()
                + &format!(
                    "[materials.m]\ntype = \"diffuse\"\nreflectance = 1.0\n\
                     [[shapes]]\ntype = \"sphere\"\ncenter = {}\nradius = {:?}\nmaterial = \"m\"\n\
                     [[lights]]\ntype = \"sun\"\ndirection = [0.1, 0.05, -1.0]\nirradiance = 1.0\n",
                    list(at),
                    scale
                );
            let settings = RenderSettings {
                method: Method::Path,
                passes: 1,
                max_bounces: 1,
                ..settings(scale)
            };
            let scene = parse(&text);
            let picture = render(&scene, &settings);
            let to_sun = -DVec3::new(0.1, 0.05, -1.0).normalize();
            let mut dark = 0;
            for (i, c) in picture.rgb.iter().enumerate() {
                let point = glam::DVec2::new((i % 96) as f64 + 0.5, (i / 96) as f64 + 0.5) / 96.0;
                let d = camera.direction(point).normalize();
                let o = camera.position - at;
                let b = o.dot(d);
                let discriminant = b * b - o.length_squared() + scale * scale;
                // one pixel inside the outline and the terminator
                let lit = discriminant > 0.0 && {
                    let n = (o + d * (-b - discriminant.sqrt())) / scale;
                    n.dot(to_sun) > 0.08 && n.dot(-d) > 0.2
                };
                dark += (lit && c[0] <= 0.0) as u32;
            }
            assert_eq!(dark, 0, "shadowed pixels at scale {scale:e}, place {place:e}");
        }
    }
}
