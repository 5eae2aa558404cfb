//! Merging of pass ranges. Sums are computed in f64.
//!
//! Means are weighted by the number of accepted passes of a pixel. The spread is merged by the
//! parallel form of Welford's method (Chan, Golub & LeVeque 1979):
//! `n S = n_a S_a + n_b S_b + delta^2 n_a n_b / n`, where `delta` is the difference of the means.
//! So mean, spread, `bias_probe`, `bias_probe_alternating` and `halves` are those of a single
//! render except for rounding.
//!
//! `mean_at_pow2` and `mean_at_half_pow2` differ: the means over the first passes that a single
//! render would have stored are in neither file. Any two cuts into earlier and later passes serve
//! the error estimate equally well. Five cuts are known: the boundary between the ranges, and the
//! two cuts of each range. The merge selects those nearest to the middle and to a quarter of the
//! passes from either end.

use std::path::PathBuf;

use rayon::prelude::*;

use super::compat::layer_names;
use super::{Checkpoint, CheckpointError, Origin, Totals, layers};
use crate::double::kernels::records::FilmPixel;
use crate::double::math::luminance;
use crate::double::plan::film_readback::{Readout, counted, early_parts};
use crate::double::{self, real::Vec3};
use crate::engine::{Space, State};
use crate::kernels;
use crate::scene::settings::{Method, RadiusRule};

/// Merges checkpoints of consecutive pass ranges, given in any order together with their files.
///
/// # Errors
/// If the list is empty, the checkpoints belong to different renders, or passes are missing or
/// duplicated.
pub fn merge(checkpoints: Vec<(PathBuf, Checkpoint)>) -> Result<Checkpoint, CheckpointError> {
    let mut sorted = checkpoints;
    sorted.sort_by_key(|(_, checkpoint)| checkpoint.state.first_pass);
    let mut rest = sorted.into_iter();
    let Some((mut file, mut all)) = rest.next() else {
        let what = "nothing to merge".to_owned();
        return Err(CheckpointError::Unfit {
            file: PathBuf::new(),
            what,
            mend: "give at least one checkpoint".to_owned(),
        });
    };
    for (next_file, next) in rest {
        check_follows((&file, &all), (&next_file, &next))?;
        all = join(&all, &next);
        file = next_file;
    }
    Ok(all)
}

fn check_follows(
    (first_file, first): (&PathBuf, &Checkpoint),
    (file, next): (&PathBuf, &Checkpoint),
) -> Result<(), CheckpointError> {
    let mut differences = first.origin.differences(&next.origin);
    let [expected, found] = [first.origin.aovs, next.origin.aovs];
    if expected != found {
        differences.push(format!(
            "layers: expected {}, found {}",
            layer_names(expected),
            layer_names(found)
        ));
    }
    if !differences.is_empty() {
        let mend = format!("\"expected\" is {}: render one of them again", first_file.display());
        return Err(CheckpointError::Other { file: file.clone(), differences, mend });
    }
    let unfit = |what: String, mend: &str| {
        Err(CheckpointError::Unfit { file: file.clone(), what, mend: mend.to_owned() })
    };
    let settings = &first.origin.settings;
    if settings.radius_rule == RadiusRule::Local && settings.method != Method::Path {
        return unfit(
            "the local radius rule cannot be merged, since each pass needs the photon counts of \
             all earlier passes"
                .into(),
            "use the global rule, or continue one checkpoint with --resume",
        );
    }
    let (end, begin) = (first.end(), next.state.first_pass);
    let held = format!(
        "{} ends before pass {end}, this one contains passes {begin}..{}",
        first_file.display(),
        next.end()
    );
    if begin < end {
        let both = begin..end.min(next.end());
        return unfit(
            format!("passes {}..{} are in both: {held}", both.start, both.end),
            "merge consecutive ranges, such as 0..500 and 500..1000",
        );
    }
    if begin > end {
        return unfit(
            format!("passes {end}..{begin} are missing: {held}"),
            &format!("render them too: --passes {end}..{begin}"),
        );
    }
    Ok(())
}

/// Merges two consecutive ranges.
fn join(first: &Checkpoint, next: &Checkpoint) -> Checkpoint {
    let halves = [first, next].map(|checkpoint| {
        let film = wide_film(&checkpoint.state);
        let passes = checkpoint.state.passes;
        let known = &checkpoint.cuts;
        let cuts = |i: usize, pixel: &FilmPixel| {
            known.get(i).copied().unwrap_or_else(|| early_parts(counted(pixel, passes)))
        };
        let part =
            |(i, film): (usize, &FilmPixel)| Part { passes, cuts: cuts(i, film), film: *film };
        film.par_iter().enumerate().map(part).collect::<Vec<Part>>()
    });
    let joined: Vec<Part> =
        halves[0].par_iter().zip(&halves[1]).map(|(a, b)| Part::joined(a, b)).collect();
    let film: Vec<FilmPixel> = joined.iter().map(|part| part.film).collect();
    let (a, b) = (&first.totals, &next.totals);
    let mut ends = a.ends;
    ends.add(&b.ends);
    let mut origin = first.origin.clone();
    origin.settings.passes = next.end();
    if !origin.device.split(" + ").any(|device| device == next.origin.device) {
        origin.device = format!("{} + {}", origin.device, next.origin.device);
    }
    Checkpoint {
        origin,
        totals: Totals {
            photons: a.photons.saturating_add(b.photons),
            eye_paths: a.eye_paths.saturating_add(b.eye_paths),
            rays: a.rays.saturating_add(b.rays),
            ends,
            radius: b.radius,
            elapsed: a.elapsed.saturating_add(b.elapsed),
        },
        state: State {
            first_pass: first.state.first_pass,
            passes: first.state.passes + next.state.passes,
            bits: 64,
            film: double::kernels::bytes::film_bytes(&film),
            statistics: Vec::new(),
            layers: layers::joined(&first.state, &next.state),
        },
        cuts: joined.iter().map(|part| part.cuts).collect(),
    }
}

/// Film data of one pixel for a range of passes.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    film: FilmPixel,
    /// Number of passes, including rejected ones.
    passes: u32,
    /// Number of passes that `mean_at_pow2` and `mean_at_half_pow2` average.
    cuts: [u32; 2],
}

impl Part {
    /// Merges `a` and the subsequent range `b`.
    fn joined(a: &Self, b: &Self) -> Self {
        let (na, nb) = (counted(&a.film, a.passes), counted(&b.film, b.passes));
        let (wa, wb, n) = (f64::from(na), f64::from(nb), f64::from(na) + f64::from(nb));
        let mixed = |x: f64, y: f64| if na + nb == 0 { 0.0 } else { (wa * x + wb * y) / n };
        let [mean_a, mean_b] = [a, b].map(|part| part.film.mean + part.film.carry);
        let delta = luminance(mean_b - mean_a);
        let between = if na + nb == 0 { 0.0 } else { delta * delta * (wa / n) * (wb / n) };
        // `bias_probe_alternating` flips the sign of odd passes, counted from the start of a range
        let sign = if a.passes.is_multiple_of(2) { 1.0 } else { -1.0 };
        let cuts = joined_cuts((a, na, luminance(mean_a)), (b, nb, luminance(mean_b)));
        let film = FilmPixel {
            mean: Vec3::from_array([0, 1, 2].map(|c| mixed(mean_a[c], mean_b[c]))),
            carry: Vec3::ZERO,
            spread: mixed(a.film.spread, b.film.spread) + between,
            bias_probe: mixed(a.film.bias_probe, b.film.bias_probe),
            bias_probe_alternating: mixed(
                a.film.bias_probe_alternating,
                sign * b.film.bias_probe_alternating,
            ),
            halves: mixed(a.film.halves, b.film.halves),
            rejected: [0, 1, 2, 3].map(|k| a.film.rejected[k].saturating_add(b.film.rejected[k])),
            mean_at_pow2: cuts[0].1,
            mean_at_half_pow2: cuts[1].1,
        };
        Self { film, passes: a.passes + b.passes, cuts: cuts.map(|(passes, _)| passes) }
    }
}

/// Selects the cut nearest to the middle, and another one nearest to a quarter from either end,
/// each with the mean of the passes before it. A cut of 0 means none, if there are too few passes.
/// Each argument is a part with its number of accepted passes and its mean.
fn joined_cuts(
    (a, na, mean_a): (&Part, u32, f64),
    (b, nb, mean_b): (&Part, u32, f64),
) -> [(u32, f64); 2] {
    let n = na + nb;
    let after_a = |cut: u32, mean: f64| {
        let all = f64::from(na) + f64::from(cut);
        (na + cut, (f64::from(na) * mean_a + f64::from(cut) * mean) / all.max(1.0))
    };
    // the cut of a range of one pass lies at its end, so it is not inside `a`
    let before_a = |cut: u32, mean: f64| if cut < na { (cut, mean) } else { (0, 0.0) };
    let known = [
        before_a(a.cuts[0], a.film.mean_at_pow2),
        before_a(a.cuts[1], a.film.mean_at_half_pow2),
        after_a(0, mean_b),
        after_a(b.cuts[0].min(nb), b.film.mean_at_pow2),
        after_a(b.cuts[1].min(nb), b.film.mean_at_half_pow2),
    ];
    let inside = known.into_iter().filter(|(cut, _)| (1..n).contains(cut));
    let shorter = |cut: u32| u64::from(cut.min(n - cut));
    let nearest = |part: u64, but: u32| {
        let others = inside.clone().filter(|(cut, _)| *cut != but);
        others
            .min_by_key(|(cut, _)| (part * shorter(*cut)).abs_diff(u64::from(n)))
            .unwrap_or((0, 0.0))
    };
    let middle = nearest(2, 0);
    [middle, nearest(4, middle.0)]
}

/// Film readout for an origin.
pub(super) fn readout(origin: &Origin) -> Readout {
    let Space { radiance_unit, glint, .. } = origin.space;
    Readout { width: origin.window_size()[0], unit: radiance_unit, glint }
}

/// Film in f64, converted from the saved precision.
pub(super) fn wide_film(state: &State) -> Vec<FilmPixel> {
    if state.bits == 64 {
        return double::kernels::bytes::film_of(&state.film);
    }
    let wide = |p: &kernels::records::FilmPixel| FilmPixel {
        mean: p.mean.as_dvec3(),
        spread: p.spread.into(),
        carry: p.carry.as_dvec3(),
        mean_at_pow2: p.mean_at_pow2.into(),
        rejected: p.rejected,
        bias_probe: p.bias_probe.into(),
        bias_probe_alternating: p.bias_probe_alternating.into(),
        halves: p.halves.into(),
        mean_at_half_pow2: p.mean_at_half_pow2.into(),
    };
    kernels::bytes::film_of(&state.film).iter().map(wide).collect()
}

/// Theory: the f64 kernel `fold` accumulates all passes into one pixel, or two ranges into two
/// pixels. Merged, the two equal the single one except for rounding, and the cuts are means over
/// the first passes.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::double::kernels::records::{ACCEPTED, Dispatch, REJECTED_PHOTONS};
    use crate::double::kernels::resolve::{Estimate, fold};
    use bytemuck::Zeroable;

    /// Result of pass `number`; one in eleven is rejected.
    fn found(number: u32) -> (u32, Estimate) {
        let x = |k: u32| {
            f64::from((number * 2_654_435_761u32.wrapping_mul(k + 1)) >> 8) / f64::from(1 << 24)
        };
        let found = Estimate {
            radiance: Vec3::new(x(1), 2.0 * x(2), 0.5 + x(3)),
            bias_probe: x(4) - 0.3,
            halves: x(5) - 0.5,
        };
        (if number % 11 == 5 { REJECTED_PHOTONS } else { ACCEPTED }, found)
    }

    fn range(first: u32, end: u32) -> Part {
        let mut film = FilmPixel::zeroed();
        for number in first..end {
            let dispatch = Dispatch { passes_done: number - first, ..Dispatch::zeroed() };
            let (cause, found) = found(number);
            fold(&dispatch, cause, found, &mut film);
        }
        let passes = end - first;
        Part { film, passes, cuts: early_parts(counted(&film, passes)) }
    }

    /// Luminance of the mean over the first `count` accepted passes.
    fn mean_of_first(count: u32) -> f64 {
        let counting = (0..).map(found).filter(|(cause, _)| *cause == ACCEPTED);
        counting.take(count as usize).map(|(_, found)| luminance(found.radiance)).sum::<f64>()
            / f64::from(count)
    }

    /// Largest difference of the values that must agree; counts must be equal.
    fn distance(a: &Part, b: &Part) -> f64 {
        assert_eq!((a.passes, a.film.rejected), (b.passes, b.film.rejected));
        let numbers = |p: &FilmPixel| {
            let mean = p.mean + p.carry;
            [mean.x, mean.y, mean.z, p.spread, p.bias_probe, p.bias_probe_alternating, p.halves]
        };
        let pairs = numbers(&a.film).into_iter().zip(numbers(&b.film));
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn two_ranges_are_one() {
        let mut worst = 0f64;
        for (cut, end) in
            [(1, 2), (1, 40), (39, 40), (5, 6), (6, 12), (500, 1000), (333, 1000), (512, 1024)]
        {
            let joined = Part::joined(&range(0, cut), &range(cut, end));
            worst = worst.max(distance(&joined, &range(0, end)));
            for (passes, mean) in joined
                .cuts
                .into_iter()
                .zip([joined.film.mean_at_pow2, joined.film.mean_at_half_pow2])
            {
                let n = counted(&joined.film, end);
                assert!(passes < n && (passes > 0 || n < 4), "{passes} of {n}");
                assert!(passes == 0 || (mean - mean_of_first(passes)).abs() < 1e-12, "{cut} {end}");
            }
        }
        assert!(worst < 1e-12, "{worst:e}");
        let three = Part::joined(&Part::joined(&range(0, 100), &range(100, 101)), &range(101, 350));
        assert!(distance(&three, &range(0, 350)) < 1e-12);
        // the comparison detects a wrong order, a missing pass and a sign that was not flipped
        let (a, b) = (range(0, 101), range(101, 200));
        let whole = range(0, 200);
        assert!(distance(&Part::joined(&b, &Part { passes: 101, ..a }), &whole) > 1e-6);
        let shorter = Part { passes: 99, ..range(101, 199) };
        assert!(distance(&Part::joined(&a, &shorter), &whole) > 1e-6);
        let mut unturned = b;
        unturned.film.bias_probe_alternating = -b.film.bias_probe_alternating;
        assert!(distance(&Part::joined(&a, &unturned), &whole) > 1e-6);
    }

    #[test]
    fn cuts_are_near_the_middle() {
        let part =
            |passes: u32| Part { film: FilmPixel::zeroed(), passes, cuts: early_parts(passes) };
        let cuts = |a: u32, b: u32| Part::joined(&part(a), &part(b)).cuts;
        // equal to those of a single render if the files contain them
        assert_eq!(cuts(512, 512), early_parts(1024));
        assert_eq!(cuts(500, 500), [500, 256]);
        assert_eq!(cuts(10, 990), [522, 266]);
        assert_eq!(cuts(990, 10), [512, 256]);
        assert_eq!(cuts(1, 3), [2, 1]);
        assert_eq!(cuts(1, 1), [1, 0]);
        // a single pass at the start is not selected as the quarter
        assert_eq!(cuts(1, 39), [17, 33]);
    }
}
