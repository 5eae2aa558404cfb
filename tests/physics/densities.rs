//! Samplers of directions and points against their stated densities.
//!
//! Theory: a sampler with density p draws a bin with the bin's integral of p. The counts of N draws
//! over bins follow a multinomial law, and sum (count - N P)^2 / (N P) is chi-square with
//! (bins - 1) degrees of freedom: mean k, variance 2k. Bins with fewer than 10 expected draws are
//! pooled.

use std::f64::consts::PI;

use caustica::low_level::geometry::intersect::intersect_scene;
use caustica::low_level::geometry::surface::surface_at;
use caustica::low_level::lights::area::pdf_area;
use caustica::low_level::lights::environment::{
    eval_environment, pdf_environment, sample_environment,
};
use caustica::low_level::lights::light::sample_light;
use caustica::low_level::lights::select::{choose_light, share_of, shares_at};
use caustica::low_level::lights::shape::sample_shape;
use caustica::low_level::lights::sun_disc::{in_sun_disc, pdf_sun_disc, sample_sun_disc};
use caustica::low_level::materials::microfacet::{
    facets_at, ggx_pdf, ggx_visible_normal, sample_facets,
};
use caustica::low_level::math::mirrored;
use caustica::low_level::math::rng::{Rng, rng_new, rng_next};
use caustica::low_level::math::sampling::*;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::shapes::ray::Ray;
use caustica::low_level::shapes::table::NONE;
use glam::{DVec3, Vec2, Vec3};

use super::lab::*;

const DRAWS: u32 = 400_000;
const ROWS: usize = 16;
const COLUMNS: usize = 24;

pub fn rng() -> Rng {
    rng_new(5, 6, 7, 8)
}

/// Bin of a direction: equal steps of z and of the azimuth.
fn bin(w: Vec3) -> usize {
    let row = (((w.z as f64 + 1.0) * 0.5 * ROWS as f64) as usize).min(ROWS - 1);
    let turn = (w.y as f64).atan2(w.x as f64) / (2.0 * PI) + 0.5;
    row * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

/// Integral of `pdf` over every bin, by the midpoint rule.
fn shares(pdf: impl Fn(Vec3) -> f32) -> Vec<f64> {
    // finer in z, where a small cone about the axis covers little
    const SUB: usize = 24;
    const FINE: usize = 144;
    let area = 4.0 * PI / (ROWS * COLUMNS * SUB * FINE) as f64;
    let mut shares = vec![0.0; ROWS * COLUMNS];
    for i in 0..ROWS * FINE {
        for j in 0..COLUMNS * SUB {
            let z = 2.0 * (i as f64 + 0.5) / (ROWS * FINE) as f64 - 1.0;
            let (s, c) = (2.0 * PI * ((j as f64 + 0.5) / (COLUMNS * SUB) as f64 - 0.5)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let w = DVec3::new(r * c, r * s, z).as_vec3();
            shares[i / FINE * COLUMNS + j / SUB] += pdf(w) as f64 * area;
        }
    }
    shares
}

/// Number of standard deviations of chi-square above its mean; `slack` is the relative quadrature
/// error of a share.
fn excess(counts: &[u32], shares: &[f64], slack: f64) -> f64 {
    let (mut sum, mut bins, mut pool) = (0.0, 0.0, (0.0, 0.0));
    let n = DRAWS as f64;
    let mut add = |count: f64, expected: f64| {
        let variance = expected + (slack * expected).powi(2);
        sum += (count - expected).powi(2) / variance;
        bins += 1.0;
    };
    for (count, share) in counts.iter().zip(shares) {
        if n * share < 10.0 {
            pool = (pool.0 + *count as f64, pool.1 + n * share);
        } else {
            add(*count as f64, n * share);
        }
    }
    if pool.1 > 10.0 {
        add(pool.0, pool.1);
    } else {
        assert!(pool.0 <= pool.1 + 30.0, "{} draws where {} are expected", pool.0, pool.1);
    }
    let k: f64 = bins - 1.0;
    (sum - k) / (2.0 * k).sqrt()
}

/// Checks that draws of `draw` follow `pdf`, and that a density scaled by 1.05 on half the sphere
/// is rejected.
pub fn check(name: &str, draw: impl Fn(&mut Rng) -> Option<Vec3>, pdf: impl Fn(Vec3) -> f32) {
    let mut rng = rng();
    let mut counts = vec![0; ROWS * COLUMNS];
    for _ in 0..DRAWS {
        if let Some(w) = draw(&mut rng) {
            counts[bin(w)] += 1;
        }
    }
    let shares = shares(pdf);
    let right = excess(&counts, &shares, 3e-3);
    let total: f64 = shares.iter().sum();
    let planted: Vec<f64> = shares
        .iter()
        .enumerate()
        .map(|(i, s)| s * if i % COLUMNS < COLUMNS / 2 { 1.05 } else { 0.95 })
        .collect();
    let wrong = excess(&counts, &planted, 3e-3);
    println!(
        "{name}: chi-square {right:+.1} sigma, planted {wrong:+.1} sigma, the density's integral {total:.5}"
    );
    assert!(right < 6.0, "{name}: {right}");
    assert!(wrong > 6.0, "{name}: a density off by 5 % is not found");
}

/// Theory: the densities that the functions' comments state.
#[test]
fn basic_maps() {
    let two = |rng: &mut Rng| {
        let u = rng_next(rng);
        Vec2::new(u.x, u.y)
    };
    check("cosine", |r| Some(sample_cosine(two(r))), |w| w.z.max(0.0) / PI as f32);
    check("sphere", |r| Some(sample_sphere(two(r))), |_| PDF_SPHERE);
    // a bin's edge coincides with the cone's: 1 - cos = 4 / 8
    check(
        "cone",
        |r| Some(sample_cone(two(r), 0.5)),
        |w| if w.z > 0.5 { 1.0 / (PI as f32) } else { 0.0 },
    );
    let (mut disc, mut triangle) = ([0.0f64; 3], [0.0f64; 3]);
    let mut rng = rng();
    for _ in 0..DRAWS {
        let d = sample_disc(two(&mut rng));
        let b = sample_triangle(two(&mut rng));
        assert!(d.length() <= 1.000001 && b.x >= 0.0 && b.y >= 0.0 && b.x + b.y <= 1.000001);
        for (sum, p) in [(&mut disc, d), (&mut triangle, b)] {
            sum[0] += (p.x * p.x) as f64;
            sum[1] += (p.y * p.y) as f64;
            sum[2] += (p.x * p.y) as f64;
        }
    }
    // second moments: disc 1/4, 1/4, 0; triangle 1/6, 1/6, 1/12
    let n = DRAWS as f64;
    for (sum, truth) in [(disc, [0.25, 0.25, 0.0]), (triangle, [1.0 / 6.0, 1.0 / 6.0, 1.0 / 12.0])]
    {
        for (s, t) in sum.iter().zip(truth) {
            assert!((s / n - t).abs() < 6.0 * 0.3 / n.sqrt(), "{} {t}", s / n);
        }
    }
}

/// Theory: draws of the visible-normal sampler follow `ggx_pdf` (directions below the surface are
/// rejected), and weight = eval cos / pdf for each.
#[test]
fn metal() {
    for alpha in [0.3f32, 0.6, 1.0] {
        for cos in [0.95f32, 0.6, 0.15] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt() * 0.8, (1.0 - cos * cos).sqrt() * 0.6, cos);
            let draw = |r: &mut Rng| {
                let u = rng_next(r);
                let drawn = sample_facets(Vec3::Z, wo, alpha, Vec2::new(u.x, u.y));
                let wi = drawn.wi;
                if wi.z <= 0.0 {
                    return None;
                }
                let facets = facets_at(Vec3::Z, wo, wi, alpha);
                let ratio = facets.brdf * (wi.z / ggx_pdf(wo, wi, alpha));
                assert!((drawn.weight - ratio).abs() < 1e-4, "{} {ratio}", drawn.weight);
                assert!((drawn.cos_d - facets.cos_d).abs() < 1e-4);
                Some(wi)
            };
            check(&format!("metal {alpha} at {cos}"), draw, |w| ggx_pdf(wo, w, alpha));
        }
    }
}

fn packed(light: &str) -> PackedScene {
    let head = "version = 1\n[camera]\nposition = [0, -2, 0]\ntarget = [0, 0, 0]\nup = [1, 0, 0]\n\
                fov = 40.0\n\
                [materials.m]\ntype = \"diffuse\"\nreflectance = 0.0\n";
    prepare(&parse(&format!("{head}{light}")), 8, 8).unwrap()
}

/// The scene-space point of a world point.
fn placed(packed: &PackedScene, world: DVec3) -> Vec3 {
    ((world - packed.center) / packed.unit).as_vec3()
}

/// Theory: directions to a light follow `pdf_area` over the sphere of directions; the surface that
/// a ray in direction w meets gives the density there. The same holds for the environment with
/// `pdf_environment`.
#[test]
fn lights() {
    let mesh = "v -1 1.2 0\nv 1 1 0.5\nv 0 1.5 -1\nv 0 0.6 0\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n";
    let mesh = file("physics-light.obj", mesh.as_bytes());
    let shapes = [
        "type = \"sphere\"\ncenter = [0.3, 1, 0.2]\nradius = 0.7".to_owned(),
        "type = \"rectangle\"\norigin = [-1, 0.7, -1]\nu = [2, 0.3, 0]\nv = [0, 0.2, 2]".into(),
        "type = \"disc\"\ncenter = [0.2, 0.8, 0]\nnormal = [0.2, -1, 0.1]\nradius = 1.1".into(),
        "type = \"box\"\nmin = [-0.8, 0.6, -0.6]\nmax = [0.6, 1.4, 0.8]".into(),
        format!("type = \"mesh\"\nfile = \"{mesh}\"\nsmooth = false"),
        "type = \"revolution\"\nsegments = [[[0, 0], [0.9, 0], [0.9, 0.5]], [[0.9, 0.5], [0.9, 1.2], [0, 1.2]]]\ntransform = { translate = [0, 0.5, 0], rotate = { axis = [1, 0, 1], degrees = 40 } }".into(),
    ];
    for shape in shapes {
        let packed = packed(&format!("[[shapes]]\n{shape}\nmaterial = \"m\"\nemission = 1.0\n"));
        let from = placed(&packed, DVec3::new(0.06, -0.3, 0.08));
        let scene = packed.tables;
        // turn the upward axis to z, the axis of bin()
        let turn = |w: Vec3| Vec3::new(w.z, w.x, w.y);
        let back = |w: Vec3| Vec3::new(w.y, w.z, w.x);
        // the density of a direction where the surface faces the point, and is not so grazing that
        // the pole of the density spoils the quadrature
        let pdf = |w: Vec3| {
            let ray = Ray { origin: from, t_min: 0.0, direction: back(w), t_max: 1e30 };
            let hit = intersect_scene(&scene, &ray);
            if hit.reference == NONE {
                return 0.0;
            }
            let s = surface_at(&scene, &ray, &hit);
            if s.normal.dot(ray.direction) > -0.1 {
                return 0.0;
            }
            pdf_area(
                &scene,
                shares_at(&scene, from),
                s.light,
                from,
                ray.direction,
                hit.t,
                s.normal,
                s.v,
            )
        };
        let draw = |r: &mut Rng| {
            let s = sample_light(&scene, shares_at(&scene, from), from, rng_next(r));
            // a point on the far side is not a direction to the light
            let ray = Ray { origin: from, t_min: 0.0, direction: s.direction, t_max: s.distance };
            let free = s.radiance.x > 0.0 && intersect_scene(&scene, &ray).reference == NONE;
            let w = turn(s.direction);
            (free && pdf(w) > 0.0).then_some(w)
        };
        check(shape.split('"').nth(1).unwrap(), draw, pdf);
        // the mean of 1 / pdf is the light's area
        let light = &scene.lights[0];
        let mut r = rng();
        let mean: f64 = (0..DRAWS)
            .map(|_| {
                let u = rng_next(&mut r);
                1.0 / sample_shape(&scene, light, Vec2::new(u.x, u.y), u.z).pdf as f64
            })
            .sum::<f64>()
            / DRAWS as f64;
        assert!((mean / light.area as f64 - 1.0).abs() < 4e-3, "area {mean} {}", light.area);
    }
}

#[test]
fn environment() {
    let texels: Vec<f32> =
        (0..32 * 16).map(|i| if i % 37 == 5 { 4.0 } else { 0.25 + (i % 7) as f32 * 0.1 }).collect();
    let at = |x: usize, y: usize| (texels[y * 32 + x], texels[y * 32 + x], texels[y * 32 + x]);
    exr::prelude::write_rgb_file(folder().join("physics-density.exr"), 32, 16, at).unwrap();
    for light in [
        "radiance = 1.0",
        "file = \"physics-density.exr\"\nrotate = 50.0",
        "file = \"physics-density.exr\"\nrotate = [[1, 0, 0], [0, -1, 0], [0, 0, -1]]",
    ] {
        let scene = packed(&format!("[environment]\n{light}\n")).tables;
        let light = &scene.lights[0];
        // the image's rows are bin()'s rings if y is its axis
        let turn = |w: Vec3| Vec3::new(w.z, w.x, w.y);
        let back = |w: Vec3| Vec3::new(w.y, w.z, w.x);
        let draw = |r: &mut Rng| {
            let w = sample_environment(&scene, light, rng_next(r));
            assert!(eval_environment(&scene, light, w).x > 0.0);
            Some(turn(w))
        };
        check("environment", draw, |w| pdf_environment(&scene, light, back(w)));
    }
}

/// Theory: directions to a sun are uniform in its disc, 1 - cos(60 degrees) = 4/8 wide.
#[test]
fn sun_disc() {
    let sun = "[[lights]]\ntype = \"sun\"\ndirection = [0, 0, -1]\nirradiance = 1\nangle = 120\n";
    let scene = packed(sun).tables;
    let light = &scene.lights[0];
    let pdf = |w: Vec3| if in_sun_disc(light, w) { pdf_sun_disc(light) } else { 0.0 };
    check("sun disc", |r| Some(sample_sun_disc(light, rng_next(r))), pdf);
}

/// Theory: a light is drawn with its stated probability, wherever the point lies; all probabilities
/// are above zero and sum to one. Ten lamps of equal power stand in a row over a floor: below a
/// lamp, that lamp, or it and its neighbour in the same cell, bring more light than all others
/// together.
#[test]
fn choice_of_lights() {
    let lamp = |i: i32| {
        format!(
            "[[shapes]]\ntype = \"sphere\"\ncenter = [{}, 0.5, 0]\nradius = 0.05\n\
             material = \"m\"\n\
             emission = 10.0\n",
            4 * i - 18
        )
    };
    let text = "version = 1\n[camera]\nposition = [0, 30, 30]\ntarget = [0, 0, 0]\nfov = 60.0\n\
                [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
                [[shapes]]\ntype = \"rectangle\"\norigin = [-20, 0, 3]\nu = [40, 0, 0]\n\
                v = [0, 0, -6]\n\
                material = \"m\"\n";
    let text = format!("{text}{}", (0..10).map(lamp).collect::<String>());
    let packed = prepare(&parse(&text), 64, 64).unwrap();
    let scene = &packed.tables;
    assert!(scene.cells.len() > 1);
    for index in 0..10u32 {
        let below = DVec3::new(f64::from(4 * index as i32 - 18), 0.0, 0.1);
        let shares = shares_at(scene, placed(&packed, below));
        let stated: Vec<f64> = (0..10).map(|i| f64::from(share_of(scene, shares, i))).collect();
        assert!((stated.iter().sum::<f64>() - 1.0).abs() < 1e-6 && stated.iter().all(|p| *p > 0.0));
        let near = index.saturating_sub(1) as usize..(index as usize + 2).min(10);
        assert!(stated[near].iter().sum::<f64>() > 0.6, "lamp {index}: {stated:?}");
        let mut counts = [0u32; 10];
        let mut r = rng();
        for _ in 0..DRAWS {
            counts[choose_light(scene, shares, rng_next(&mut r).x) as usize] += 1;
        }
        let sigma = excess(&counts, &stated, 0.0);
        assert!(sigma < 5.0, "{sigma}: {counts:?} {stated:?}");
        let mut planted = stated.clone();
        planted.swap(index as usize, (index as usize + 1) % 10);
        assert!(excess(&counts, &planted, 0.0) > 100.0);
    }
}

/// Theory: a lamp is also sampled from its own surface after a path has hit it; the sampled point
/// may coincide. The result is finite, and zero where there is no direction.
#[test]
fn a_lamp_from_its_own_surface() {
    let text = "[[shapes]]\ntype = \"sphere\"\ncenter = [0.5, 3.0, 0.5]\nradius = 0.5\n\
                material = \"m\"\nemission = 1.0\n";
    let packed = packed(text);
    let scene = &packed.tables;
    let mut rng = rng();
    let mut same = 0;
    for _ in 0..4000 {
        let place = rng_next(&mut rng);
        let p = sample_shape(scene, &scene.lights[0], Vec2::new(place.x, place.y), 0.5);
        let from = p.position + p.normal * p.error;
        for _ in 0..1000 {
            let light = sample_light(scene, shares_at(scene, from), from, rng_next(&mut rng));
            same += (light.distance == 0.0) as u32;
            assert!(light.direction.is_finite() && light.pdf >= 0.0, "{light:?} from {from}");
        }
    }
    assert!(same > 0, "no point was its own: the test sees nothing");
}

/// Theory: in a lobe of width alpha the density depends on the sine of the half vector's angle,
/// which f32 resolves to 1e-7 of 1, so to 1e-7 / alpha of itself. Compared with f64 for the same
/// directions.
#[test]
fn narrow_lobes_keep_their_digits() {
    use caustica::low_level::double::materials::microfacet as exact;
    let mut rng = rng();
    for alpha in [1e-3f32, 2.5e-3, 1e-2, 0.1] {
        let mut worst = 0.0f64;
        for _ in 0..20_000 {
            let u = rng_next(&mut rng);
            let wo = sample_cosine(Vec2::new(u.x, u.y));
            if wo.z < 0.05 {
                continue;
            }
            let h = ggx_visible_normal(wo, alpha, Vec2::new(u.z, u.w));
            let wi = mirrored(wo, h);
            if wi.z <= 0.05 {
                continue;
            }
            let (o, i) = (wo.as_dvec3(), wi.as_dvec3());
            let pairs = [
                (f64::from(ggx_pdf(wo, wi, alpha)), exact::ggx_pdf(o, i, f64::from(alpha))),
                (
                    f64::from(facets_at(Vec3::Z, wo, wi, alpha).brdf),
                    exact::facets_at(DVec3::Z, o, i, f64::from(alpha)).brdf,
                ),
            ];
            worst = pairs.iter().fold(worst, |worst, (a, b)| worst.max((a / b - 1.0).abs()));
        }
        println!("alpha {alpha}: relative error {worst:.1e}");
        let bound = 1e-6 / f64::from(alpha) + 1e-5;
        assert!(worst < bound, "alpha {alpha}: relative error {worst:.1e}, bound {bound:.1e}");
    }
}
