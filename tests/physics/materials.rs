//! Properties of every material, tested on the examples in its file, and closed forms of scenes.

use std::f64::consts::PI;

use caustica::low_level::geometry::surface::Surface;
use caustica::low_level::materials::shading::{IMPORTANCE, Lobe, RADIANCE, ShadingPoint};
use caustica::low_level::materials::{Bsdf, eval_rough, pdf_rough, sample_rough};
use caustica::low_level::math::rng::rng_next;
use caustica::low_level::math::sampling::sample_sphere;
use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use caustica::low_level::shapes::table::NONE;
use glam::{DVec3, Vec2, Vec3};

use super::densities::{check, rng};
use super::lab::*;

/// Every example of a rough material, with a name.
fn lobes() -> Vec<(String, Lobe)> {
    let mut lobes = Vec::new();
    for bsdf in Bsdf::ALL.iter().copied().filter(|bsdf| !bsdf.is_specular()) {
        for (k, m) in bsdf.examples().enumerate() {
            let lobe = Lobe { bsdf, alpha: m.alpha, reflectance: m.reflectance };
            lobes.push((format!("{} {k}", bsdf.name()), lobe));
        }
    }
    lobes
}

/// A shading point in the plane z = 0 seen from `wo`.
fn point(lobe: Lobe, wo: Vec3) -> ShadingPoint {
    let s = Surface {
        position: Vec3::ZERO,
        error: 0.0,
        normal: Vec3::Z,
        material: 0,
        shading: Vec3::Z,
        light: NONE,
        uv: Vec2::ZERO,
        v: 0.0,
        outline: NONE,
    };
    ShadingPoint { s, wo, ng: Vec3::Z, ns: Vec3::Z, n: Vec3::Z, lobe }
}

fn direction(cos: f32, turn: f32) -> Vec3 {
    let sin = (1.0 - cos * cos).sqrt();
    Vec3::new(sin * turn.cos(), sin * turn.sin(), cos)
}

const COSINES: [f32; 3] = [0.95, 0.5, 0.15];

/// Theory: random numbers are multiples of 2^-24 below 1, so a diffuse surface sends photons at
/// cosines of at least 2^-12 with the geometric normal, and none to its back. `sample_diffuse`
/// relies on that.
#[test]
fn photons_leave_on_the_side_they_came_from() {
    let mut rng = rng();
    let lobe = Lobe { bsdf: Bsdf::Diffuse, alpha: 0.0, reflectance: Vec3::ONE };
    let mut least = 1f32;
    for _ in 0..100_000 {
        let u = rng_next(&mut rng);
        let n = sample_sphere(Vec2::new(u.x, u.y));
        let at = point(lobe, n);
        let p =
            ShadingPoint { ng: n, ns: n, n, s: Surface { normal: n, shading: n, ..at.s }, ..at };
        let grazing = Vec2::new(1.0 - 2f32.powi(-24), u.z);
        let drawn = sample_rough(&p, grazing, IMPORTANCE);
        assert_eq!(drawn.weight, Vec3::ONE, "{n:?}");
        least = least.min(drawn.direction.dot(n));
    }
    assert!((2f32.powi(-13)..2f32.powi(-11)).contains(&least), "{least}");
}

/// Theory: drawn directions follow the density (chi-square; a density off by 5 % is detected), and
/// the weight of each is BSDF times cosine over density.
#[test]
fn directions_follow_their_density() {
    for (name, lobe) in lobes() {
        for cos in COSINES {
            let p = point(lobe, direction(cos, 0.7));
            let mut worst = 0f32;
            let mut rng = rng();
            for _ in 0..2000 {
                let u = rng_next(&mut rng);
                let drawn = sample_rough(&p, Vec2::new(u.x, u.y), RADIANCE);
                let pdf = pdf_rough(&p.lobe, p.n, p.wo, drawn.direction);
                let f = eval_rough(&p.lobe, p.n, p.wo, drawn.direction);
                if drawn.weight.max_element() > 0.0 {
                    let off = (f / pdf - drawn.weight).abs().max_element();
                    worst = worst.max(off / drawn.weight.max_element());
                }
            }
            assert!(worst < 2e-3, "{name} at {cos}: weights are off by {worst}");
            let draw = |rng: &mut _| {
                let u = rng_next(rng);
                let drawn = sample_rough(&p, Vec2::new(u.x, u.y), RADIANCE);
                (drawn.weight.max_element() > 0.0).then_some(drawn.direction)
            };
            check(&format!("{name} at {cos}"), draw, |w| pdf_rough(&p.lobe, p.n, p.wo, w));
        }
    }
}

/// Integral of BSDF times cosine over all directions, by the midpoint rule.
fn albedo(lobe: &Lobe, wo: Vec3) -> DVec3 {
    let (rows, columns) = (600, 240);
    let mut sum = DVec3::ZERO;
    for i in 0..rows {
        let z = 2.0 * (i as f32 + 0.5) / rows as f32 - 1.0;
        for j in 0..columns {
            let turn = std::f32::consts::TAU * (j as f32 + 0.5) / columns as f32;
            sum += eval_rough(lobe, Vec3::Z, wo, direction(z, turn)).as_dvec3();
        }
    }
    sum * (4.0 * PI / f64::from(rows * columns))
}

/// Theory: no material scatters more than the share that its reflectance states, and wide ones no
/// less than three quarters of it. Exchanging the two directions does not change the BSDF.
#[test]
fn energy_and_reciprocity() {
    for (name, lobe) in lobes() {
        for cos in COSINES {
            let wo = direction(cos, 0.3);
            let (found, most) = (albedo(&lobe, wo), lobe.reflectance.as_dvec3());
            // Schlick's term rises to 1 at grazing angles
            let most = if lobe.bsdf == Bsdf::Metal { DVec3::ONE } else { most };
            assert!((found - most).max_element() < 2e-3, "{name} at {cos}: {found} of {most}");
            let least = if lobe.bsdf.is_wide() { 0.75 } else { 0.0 };
            assert!((found - most * least).min_element() > 0.0, "{name} at {cos}: {found}");
            for k in 0..200 {
                let z = (k as f32 + 0.5) / 100.0 - 1.0;
                if z.abs() < 0.05 || (z < 0.0 && !lobe.bsdf.transmits()) {
                    continue;
                }
                let wi = direction(z, 0.1 * k as f32);
                let there = eval_rough(&lobe, Vec3::Z, wo, wi) / z.abs();
                let n = Vec3::Z * z.signum();
                let back = eval_rough(&lobe, n, wi, wo) / cos;
                let off = (there - back).abs().max_element();
                assert!(off <= 1e-4 * there.max_element().max(1e-3), "{name}: {there} {back}");
            }
        }
    }
}

const CAMERA: Camera =
    Camera { position: DVec3::new(0.2, 1.2, 1.6), target: DVec3::ZERO, fov: 3.0, size: 4 };

/// A floor of this material under a camera that looks down, with a point light.
fn floor(material: &str, light: [f64; 3]) -> String {
    format!(
        "{}[materials.m]\n{material}\n[[shapes]]\ntype = \"rectangle\"\norigin = [-1, 0, 1]\n\
         u = [2, 0, 0]\nv = [0, 0, -2]\nmaterial = \"m\"\n\
         [[lights]]\ntype = \"point\"\nposition = {light:?}\nintensity = 1.0\n",
        CAMERA.toml()
    )
}

/// Checks that all methods agree with a closed form of the floor's radiance.
fn agrees(name: &str, text: &str, radiance: impl Fn(DVec3) -> f64 + Sync) {
    let picture = CAMERA.floor_picture(0.0, radiance);
    let truth = picture.iter().sum::<f64>() / picture.len() as f64;
    for (method, direct) in [
        (Method::Sppm, Direct::Sampled),
        (Method::Sppm, Direct::Photons),
        (Method::Ppm, Direct::Photons),
        (Method::Path, Direct::Sampled),
    ] {
        let settings = RenderSettings { method, direct, ..settings(0.03) };
        let found = runs_to(0.05, text, &settings).region(|_, _| true);
        assert_agrees(&format!("{name}, {method:?} {direct:?}"), found, truth, 0.05);
    }
}

/// Theory: `L = f I cos / d^2` with the model's `f` in double precision.
#[test]
fn rough_floor() {
    for sigma in [0.3, 1.0] {
        let material = format!("type = \"diffuse\"\nreflectance = 0.7\nroughness = {sigma:?}");
        let at = DVec3::new(1.1, 0.9, 0.4);
        let radiance = |p: DVec3| {
            let (wi, wo) = ((at - p).normalize(), (CAMERA.position - p).normalize());
            let s = wi.dot(wo) - wi.y * wo.y;
            let t = if s > 0.0 { wi.y.max(wo.y) } else { 1.0 };
            let f = 0.7 * (1.0 + sigma * s / t) / (PI + (PI / 2.0 - 2.0 / 3.0) * sigma);
            f * wi.y / at.distance_squared(p)
        };
        agrees(&format!("roughness {sigma}"), &floor(&material, at.into()), radiance);
    }
}

/// Theory: a translucent floor lit from below has the radiance `rho tau I cos / (pi d^2)`, lit from
/// above `rho (1 - tau) I cos / (pi d^2)`.
#[test]
fn translucent_floor() {
    for (tau, height) in [(0.4, -0.9), (0.4, 0.9), (1.0, -0.9)] {
        let material = format!("type = \"translucent\"\nreflectance = 0.8\ntransmission = {tau:?}");
        let at = DVec3::new(0.5, height, 0.2);
        let share = if height < 0.0 { tau } else { 1.0 - tau };
        let radiance = |p: DVec3| 0.8 * share * height.abs() / (PI * at.distance(p).powi(3));
        let name = format!("transmission {tau}, light at {height}");
        agrees(&name, &floor(&material, at.into()), radiance);
    }
}
