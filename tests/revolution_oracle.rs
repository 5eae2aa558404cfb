//! The f32 intersection of surfaces of revolution against an independent f64 solver.

mod revolution;

use caustica::build::revolution::Placement;
use caustica::math::FAR;
use caustica::shapes::revolution::{BRACKETED, PatchHit, intersect_patch, patch_miss};
use glam::Vec3;
use rayon::prelude::*;
use revolution::oracle;
use revolution::profiles::{Placed, place, profiles, skew};
use revolution::rays::{CLASSES, Class, Random, ray};

const RAYS: u64 = 40_000;

fn meets(min: Vec3, max: Vec3, o: Vec3, d: Vec3) -> bool {
    let (mut near, mut far) = (0.0_f32, FAR);
    for k in 0..3 {
        if d[k] == 0.0 {
            if o[k] < min[k] || o[k] > max[k] {
                return false;
            }
            continue;
        }
        let (a, b) = ((min[k] - o[k]) / d[k], (max[k] - o[k]) / d[k]);
        near = near.max(a.min(b));
        far = far.min(a.max(b) * (1.0 + 4e-7));
    }
    near <= far
}

/// Nearest hit over the patches whose boxes the ray meets.
fn trace(placed: &Placed, o: Vec3, d: Vec3, t_min: f32) -> (PatchHit, u32) {
    let mut best = (patch_miss(), 0);
    let mut last = u32::MAX;
    for b in &placed.boxes {
        if b.patch != last && meets(b.min, b.max, o, d) {
            last = b.patch;
            let t = &placed.tables;
            let hit = intersect_patch(
                &t.profile_points,
                &t.revolutions[0],
                &t.patches[b.patch as usize],
                o,
                d,
                t_min,
                best.0.t,
            );
            if hit.t < best.0.t {
                best = (hit, b.patch);
            }
        }
    }
    best
}

#[derive(Clone, Default)]
struct Tally {
    rays: u64,
    hits: u64,
    lost: u64,
    false_hits: u64,
    off: u64,
    worst: f64,
    bracketed: u64,
    steps: [u64; 16],
}

impl Tally {
    fn add(mut self, o: Tally) -> Tally {
        self.rays += o.rays;
        self.hits += o.hits;
        self.lost += o.lost;
        self.false_hits += o.false_hits;
        self.off += o.off;
        self.worst = self.worst.max(o.worst);
        self.bracketed += o.bracketed;
        self.steps.iter_mut().zip(o.steps).for_each(|(a, b)| *a += b);
        self
    }
}

fn compare(placed: &Placed, o: Vec3, d: Vec3) -> Tally {
    let mut tally = Tally { rays: 1, ..Tally::default() };
    let revolution = &placed.tables.revolutions[0];
    let (hit, _) = trace(placed, o, d, 0.0);
    let (lo, ld) = oracle::local_ray(revolution, o, d);
    let truth = oracle::all_hits(&placed.segments, lo, ld);
    let found = hit.t < FAR;
    if found {
        tally.steps[(hit.steps & 15) as usize] += 1;
        tally.bracketed += u64::from(hit.steps & BRACKETED != 0);
    }
    match (found, truth.first()) {
        (true, Some(first)) => {
            tally.hits = 1;
            let size = f64::from(revolution.scale).max(first.t);
            let error = |t: f64| (f64::from(hit.t) - t).abs() / size;
            let e = error(first.t);
            if e > 1e-3 {
                let other = f64::from(hit.t) > first.t;
                tally.lost += u64::from(other);
                tally.false_hits += u64::from(!other);
            } else {
                tally.off += u64::from(e > 1e-5);
                tally.worst = e;
            }
        }
        (true, None) => tally.false_hits = 1,
        (false, Some(_)) => tally.lost = 1,
        (false, None) => {}
    }
    if std::env::var("SHOW").is_ok() && (tally.lost + tally.false_hits) > 0 {
        println!("{} {o:?} {d:?} {hit:?} {truth:?}", placed.name);
    }
    tally
}

#[test]
fn agrees_with_the_oracle() {
    let mut total = Tally::default();
    for placement in [Placement::default(), skew()] {
        for profile in profiles() {
            let placed = place(&profile, &placement);
            println!(
                "{}: {} patches, {} boxes",
                placed.name,
                placed.tables.patches.len(),
                placed.boxes.len()
            );
            for class in CLASSES {
                let start = std::time::Instant::now();
                let tally = (0..64u64)
                    .into_par_iter()
                    .map(|chunk| {
                        let mut random = Random(chunk * 977 + class as u64 * 131_071 + 1);
                        (0..RAYS / 64).fold(Tally::default(), |sum, _| {
                            let (o, d) = ray(&placed, class, &mut random);
                            sum.add(compare(&placed, o, d))
                        })
                    })
                    .reduce(Tally::default, Tally::add);
                println!(
                    "  {class:?}: {} rays {} hits, lost {} false {} off {} worst {:.1e} bracketed {} steps {:?} {:.2?}",
                    tally.rays,
                    tally.hits,
                    tally.lost,
                    tally.false_hits,
                    tally.off,
                    tally.worst,
                    tally.bracketed,
                    &tally.steps[..12],
                    start.elapsed()
                );
                total = total.add(tally);
            }
        }
    }
    println!(
        "total {} lost {} false {} off {} worst {:.1e} bracketed {} {:?}",
        total.rays, total.lost, total.false_hits, total.off, total.worst, total.bracketed, total.steps
    );
    let _ = Class::Random;
}
