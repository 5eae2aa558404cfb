//! Merged ranges of passes.
//!
//! Theory: a running mean over n passes in f32 with a carry is rounded in each pass by at most
//! `2^-24 |x - mean| / n` in the change, and by `2^-24 |mean|` whenever the carry is added. That
//! happens while a pass changes the mean by more than 1/256, and less and less often later. The
//! bound is 32 roundings of the largest channel of a pixel, as docs/checkpoints.md states.

use caustica::low_level::checkpoint::{Checkpoint, CheckpointError, merge};
use caustica::low_level::device::Wanted;
use caustica::low_level::engine::State;
use caustica::low_level::scene::settings::{Method, RadiusRule, RenderSettings};

use super::{checkpoint, open};
use crate::support::passes;

const SIZE: (u32, u32) = (24, 16);
const ROUNDING: f64 = 1.0 / 16_777_216.0;
const BOUND: f64 = 32.0 * ROUNDING;

fn range(
    first: u32,
    end: u32,
    wanted: &Wanted,
    change: impl Fn(&mut RenderSettings),
) -> Checkpoint {
    let mut opened = open(wanted, SIZE, change);
    opened.engine.restore(&State::before(first)).unwrap();
    passes(opened.engine.as_mut(), end - first);
    let state = opened.engine.save().unwrap();
    let mut made = checkpoint(&opened, SIZE, state);
    made.totals.photons = u64::from(end - first) * 10;
    made
}

fn merged(parts: &[Checkpoint]) -> Result<Checkpoint, CheckpointError> {
    let named =
        parts.iter().enumerate().map(|(i, part)| (format!("{i}.checkpoint").into(), part.clone()));
    merge(named.collect())
}

/// Largest difference of the images relative to the pixel's luminance, and of the variances
/// relative to its square.
fn distance(a: &Checkpoint, b: &Checkpoint) -> [f64; 2] {
    let ((pa, ea, ra), (pb, eb, rb)) = (a.develop(), b.develop());
    assert_eq!(ra, rb);
    let mut worst = [0f64; 2];
    for (((x, y), ex), ey) in pa.rgb.iter().zip(&pb.rgb).zip(&ea.pixels).zip(&eb.pixels) {
        let largest = f64::from(y.iter().copied().fold(1e-30, f32::max));
        let apart = x.iter().zip(y).map(|(x, y)| f64::from((x - y).abs())).fold(0.0, f64::max);
        worst[0] = worst[0].max(apart / largest);
        // the spread is a mean of squared deviations
        worst[1] = worst[1].max((ex.variance - ey.variance).abs() / (largest * largest));
    }
    worst
}

#[test]
fn ranges_give_the_picture_of_all() {
    type Change = fn(&mut RenderSettings);
    let changes: [(&str, Change); 4] = [
        ("sppm", |_| ()),
        ("fixed", |s| s.radius_rule = RadiusRule::Fixed),
        ("ppm", |s| s.method = Method::Ppm),
        ("path", |s| s.method = Method::Path),
    ];
    for (name, change) in changes {
        let whole = range(0, 40, &Wanted::Cpu, change);
        for cuts in [&[0, 20, 40][..], &[0, 1, 40], &[0, 7, 8, 33, 40]] {
            let mut parts: Vec<_> =
                cuts.windows(2).map(|cut| range(cut[0], cut[1], &Wanted::Cpu, change)).collect();
            parts.reverse();
            let all = merged(&parts).unwrap();
            assert_eq!((all.state.first_pass, all.state.passes, all.totals.photons), (0, 40, 400));
            assert_eq!(all.origin.settings.passes, 40);
            let [picture, variance] = distance(&all, &whole);
            println!(
                "{name} {cuts:?}: {:.1} roundings, variance {:.1}",
                picture / ROUNDING,
                variance / ROUNDING
            );
            assert!(
                picture <= BOUND && variance <= BOUND,
                "{name} {cuts:?}: {picture:e} {variance:e}"
            );
            // the alternating sign starts with the first pass of the whole, not of each range
            let bias = |c: &Checkpoint| {
                c.develop().1.pixels.iter().map(|p| p.bias_probe_alternating).collect::<Vec<_>>()
            };
            let (a, b) = (bias(&all), bias(&whole));
            let scale = whole.develop().0.rgb.iter().flatten().fold(0f32, |m, x| m.max(*x));
            let far =
                a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / f64::from(scale);
            assert!(far <= BOUND, "{name} {cuts:?}: {far:e}");
            // the error estimate uses other subsets of the same passes
            let stated = |c: &Checkpoint| c.develop().1.relative().stated;
            let ratio = stated(&all) / stated(&whole);
            println!("  stated {ratio:.2} of that of all");
            assert!((0.5..2.0).contains(&ratio), "{name} {cuts:?}: stated {ratio}");
        }
        // the comparison detects one pass of forty that replaces another
        let again = range(0, 20, &Wanted::Cpu, change);
        let mut other = range(19, 39, &Wanted::Cpu, change);
        other.state.first_pass = 20;
        assert!(distance(&merged(&[again, other]).unwrap(), &whole)[0] > 10.0 * BOUND, "{name}");
    }
}

/// Two ranges of the length that two machines might share.
#[test]
fn two_times_five_hundred_passes() {
    let few = |s: &mut RenderSettings| s.photons = 300;
    let halves = [range(0, 500, &Wanted::Cpu, few), range(500, 1000, &Wanted::Cpu, few)];
    let [picture, variance] =
        distance(&merged(&halves).unwrap(), &range(0, 1000, &Wanted::Cpu, few));
    println!("0..1000: {:.1} roundings, variance {:.1}", picture / ROUNDING, variance / ROUNDING);
    assert!(picture <= BOUND && variance <= BOUND, "{picture:e} {variance:e}");
    assert!(picture > 0.0, "sums in another order are rounded otherwise");
}

#[test]
fn devices_may_differ() {
    let whole = range(0, 12, &Wanted::Cpu, |_| ());
    let parts = [range(0, 5, &Wanted::Software, |_| ()), range(5, 12, &Wanted::Cpu, |_| ())];
    let all = merged(&parts).unwrap();
    assert!(distance(&all, &whole)[0] <= BOUND);
    assert!(all.origin.device.ends_with(" + cpu"), "{}", all.origin.device);
    // merging step by step equals merging all ranges at once
    let last = range(12, 16, &Wanted::Cpu, |_| ());
    let steps = merged(&[all, last.clone()]).unwrap();
    let [first, second] = parts;
    let once = merged(&[last, second, first]).unwrap();
    assert!(steps == once);
}

#[test]
fn what_does_not_go_together_is_refused() {
    let part = |first, end| range(first, end, &Wanted::Cpu, |_| ());
    let (a, b) = (part(0, 3), part(3, 5));
    let fails = |parts: &[Checkpoint], words: &[&str]| {
        let error = merged(parts).unwrap_err();
        let reported = format!("{error}\n{}", miette::Diagnostic::help(&error).unwrap());
        for word in words {
            assert!(reported.contains(word), "{word}: {reported}");
        }
    };
    assert!(merged(&[a.clone(), b.clone()]).is_ok());
    fails(&[], &["nothing"]);
    fails(&[a.clone(), a.clone()], &["1.checkpoint", "passes 0..3 are in both"]);
    fails(
        &[a.clone(), part(2, 5)],
        &["passes 2..3 are in both", "0.checkpoint ends before pass 3"],
    );
    fails(&[a.clone(), part(1, 2)], &["passes 1..2 are in both"]);
    fails(&[part(4, 6), a.clone()], &["0.checkpoint", "passes 3..4 are missing", "--passes 3..4"]);
    let seed = range(3, 5, &Wanted::Cpu, |s| s.seed = 1);
    fails(&[a.clone(), seed], &["`seed`: expected 0, found 1"]);
    let mut scene = b.clone();
    scene.origin.identity.textures = "0".into();
    fails(&[a.clone(), scene], &["scene (textures)", "image"]);
    let mut version = b.clone();
    version.origin.version = "0.0.1".into();
    fails(&[a.clone(), version], &["caustica version", "found 0.0.1"]);
    let mut size = b;
    size.origin.width = 12;
    size.origin.height = 32;
    fails(&[a, size], &["size: expected 24 x 16, found 12 x 32"]);
    let local = |first: u32| {
        let mut made = range(0, 2, &Wanted::Cpu, |s| s.radius_rule = RadiusRule::Local);
        made.state.first_pass = first;
        made
    };
    assert!(merged(&[local(0)]).is_ok(), "one alone is what it is");
    fails(&[local(0), local(2)], &["local radius rule", "--resume"]);
}
