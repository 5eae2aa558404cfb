//! The f32 intersection of surfaces of revolution against an independent f64 solver.

use crate::revolution::judge::{Tally, judge};
use crate::revolution::profiles::{Placed, place, profiles, skew};
use crate::revolution::rays::{CLASSES, Random, ray};
use caustica::low_level::accel::revolution::Placement;
use caustica::low_level::math::FAR;
use caustica::low_level::shapes::revolution::{BRACKETED, PatchHit, intersect_patch, patch_miss};
use glam::Vec3;
use rayon::prelude::*;

/// Rays of each class at each placed profile; 100 such sets make 1.6 million.
const RAYS: u64 = 16_000;

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

fn compare(placed: &Placed, o: Vec3, d: Vec3) -> Tally {
    let (hit, _) = trace(placed, o, d, 0.0);
    let found = (hit.t < FAR).then_some(f64::from(hit.t));
    let mut tally = judge(placed, o, d, found);
    if found.is_some() {
        tally.steps[(hit.steps & 15) as usize] += 1;
        tally.bracketed += u64::from(hit.steps & BRACKETED != 0);
    }
    if std::env::var("SHOW").is_ok() && tally.wrong() > 0 {
        println!("{} {o:?} {d:?} {hit:?}", placed.name);
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
                println!("  {class:?}: {} {:.1?}", tally.report(), start.elapsed());
                total = total.add(tally);
            }
        }
    }
    println!("total: {}", total.report());
    assert!(total.rays >= 1_000_000);
    let wrong = total.wrong();
    assert!(wrong * 100_000 < total.rays, "{wrong} of {} rays differ", total.rays);
    // One class in five consists of grazing rays.
    assert!(total.ill_conditioned * 10_000 < total.rays);
    let newton: u64 = total.steps.iter().sum();
    assert!(newton > 0 && total.bracketed > 0, "both solvers are used");
}

// Theory: the comparison above is useful only if it detects a lost patch, a profile that is off by
// 1e-4, and a surface that does not exist.
#[test]
fn the_comparison_notices_planted_errors() {
    let profile = &profiles()[3];
    let run = |placed: &Placed| {
        let mut random = Random(11);
        (0..4000).fold(Tally::default(), |sum, _| {
            let (o, d) = ray(placed, CLASSES[0], &mut random);
            sum.add(compare(placed, o, d))
        })
    };
    let sound = run(&place(profile, &skew()));
    assert_eq!(sound.wrong(), 0);
    let mut holed = place(profile, &skew());
    holed.boxes.retain(|b| b.patch != 5);
    assert!(run(&holed).lost > 10);
    let mut bent = place(profile, &skew());
    bent.tables.profile_points.iter_mut().for_each(|p| p.y += 1e-4);
    assert!(run(&bent).off > 100);
    let mut grown = place(profile, &skew());
    grown.segments[0].truncate(3);
    assert!(run(&grown).false_hits > 100);
}
