//! Caustics in closed form.

use std::f64::consts::PI;

use caustica::settings::{Direct, RadiusRule, RenderSettings};
use glam::DVec3;

use super::lab::*;

/// So dark that what the floor sends to mirror or glass and gets back counts for less than a thousandth.
const ALBEDO: f64 = 0.002;
const RADIUS: f64 = 0.03;

/// The floor y = 0 and its camera.
fn floor(camera: &Camera) -> String {
    camera.toml()
        + &format!(
            "[materials.floor]\ntype = \"diffuse\"\nreflectance = {ALBEDO}\n[materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3\nmaterial = \"floor\"\n"
        )
}

/// Theory: a paraboloid y = r^2 / 4f makes the light of a point at its focus parallel. A ring of the mirror at radius r
/// takes the solid angle 2 pi sin(theta) dtheta with r = 2 f tan(theta / 2), so that E(r) = (I / f^2) / (1 + r^2 / 4f^2)^2
/// on any plane across the axis. The mirror hangs upside down over the floor; a disc between lamp and floor keeps direct
/// light away (its shadow falls inside r < 0.2). The quadratic profile (0, 0), (a/2, 0), (a, a^2/4f) is that paraboloid
/// exactly.
#[test]
fn paraboloid_mirror() {
    const F: f64 = 0.5;
    const A: f64 = 1.2;
    const I: f64 = 2.0;
    const TOP: f64 = 1.6;
    let camera =
        Camera { position: DVec3::new(0.6, 1.7, 4.0), target: DVec3::new(0.6, 0.0, 0.0), fov: 6.0, size: 16 };
    let text = floor(&camera)
        + &format!(
            "[materials.mirror]\ntype = \"mirror\"\nreflectance = 1.0\n\
             [[shapes]]\ntype = \"revolution\"\nprofile = [[0, 0], [{}, 0], [{A}, {}]]\nmaterial = \"mirror\"\n\
             transform = {{ rotate = {{ axis = [1, 0, 0], degrees = 180 }}, translate = [0, {TOP}, 0] }}\n\
             [[shapes]]\ntype = \"disc\"\ncenter = [0, {}, 0]\nnormal = [0, 1, 0]\nradius = 0.2\nmaterial = \"black\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, {}, 0]\nintensity = {I}\n",
            0.5 * A,
            A * A / (4.0 * F),
            TOP - F - 0.02,
            TOP - F
        );
    for (direct, radius_rule) in [(Direct::Sampled, RadiusRule::Fixed), (Direct::Photons, RadiusRule::Global)]
    {
        let truth = camera.floor_picture(RADIUS, |p| {
            let r2 = p.x * p.x + p.z * p.z;
            ALBEDO / PI * I / (F * F) / (1.0 + r2 / (4.0 * F * F)).powi(2)
        });
        let settings =
            RenderSettings { direct, radius_rule, passes: 4, photons: 1 << 14, ..settings(RADIUS) };
        runs_to(0.05, &text, &settings).assert_picture(&format!("paraboloid, {direct:?}"), &truth, 0.05);
    }
}

/// Theory: rays of a point light at height h that pass a slab of thickness w and index n meet the floor at
/// b(theta) = (h - w) tan(theta) + w tan(theta'), sin(theta) = n sin(theta'), so that E(b) = I T sin(theta) / (b db/dtheta)
/// with T = (1 - R)^2. Light reflected to and fro inside goes 3, 5, ... times through the slab: the same map with 3 w
/// for w and R^2 more, and so on. R is the mean of both polarisations, as the renderer keeps none.
#[test]
fn slab_over_a_floor() {
    const N: f64 = 1.5;
    const W: f64 = 0.3;
    const H: f64 = 1.0;
    const I: f64 = 2.0;
    let camera = Camera { position: DVec3::new(0.0, 0.35, 2.6), target: DVec3::ZERO, fov: 7.0, size: 16 };
    let text = floor(&camera)
        + &format!(
            "[materials.glass]\ntype = \"glass\"\nior = {N:?}\n\
             [[shapes]]\ntype = \"box\"\nmin = [-1.6, 0.5, -1.6]\nmax = [1.6, 0.8, 1.6]\nmaterial = \"glass\"\n\
             [[lights]]\ntype = \"point\"\nposition = [0, {H}, 0]\nintensity = {I}\n"
        );
    let reflectance = |c: f64, ct: f64| {
        let s = (c - N * ct) / (c + N * ct);
        let p = (N * c - ct) / (N * c + ct);
        0.5 * (s * s + p * p)
    };
    // irradiance at b by light that went 2 k + 1 times through the slab
    let order = |b: f64, k: i32| {
        let ways = W * (2 * k + 1) as f64;
        let place = |theta: f64| (H - W) * theta.tan() + ways * (theta.sin() / N).asin().tan();
        let (mut low, mut high) = (0.0, 1.55);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if place(middle) < b { low = middle } else { high = middle }
        }
        let theta = 0.5 * (low + high);
        let slope = (place(theta + 1e-5) - place(theta - 1e-5)) / 2e-5;
        let ct = (1.0 - (theta.sin() / N).powi(2)).sqrt();
        let r = reflectance(theta.cos(), ct);
        I * (1.0 - r).powi(2) * r.powi(2 * k) * theta.sin() / (b * slope)
    };
    let truth = camera.floor_picture(RADIUS, |p| {
        let b = p.x.hypot(p.z).max(1e-3);
        ALBEDO / PI * (order(b, 0) + order(b, 1) + order(b, 2))
    });
    let settings = RenderSettings { passes: 4, photons: 1 << 14, ..settings(RADIUS) };
    runs_to(0.05, &text, &settings).assert_picture("slab", &truth, 0.05);
}
