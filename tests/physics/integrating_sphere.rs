//! The integrating sphere: a diffuse hollow ball with a point source inside.

use std::f64::consts::PI;

use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use glam::DVec3;

use super::lab::*;

const R: f64 = 1.5;
const ALBEDO: f64 = 0.7;
const INTENSITY: f64 = 2.0;

fn scene(source: DVec3) -> (Camera, String) {
    let camera = Camera {
        position: DVec3::new(0.2, -0.3, 1.0),
        target: DVec3::new(0.0, 0.2, -1.0),
        fov: 50.0,
        size: 12,
    };
    let text = camera.toml()
        + &format!(
            "[materials.wall]\ntype = \"diffuse\"\nreflectance = {ALBEDO}\n\
             [[shapes]]\ntype = \"sphere\"\ncenter = [0, 0, 0]\nradius = {R}\nmaterial = \"wall\"\n\
             [[lights]]\ntype = \"point\"\nposition = {}\nintensity = {INTENSITY}\n",
            list(source)
        );
    (camera, text)
}

/// The point of the ball's wall in direction `d` from `o`.
fn wall(o: DVec3, d: DVec3) -> DVec3 {
    let d = d.normalize();
    let b = o.dot(d);
    o + d * (-b + (b * b - o.length_squared() + R * R).sqrt())
}

/// Theory: a wall element sends the same irradiance to every other (cos cos' / d^2 = 1 / 4 R^2), so
/// after k >= 1 bounces E_k = Phi rho^k / (4 pi R^2) everywhere, and in sum Phi rho / (4 pi R^2
/// (1 - rho)). Direct light is I cos / d^2, uniform for a source in the middle. `max_bounces` b
/// cuts the sum: photons are stored up to their b-th bounce. The curved wall spreads a disc of
/// radius r over area pi r^2 (1 + O(r^2 / R^2)): below 1e-3 here.
#[test]
fn total() {
    let phi = 4.0 * PI * INTENSITY;
    let indirect = phi * ALBEDO / (4.0 * PI * R * R * (1.0 - ALBEDO));
    for source in [DVec3::ZERO, DVec3::new(0.5, 0.6, -0.3)] {
        let (camera, text) = scene(source);
        let n = camera.size;
        let truth: Vec<f64> = (0..n * n)
            .map(|i| {
                let direct = |k: u32| {
                    let at = glam::DVec2::new((i % n) as f64, (i / n) as f64)
                        + glam::DVec2::new((k % 5) as f64 + 0.5, (k / 5) as f64 + 0.5) / 5.0;
                    let p = wall(camera.position, camera.direction(at / n as f64));
                    let to = source - p;
                    INTENSITY * to.dot(-p) / R / to.length().powi(3)
                };
                ALBEDO / PI * (indirect + (0..25).map(direct).sum::<f64>() / 25.0)
            })
            .collect();
        for direct in DIRECT {
            let rules = [
                (Method::Sppm, RadiusRule::Fixed),
                (Method::Ppm, RadiusRule::Global),
                (Method::Sppm, RadiusRule::Local),
            ];
            // each radius rule with the off-centre source
            let count = if source == DVec3::ZERO { 1 } else { 3 };
            for (method, radius_rule) in rules.into_iter().take(count) {
                let settings = RenderSettings {
                    method,
                    direct,
                    radius_rule,
                    passes: 6,
                    photons: 1 << 13,
                    ..settings(0.05)
                };
                let what = format!("source at {source}, {method:?} {direct:?} {radius_rule:?}");
                runs_to(0.05, &text, &settings).assert_picture(&what, &truth, 0.05);
            }
        }
        let path = RenderSettings { method: Method::Path, passes: 4, ..settings(0.05) };
        runs_to(0.02, &text, &path).assert_picture(
            &format!("source at {source}, Path"),
            &truth,
            0.02,
        );
    }
}

/// Theory: with `max_bounces` b the sum ends after b bounces, and the differences are the single
/// terms rho^k Phi / (4 pi R^2). A photon's roulette must preserve each of them.
#[test]
fn per_bounce() {
    let (_, text) = scene(DVec3::new(0.3, -0.4, 0.2));
    for bounces in 1..4u32 {
        let sum: f64 = (1..=bounces as i32).map(|k| ALBEDO.powi(k)).sum();
        let settings = RenderSettings {
            direct: Direct::Sampled,
            max_bounces: bounces,
            passes: 8,
            photons: 1 << 14,
            ..settings(0.08)
        };
        // direct light cancels: subtract the image without bounces
        let none = RenderSettings { max_bounces: 0, ..settings.clone() };
        let (with, without) = (runs(&text, &settings), runs(&text, &none));
        let means = |r: &Runs| {
            r.pixels.iter().map(|p| p.iter().sum::<f64>() / p.len() as f64).collect::<Vec<_>>()
        };
        let difference: Vec<f64> =
            means(&with).iter().zip(means(&without)).map(|(a, b)| a - b).collect();
        let truth = ALBEDO / PI * INTENSITY / (R * R) * sum;
        assert_agrees(&format!("{bounces} bounces"), Estimate::of(&difference), truth, 0.06);
    }
}
