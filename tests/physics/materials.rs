//! Properties of every material, tested on the examples in its file, and closed forms of scenes.

use std::f64::consts::PI;

use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::{Surface, surface_at};
use caustica::low_level::materials::fresnel::{fresnel_conductor, schlick};
use caustica::low_level::materials::plastic_base::coat_reflectance;
use caustica::low_level::materials::shading::{IMPORTANCE, Lobe, RADIANCE, ShadingPoint};
use caustica::low_level::materials::{Bsdf, eval_rough, pdf_rough, sample_rough};
use caustica::low_level::math::rng::rng_next;
use caustica::low_level::math::sampling::sample_sphere;
use caustica::low_level::pack::albedo::Albedo;
use caustica::low_level::pilots::prepare;
use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::shapes::table::NONE;
use caustica::low_level::tables::Material;
use glam::{DVec3, Vec2, Vec3};

use super::densities::{check, rng};
use super::lab::*;

/// Every example of a rough material, with a name.
fn lobes() -> Vec<(String, Lobe<'static>)> {
    let mut lobes = Vec::new();
    for bsdf in Bsdf::ALL.iter().copied() {
        if bsdf.is_specular() || bsdf.is_layered() {
            continue;
        }
        for (k, m) in bsdf.examples().enumerate() {
            lobes.push((format!("{} {k}", bsdf.name()), lobe(bsdf, m)));
        }
    }
    // metals that scatter light several times
    for bsdf in [Bsdf::Metal, Bsdf::Conductor] {
        for (k, m) in bsdf.examples().enumerate() {
            let mut m = Material { alpha: 0.6, mean_fresnel: Vec3::new(0.9, 0.7, 0.4), ..m };
            Albedo::of(0.6, |_| 1.0).store(&mut m);
            lobes.push((format!("{} {k}, again", bsdf.name()), lobe(bsdf, m)));
        }
    }
    lobes
}

fn lobe(bsdf: Bsdf, m: Material) -> Lobe<'static> {
    let (alpha, reflectance) = (m.alpha, m.reflectance);
    Lobe { bsdf, alpha, reflectance, material: 0, m: Box::leak(Box::new(m)) }
}

/// A shading point in the plane z = 0 seen from `wo`.
fn point(lobe: Lobe<'_>, wo: Vec3) -> ShadingPoint<'_> {
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
    ShadingPoint { s, wo, ng: Vec3::Z, ns: Vec3::Z, n: Vec3::Z, bent: false, lobe }
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
    let lobe = lobe(Bsdf::Diffuse, Material { reflectance: Vec3::ONE, ..Material::EMPTY });
    let mut least = 1f32;
    for _ in 0..100_000 {
        let u = rng_next(&mut rng);
        let n = sample_sphere(Vec2::new(u.x, u.y));
        let at = point(lobe, n);
        let p =
            ShadingPoint { ng: n, ns: n, n, s: Surface { normal: n, shading: n, ..at.s }, ..at };
        let grazing = Vec3::new(1.0 - 2f32.powi(-24), u.z, 0.0);
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
                let drawn = sample_rough(&p, u.truncate(), RADIANCE);
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
                let drawn = sample_rough(&p, u.truncate(), RADIANCE);
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
            // Fresnel terms rise to 1 at grazing angles
            let rises = matches!(
                lobe.bsdf,
                Bsdf::Metal | Bsdf::Conductor | Bsdf::Brushed | Bsdf::Coat | Bsdf::RoughPane
            );
            let most = if rises { DVec3::ONE } else { most };
            // radiance is compressed into a smaller solid angle inside glass
            let glass = lobe.bsdf == Bsdf::RoughGlass;
            let eta = lobe.reflectance.x;
            let most = if glass { DVec3::splat(eta.max(1.0).powi(2).into()) } else { most };
            assert!((found - most).max_element() < 2e-3, "{name} at {cos}: {found} of {most}");
            let least = if lobe.bsdf.is_wide() { 0.75 } else { 0.0 };
            assert!((found - most * least).min_element() > 0.0, "{name} at {cos}: {found}");
            for k in 0..200 {
                let z = (k as f32 + 0.5) / 100.0 - 1.0;
                if z.abs() < 0.05 || (z < 0.0 && !lobe.bsdf.transmits()) {
                    continue;
                }
                let wi = direction(z, 0.1 * k as f32);
                // the base of plastic leaves out the coat's transmittance on the side of `wo`
                let coat = |cos: f32| match lobe.bsdf {
                    Bsdf::PlasticBase => 1.0 - coat_reflectance(lobe.m, cos),
                    _ => 1.0,
                };
                let there = eval_rough(&lobe, Vec3::Z, wo, wi) * (coat(cos) / z.abs());
                let n = Vec3::Z * z.signum();
                let passes = glass && z < 0.0;
                // seen from the other side, and radiance over the squared index
                let (reflectance, spread) = if passes {
                    (lobe.reflectance.recip(), eta * eta)
                } else {
                    (lobe.reflectance, 1.0)
                };
                let other = Lobe { reflectance, ..lobe };
                let back = eval_rough(&other, n, wi, wo) * (coat(z) / cos * spread);
                let off = (there - back).abs().max_element();
                // a facet's normal is computed from either side
                let rounding = if glass { 2e-3 } else { 1e-4 };
                let bound = rounding * there.max_element().max(1e-3);
                assert!(off <= bound, "{name}: {there} {back}");
            }
        }
    }
}

pub const CAMERA: Camera =
    Camera { position: DVec3::new(0.2, 1.2, 1.6), target: DVec3::ZERO, fov: 3.0, size: 4 };

/// A floor of this material under a camera that looks down, with a point light.
pub fn floor(material: &str, light: [f64; 3]) -> String {
    format!(
        "{}[materials.m]\n{material}\n[[shapes]]\ntype = \"rectangle\"\norigin = [-1, 0, 1]\n\
         u = [2, 0, 0]\nv = [0, 0, -2]\nmaterial = \"m\"\n\
         [[lights]]\ntype = \"point\"\nposition = {light:?}\nintensity = 1.0\n",
        CAMERA.toml()
    )
}

/// Checks that all methods agree with a closed form of the floor's radiance.
pub fn agrees(name: &str, text: &str, radiance: impl Fn(DVec3) -> f64 + Sync) {
    let picture = CAMERA.floor_picture(0.0, radiance);
    let truth = picture.iter().sum::<f64>() / picture.len() as f64;
    for (method, direct) in [
        (Method::Sppm, Direct::Sampled),
        (Method::Sppm, Direct::Photons),
        (Method::Ppm, Direct::Photons),
        (Method::Path, Direct::Sampled),
    ] {
        // fixed visible points choose a layer once
        let settings = RenderSettings { method, direct, eye_samples: 16, ..settings(0.03) };
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

/// Fresnel reflectance of a dielectric from Snell's law, in angles: an independent form of
/// `fresnel`.
fn reflectance(cos: f64, n: f64) -> f64 {
    let theta = cos.acos();
    let inside = (theta.sin() / n).asin();
    let s = ((theta - inside).sin() / (theta + inside).sin()).powi(2);
    let p = ((theta - inside).tan() / (theta + inside).tan()).powi(2);
    if theta < 1e-6 { ((n - 1.0) / (n + 1.0)).powi(2) } else { 0.5 * (s + p) }
}

/// Mean reflectance of a dielectric over the hemisphere, weighted by the cosine.
fn mean_reflectance(n: f64) -> f64 {
    let steps = 4000;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| 2.0 * at(i) * reflectance(at(i), n)).sum::<f64>() / f64::from(steps)
}

/// Theory: at normal incidence a conductor reflects `((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)`,
/// at grazing angles all light, without extinction as much as a dielectric, and Schlick's term is
/// within 0.05 for metals like gold.
#[test]
fn fresnel_of_conductors() {
    let (eta, k) = (Vec3::new(0.14, 0.38, 1.44), Vec3::new(3.97, 2.38, 1.6));
    let normal = fresnel_conductor(1.0, eta, k);
    for c in 0..3 {
        let (eta, k) = (eta[c], k[c]);
        let below = (eta - 1.0) * (eta - 1.0) + k * k;
        let truth = below / ((eta + 1.0) * (eta + 1.0) + k * k);
        assert!((normal[c] - truth).abs() < 1e-6, "{} {truth}", normal[c]);
    }
    assert!((fresnel_conductor(0.0, eta, k) - Vec3::ONE).length() < 1e-6);
    for i in 1..100 {
        let cos = i as f32 / 100.0;
        let clear = fresnel_conductor(cos, Vec3::splat(1.5), Vec3::ZERO).x;
        let truth = reflectance(f64::from(cos), 1.5);
        assert!((f64::from(clear) - truth).abs() < 1e-6, "{cos}: {clear} {truth}");
        let off = (fresnel_conductor(cos, eta, k) - schlick(normal, cos)).abs().max_element();
        assert!(off < 0.05, "{cos}: {off}");
    }
}

/// Theory: below a smooth coat `L = (1 - F(cos_o)) (1 - F(cos_i)) rho_b I cos / (pi d^2)`, with
/// `rho_b` as `materials/plastic.rs` states it: diffuse light below the coat meets a reflectance of
/// `F_i = 1 - (1 - F_avg) / n^2`, and the base reflects `rho / (1 - rho F_i)` of it, or, without
/// the color of the reflections inside, `rho / (1 - F_i)`.
#[test]
fn plastic_floor() {
    let n = 1.5;
    let inside = 1.0 - (1.0 - mean_reflectance(n)) / (n * n);
    for nonlinear in [false, true] {
        let rho = 0.6;
        let material = format!("type = \"plastic\"\nreflectance = {rho}\nnonlinear = {nonlinear}");
        let at = DVec3::new(0.9, 0.7, -0.5);
        let base = rho / (n * n) / (1.0 - if nonlinear { rho * inside } else { inside });
        let radiance = |p: DVec3| {
            let (wi, wo) = ((at - p).normalize(), (CAMERA.position - p).normalize());
            let passed = (1.0 - reflectance(wi.y, n)) * (1.0 - reflectance(wo.y, n));
            passed * base * wi.y / (PI * at.distance_squared(p))
        };
        agrees(&format!("nonlinear {nonlinear}"), &floor(&material, at.into()), radiance);
    }
}

/// Theory: `f = F D G / (4 cos_o cos_i)` of the GGX distribution with Smith's heights, and the
/// exact Fresnel term, in double precision, plus the light that is scattered several times.
#[test]
fn conductor_floor() {
    use caustica::low_level::double::materials::fresnel::fresnel_conductor;
    let (eta, k, roughness) = (DVec3::new(0.2, 0.9, 1.4), DVec3::new(3.9, 2.4, 1.9), 0.8f64);
    let material = format!(
        "type = \"metal\"\neta = [0.2, 0.9, 1.4]\nk = [3.9, 2.4, 1.9]\nroughness = {roughness}"
    );
    let at = DVec3::new(-0.6, 1.0, -0.8);
    let alpha = roughness * roughness;
    let albedo = Albedo::of(alpha, |_| 1.0);
    let once = |cos: f64| {
        albedo.terms.iter().enumerate().map(|(i, t)| t * cos.powi(i as i32)).sum::<f64>()
    };
    let mean = {
        let cos = |i: i32| (f64::from(i) + 0.5) / 1000.0;
        (0..1000).map(|i| fresnel_conductor(cos(i), eta, k) * (2.0 * cos(i))).sum::<DVec3>() / 1e3
    };
    let radiance = |p: DVec3| {
        let (wi, wo) = ((at - p).normalize(), (CAMERA.position - p).normalize());
        let h = (wi + wo).normalize();
        let d = alpha * alpha / (PI * (h.y * h.y * (alpha * alpha - 1.0) + 1.0).powi(2));
        let lambda = |w: DVec3| {
            let tan_sq = (1.0 - w.y * w.y) / (w.y * w.y);
            0.5 * ((1.0 + alpha * alpha * tan_sq).sqrt() - 1.0)
        };
        let g = 1.0 / (1.0 + lambda(wi) + lambda(wo));
        let single = fresnel_conductor(wo.dot(h), eta, k) * (d * g / (4.0 * wi.y * wo.y));
        let e = albedo.mean();
        let lost = (1.0 - once(wi.y)) * (1.0 - once(wo.y)) / (PI * (1.0 - e));
        let again = mean * mean * e / (DVec3::ONE - mean * (1.0 - e)) * lost;
        let f = single + again;
        // the harness compares the mean of the channels
        (f.x + f.y + f.z) / 3.0 * wi.y / at.distance_squared(p)
    };
    agrees("conductor", &floor(&material, at.into()), radiance);
}

/// Theory: `f = F D G / (4 cos_o cos_i)` of the GGX distribution with the widths .09 along x and
/// .36 along z, with Schlick's term, plus the light of several scatterings (Heitz 2014). The widths
/// exchanged would be off by a factor, and so would be a frame turned by 90 degrees.
#[test]
fn brushed_floor() {
    let material = "type = \"metal\"\nreflectance = 0.7\nroughness = [0.3, 0.6]";
    let (ax, az) = (0.09f64, 0.36f64);
    let at = DVec3::new(-0.15, 1.0, -0.4);
    let albedo = Albedo::of_brushed([ax, az]);
    let once = |cos: f64| {
        albedo.terms.iter().enumerate().map(|(i, t)| t * cos.powi(i as i32)).sum::<f64>()
    };
    let mean = 0.7 * 20.0 / 21.0 + 1.0 / 21.0;
    let radiance = |p: DVec3| {
        let (wi, wo) = ((at - p).normalize(), (CAMERA.position - p).normalize());
        let h = (wi + wo).normalize();
        let d =
            1.0 / (PI * ax * az * ((h.x / ax).powi(2) + (h.z / az).powi(2) + h.y * h.y).powi(2));
        let lambda = |w: DVec3| {
            let slope = ((w.x * ax).powi(2) + (w.z * az).powi(2)) / (w.y * w.y);
            0.5 * ((1.0 + slope).sqrt() - 1.0)
        };
        let g = 1.0 / (1.0 + lambda(wi) + lambda(wo));
        let fresnel = 0.7 + 0.3 * (1.0 - wo.dot(h)).powi(5);
        let single = fresnel * (d * g / (4.0 * wi.y * wo.y));
        let e = albedo.mean();
        let lost = (1.0 - once(wi.y)) * (1.0 - once(wo.y)) / (PI * (1.0 - e));
        let again = mean * mean * e / (1.0 - mean * (1.0 - e)) * lost;
        (single + again) * wi.y / at.distance_squared(p)
    };
    agrees("brushed", &floor(material, at.into()), radiance);
}

/// Theory: a mix of two diffuse materials has the mean reflectance, and a material for each side
/// the reflectance of that side.
#[test]
fn mixed_and_two_sided_floors() {
    let parts = "[materials.a]\ntype = \"diffuse\"\nreflectance = 0.5\n\
                 [materials.b]\ntype = \"diffuse\"\nreflectance = 0.9\n";
    for (material, rho) in [
        ("type = \"mix\"\nmaterials = [\"a\", \"b\"]\namount = 0.3", 0.7 * 0.5 + 0.3 * 0.9),
        ("type = \"two_sided\"\nfront = \"b\"\nback = \"a\"", 0.9),
        ("type = \"two_sided\"\nfront = \"a\"\nback = \"b\"", 0.5),
    ] {
        let at = DVec3::new(0.3, 0.8, -0.2);
        let radiance = |p: DVec3| rho * at.y / (PI * at.distance(p).powi(3));
        agrees(material, &(floor(material, at.into()) + parts), radiance);
    }
}

/// Theory: a ball has the texture coordinates of its own shape, whether its material has a texture
/// itself or consists of others that have.
#[test]
fn parts_of_materials_have_texture_coordinates() {
    let textures = "[textures.t]\ntype = \"checker\"\ncolors = [0.2, 0.8]\n[materials.t]\n\
                    type = \"diffuse\"\nreflectance = \"t\"\n[materials.plain]\n\
                    type = \"diffuse\"\nreflectance = 0.5\n";
    let uv = |material: &str| {
        let text = format!(
            "{}{textures}[materials.m]\n{material}\n[[shapes]]\ntype = \"sphere\"\n\
             center = [0, 0, 0]\nradius = 0.8\nmaterial = \"m\"\n",
            CAMERA.toml()
        );
        let tables = prepare(&parse(&text), 8, 8).unwrap().tables;
        let ball = &tables.spheres[0];
        let center = ball.anchor - ball.normal * ball.radius;
        let ray = Ray {
            origin: center + Vec3::new(0.1, 0.2, 5.0) * ball.radius,
            t_min: 0.0,
            direction: Vec3::NEG_Z,
            t_max: 10.0 * ball.radius,
        };
        surface_at(&tables, &ray, &intersect_scene(&tables, &ray)).uv
    };
    let expected = uv("type = \"diffuse\"\nreflectance = \"t\"");
    assert!(expected.min_element() > 0.0, "{expected}");
    for material in [
        "type = \"two_sided\"\nfront = \"t\"\nback = \"plain\"",
        "type = \"mix\"\nmaterials = [\"plain\", \"t\"]\namount = 0.5",
        "type = \"diffuse\"\nreflectance = 0.5\nopacity = \"t\"",
        "type = \"diffuse\"\nreflectance = \"t\"\nopacity = 0.5",
    ] {
        assert_eq!(uv(material), expected, "{material}");
    }
    assert_eq!(uv("type = \"diffuse\"\nreflectance = 0.5"), Vec2::ZERO);
}

/// Theory: a floor of opacity `a` reflects `a rho` and shows `1 - a` of a lamp below it; a mask
/// shows one or the other. (The lamp is wide and far enough to look even.)
#[test]
fn opacity() {
    let lamp = "[materials.black]\ntype = \"diffuse\"\nreflectance = 0\n[[shapes]]\n\
                type = \"disc\"\ncenter = [0, -1, 0]\nnormal = [0, 1, 0]\nradius = 8\n\
                material = \"black\"\nemission = 0.5\n";
    let at = DVec3::new(0.3, 0.8, -0.2);
    for (opacity, cutoff, there) in [(0.4, None, 0.4), (0.4, Some(0.3), 1.0), (0.4, Some(0.5), 0.0)]
    {
        let cutoff = cutoff.map_or(String::new(), |c: f64| format!("opacity_cutoff = {c}\n"));
        let material =
            format!("type = \"diffuse\"\nreflectance = 0.8\nopacity = {opacity}\n{cutoff}");
        let radiance =
            |p: DVec3| there * 0.8 * at.y / (PI * at.distance(p).powi(3)) + (1.0 - there) * 0.5;
        agrees(&format!("opacity {there}"), &(floor(&material, at.into()) + lamp), radiance);
    }
}

/// Theory: a sheet between a lamp and a diffuse floor leaves `t` of the light: `1 - opacity`, all
/// of it without a material, and `(1 - R) / (1 + R)` through a pane with the reflectance `R` of one
/// face. Shadow rays end at the sheet, so the light arrives as photons.
#[test]
fn light_through_sheets() {
    let at = DVec3::new(0.1, 0.9, 0.1);
    let pane = |cos: f64| {
        let r = reflectance(cos, 1.5);
        (1.0 - r) / (1.0 + r)
    };
    for (sheet, passed) in [
        ("type = \"null\"", (&|_| 1.0) as &(dyn Fn(f64) -> f64 + Sync)),
        ("type = \"diffuse\"\nreflectance = 0\nopacity = 0.25", &|_| 0.75),
        ("type = \"glass\"\nior = 1.5\nthin = true\ntransmittance = 0.8", &|cos| 0.8 * pane(cos)),
    ] {
        // a dark floor, so that a pane sends little of its light back
        let text = floor("type = \"diffuse\"\nreflectance = 0.1", at.into())
            + &format!(
                "[materials.sheet]\n{sheet}\n[[shapes]]\ntype = \"disc\"\n\
                 center = [0, 0.5, 0]\nnormal = [0, 1, 0]\nradius = 0.8\nmaterial = \"sheet\"\n"
            );
        let camera = Camera { position: DVec3::new(0.1, 0.3, 0.9), ..CAMERA };
        let text = text.replace(&CAMERA.toml(), &camera.toml());
        let picture = camera.floor_picture(0.0, |p| {
            let wi = (at - p).normalize();
            0.1 * passed(wi.y) * wi.y / (PI * at.distance_squared(p))
        });
        let truth = picture.iter().sum::<f64>() / picture.len() as f64;
        for (method, direct) in [(Method::Sppm, Direct::Sampled), (Method::Ppm, Direct::Photons)] {
            let settings = RenderSettings { method, direct, ..settings(0.03) };
            let found = runs_to(0.05, &text, &settings).region(|_, _| true);
            assert_agrees(&format!("{sheet}, {method:?} {direct:?}"), found, truth, 0.05);
        }
    }
}

/// Theory: a smooth metal shows an even sky with its Fresnel term, and a pane shows all of it.
#[test]
fn mirrors_of_metal_and_panes() {
    use caustica::low_level::double::materials::fresnel::fresnel_conductor;
    let (eta, k) = (DVec3::new(0.2, 0.9, 1.4), DVec3::new(3.9, 2.4, 1.9));
    for (material, radiance) in [
        (
            "type = \"metal\"\neta = [0.2, 0.9, 1.4]\nk = [3.9, 2.4, 1.9]",
            (&|cos| fresnel_conductor(cos, eta, k).element_sum() / 3.0)
                as &(dyn Fn(f64) -> f64 + Sync),
        ),
        ("type = \"metal\"\nreflectance = 0.3\nroughness = 0", &|cos| {
            0.3 + 0.7 * (1.0 - cos).powi(5)
        }),
        ("type = \"glass\"\nmaterial = \"bk7\"\nthin = true", &|_| 1.0),
    ] {
        let text = format!(
            "{}[materials.m]\n{material}\n[environment]\nradiance = 1\n[[shapes]]\n\
             type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = \"m\"\n",
            CAMERA.toml()
        );
        let seen = |p: DVec3| radiance((CAMERA.position - p).normalize().y);
        let picture = CAMERA.floor_picture(0.0, seen);
        let truth = picture.iter().sum::<f64>() / picture.len() as f64;
        for method in [Method::Sppm, Method::Path] {
            let settings = RenderSettings { method, ..settings(0.03) };
            let found = runs_to(0.03, &text, &settings).region(|_, _| true);
            assert_agrees(&format!("{material}, {method:?}"), found, truth, 0.02);
        }
    }
}
