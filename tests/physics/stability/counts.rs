//! Radii, counters and means far from one.

use bytemuck::Zeroable;
use caustica::low_level::kernels::records::{
    Dispatch, FilmPixel, Gathered, PhotonRecord, Statistics, VisiblePoint,
};
use caustica::low_level::math::oct_encode;
use caustica::low_level::plan::global_scale_sq;
use caustica::low_level::scene::settings::{Direct, Radius, RadiusRule, RenderSettings};
use caustica::low_level::tables::NONE;
use glam::{DVec3, Vec3};

use super::bench::Bench;
use super::table::{Figure, Row};

pub fn rows() -> Vec<Row> {
    vec![
        Row {
            name: "gather radius from the whole scene to 1e-6 of it",
            how: "Photons around points of a tilted plane, half of them from behind, in a grid of 64 buckets where many \
                  cells collide. The sum that is gathered against the count in f64 of those within the radius before \
                  anything was rounded to f32.",
            unit: "relative error of the sum",
            bound: 1e-2,
            measure: radii,
        },
        Row {
            name: "global rule, 1 to 1e6 passes",
            how: "r_i^2 / r_1^2 as the kernels get it against the product of (k + alpha) / (k + 1) in f64, for alpha from \
                  1e-3 to 1. (Half an f32 rounding is 6e-8. The recurrence in f32 would be off by 8e-3.)",
            unit: "relative error of r^2",
            bound: 6.1e-8,
            measure: |_| global_rule(),
        },
        Row {
            name: "local rule, photon counts about 0, 2^24, 2^32, 2^40",
            how: "Hachisuka's recurrence with 3 and 1000 new photons a pass, the counters started below these edges and \
                  carried past them; R^2 in f64 against scale_sq - drop.",
            unit: "relative error of R^2",
            bound: 1e-6,
            measure: |b| local_rule(b).0,
        },
        Row {
            name: "local rule: the counts themselves",
            how: "The same runs: photons counted in two words against exact integers.",
            unit: "photons",
            bound: 0.0,
            measure: |b| local_rule(b).1,
        },
        Row {
            name: "means after 1e3, 1e6 and 2^24 passes",
            how: "A pixel whose mean so far is 1 gets further passes of values between 1 and 2, the counter started at that \
                  number; the mean against f64. (Its first part moves some hundred times, half a rounding each.) (Alone in f32 the mean stops following near 2^24.)",
            unit: "relative error of the mean",
            bound: 1e-6,
            measure: means,
        },
        Row {
            name: "1, 2, 255, 65,537 and 16.7 million photons a pass",
            how: "A point source over a disc that one gather disc covers: the radiance is that of the share p of photons \
                  that meet the disc, known in closed form, with binomial noise. 16.7 million in the table only.",
            unit: "standard deviations",
            bound: 4.0,
            measure: photon_counts,
        },
        Row {
            name: "a million equal photons in one disc",
            how: "The sum of equal fluxes in one visible point against their number. (A naive f32 sum of 2^20 terms of 0.7 is \
                  off by 2e-3, and stops growing at 2^24.)",
            unit: "relative error of the sum",
            bound: 1e-4,
            measure: many_equal,
        },
    ]
}

/// SplitMix64, uniform in [0, 1).
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Relative error of gathered sums against sums in f64, at one radius.
fn gathered_error(b: &Bench, radius: f64) -> f64 {
    let mut u = Uniform(1);
    let normal = DVec3::new(0.48, 0.6, 0.64);
    let (e1, e2) = normal.any_orthonormal_pair();
    let disc = |r: f64, u: &mut Uniform| {
        let (s, c) = (std::f64::consts::TAU * u.next()).sin_cos();
        let r = r * u.next().sqrt();
        e1 * (r * c) + e2 * (r * s)
    };
    let centers: Vec<DVec3> = (0..64).map(|_| disc(0.9, &mut u)).collect();
    let mut photons = Vec::new();
    for center in &centers {
        for i in 0..b.samples(200, 2000) {
            photons.push((*center + disc(2.0 * radius, &mut u), i % 2 == 0));
        }
    }
    let near = |p: &DVec3, c: &DVec3| p.distance_squared(*c) <= radius * radius;
    let exact: usize = centers
        .iter()
        .map(|c| photons.iter().filter(|(p, front)| *front && near(p, c)).count())
        .sum();
    let inv_cell = (0.5 / radius) as f32;
    let dispatch = Dispatch { inv_cell, mask: 63, scale_sq: 1.0, ..Dispatch::zeroed() };
    let n = normal.as_vec3();
    let record = |(key, (p, front)): (u32, &(DVec3, bool))| PhotonRecord {
        position: p.as_vec3(),
        key,
        flux: Vec3::ONE,
        direction: oct_encode(if *front { n } else { -n }),
    };
    let records: Vec<_> = (0..).zip(&photons).map(record).collect();
    let points: Vec<VisiblePoint> = centers
        .iter()
        .map(|c| VisiblePoint {
            position: c.as_vec3(),
            radius: radius as f32,
            weight: Vec3::ONE,
            outline: NONE,
            normal: oct_encode(n),
            shading: oct_encode(n),
            ..VisiblePoint::zeroed()
        })
        .collect();
    let gathered = b.gather(&dispatch, &points, &records);
    let sum: f64 = gathered.iter().map(|g| f64::from(g.flux.x)).sum();
    sum / exact as f64 - 1.0
}

fn radii(b: &Bench) -> Figure {
    let held =
        if b.long { &[1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6][..] } else { &[1.0, 1e-3, 1e-6] };
    let worst = held.iter().map(|&r| gathered_error(b, r).abs()).fold(0.0, f64::max);
    let below = 100.0 * gathered_error(b, 1e-7);
    let note = format!("Below, f32 positions are coarse: {below:+.1} % at 1e-7; `check` warns.");
    Figure { value: worst, note }
}

fn global_rule() -> Figure {
    let mut worst = 0.0f64;
    for alpha in [1e-3, 0.5, 2.0 / 3.0, 0.999, 1.0] {
        // the sum of logarithms with a carried rounding error (Kahan)
        let (mut sum, mut carry) = (0.0f64, 0.0);
        for i in 1..=1_000_000u64 {
            if [1, 2, 10, 255, 256, 257, 1000, 10_000, 100_000, 1_000_000].contains(&i) {
                let given = f64::from(global_scale_sq(i, alpha) as f32);
                worst = worst.max((given / sum.exp() - 1.0).abs());
            }
            let term = (-(1.0 - alpha) / (i as f64 + 1.0)).ln_1p() - carry;
            let next = sum + term;
            carry = (next - sum) - term;
            sum = next;
        }
    }
    worst.into()
}

fn local_rule(b: &Bench) -> (Figure, Figure) {
    let alpha = 0.7f32;
    let (mut worst, mut lost) = (0.0f64, 0u64);
    for (start, m) in
        [(0u64, 3), ((1 << 24) - 2000, 3), ((1 << 32) - 100_000, 1000), ((1 << 40) - 100_000, 1000)]
    {
        let passes = b.samples(2000, 50_000);
        let statistics = Statistics {
            scale_sq: if start == 0 { 0.0 } else { 0.3 },
            drop: 0.0,
            count_low: start as u32,
            count_high: (start >> 32) as u32,
        };
        let gathered = Gathered { flux: Vec3::ONE, count: m, ..Gathered::zeroed() };
        let point = VisiblePoint { radius: 1.0, ..VisiblePoint::zeroed() };
        let list: Vec<Dispatch> = (0..passes)
            .map(|i| Dispatch {
                eye_samples: 1,
                alpha,
                photons: 1e6,
                passes_done: i,
                ..Dispatch::zeroed()
            })
            .collect();
        let (found, _) = b.resolve(point, gathered, statistics, FilmPixel::zeroed(), &list);
        let (mut t, mut scale) = (start as f64, if start == 0 { 1.0 } else { f64::from(0.3f32) });
        let (a, m) = (f64::from(alpha), f64::from(m));
        for _ in 0..passes {
            scale *= a * (t + m) / (a * t + m);
            t += m;
        }
        let value = f64::from(found.scale_sq) - f64::from(found.drop);
        worst = worst.max((value / scale - 1.0).abs());
        let count = u64::from(found.count_low) | u64::from(found.count_high) << 32;
        lost += count.abs_diff(start + u64::from(passes) * m as u64);
    }
    (worst.into(), (lost as f64).into())
}

fn means(b: &Bench) -> Figure {
    let mut worst = 0.0f64;
    for start in [1000u32, 1_000_000, (1 << 24) - 500] {
        let count = b.samples(2000, 50_000);
        let film = FilmPixel { mean: Vec3::ONE, ..FilmPixel::zeroed() };
        // values 1 / (pi photons), produced by the number of photons
        let point = VisiblePoint { radius: 1.0, ..VisiblePoint::zeroed() };
        let gathered =
            Gathered { flux: Vec3::splat(std::f32::consts::PI), count: 1, ..Gathered::zeroed() };
        let value = |i: u32| 2.0 - f64::from(i % 7) / 7.0;
        let list: Vec<Dispatch> = (0..count)
            .map(|i| Dispatch {
                eye_samples: 1,
                alpha: 1.0,
                photons: (1.0 / value(i)) as f32,
                passes_done: start + i,
                ..Dispatch::zeroed()
            })
            .collect();
        let (_, film) = b.resolve(point, gathered, Statistics::zeroed(), film, &list);
        let exact =
            (0..count).fold(1.0f64, |mean, i| mean + (value(i) - mean) / f64::from(start + i + 1));
        let mean = f64::from(film.mean.x) + f64::from(film.carry.x);
        worst = worst.max((mean / exact - 1.0).abs());
    }
    worst.into()
}

/// A point source at height 1 over a disc of radius 1, covered by a gather disc of radius 2.
fn photon_counts(b: &Bench) -> Figure {
    const TEXT: &str = "version = 1\n[camera]\nposition = [0, 0.4, 0.1]\ntarget = [0, 0, 0]\n\
                        fov = 10\n[film]\nwidth = 1\nheight = 1\n\
        [materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n\
        [[shapes]]\ntype = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 1\n\
        material = \"m\"\n\
        [[lights]]\ntype = \"point\"\nposition = [0, 1, 0]\nintensity = 1.0\n";
    let p = 0.5 * (1.0 - 0.5f64.sqrt());
    // rho / pi times the arriving flux over the area of the shape, which clips the gather disc
    let truth =
        0.5 / std::f64::consts::PI * (4.0 * std::f64::consts::PI * p) / std::f64::consts::PI;
    let mut counts =
        vec![(1, b.samples(200, 4000)), (2, b.samples(100, 2000)), (255, 8), (65_537, 1)];
    if b.long {
        counts.push((16_700_000, 1));
    }
    let mut worst = 0.0f64;
    let mut all = Vec::new();
    for (photons, passes) in counts {
        let settings = RenderSettings {
            photons,
            passes,
            direct: Direct::Photons,
            radius: Radius::Units(2.0),
            radius_rule: RadiusRule::Fixed,
            max_bounces: 1,
            ..RenderSettings::default()
        };
        let mean = f64::from(b.render(TEXT, &settings).rgb[0][0]);
        let sigma = truth * ((1.0 - p) / (p * f64::from(photons) * f64::from(passes))).sqrt();
        worst = worst.max((mean - truth).abs() / sigma);
        all.push(format!("{:+.1e}", mean / truth - 1.0));
    }
    Figure {
        value: worst,
        note: format!("Relative errors, fewest photons first: {}.", all.join(", ")),
    }
}

fn many_equal(b: &Bench) -> Figure {
    let count = 1 << 20;
    let dispatch = Dispatch { inv_cell: 0.25, mask: 0, scale_sq: 1.0, ..Dispatch::zeroed() };
    let up = oct_encode(Vec3::Z);
    // the middle of the cell that contains the disc
    let position = Vec3::splat(2.0);
    let point = VisiblePoint {
        position,
        radius: 1.0,
        outline: NONE,
        weight: Vec3::ONE,
        normal: up,
        shading: up,
        ..VisiblePoint::zeroed()
    };
    let record = |key| PhotonRecord { position, key, flux: Vec3::splat(0.7), direction: up };
    let records: Vec<_> = (0..count).map(record).collect();
    let gathered = b.gather(&dispatch, &[point], &records);
    let truth = f64::from(0.7f32) * f64::from(count);
    (f64::from(gathered[0].flux.x) / truth - 1.0).abs().into()
}
