//! Emission discs: the distribution of distances from the visible region at which light from
//! infinity enters.

use super::eye_pilots::{EyePilots, Region, Seen};
use super::lights::LightKind;
use super::real::Real;
use super::tables::*;
use crate::prepare::distribution::cumulative;

/// Maximum number of discs. Radii are multiplied by powers of two that fit into a word.
const LEVELS: u32 = 32;
/// Ratio of the near radius to the radius of the narrowest disc.
const NARROWEST: f64 = 8.0;
/// Probability reserved for the distribution by width, so that no disc is left out.
const KEPT: f64 = 0.1;
/// Maximum width of a pixel's gather disc, relative to the median.
const FOOTPRINTS: f64 = 4.0;
/// Number of iterations of the optimization.
const ROUNDS: u32 = 40;

/// Sets the near sphere and, if light comes from infinity, the discs and their probabilities. `far`
/// is the largest distance of a surface from the center of `region`, in scene units.
pub fn learn_discs(out: &mut SceneTables, eyes: &EyePilots, region: Region, far: f64) {
    let near = f64::from(region.radius);
    out.world.near_center = region.center;
    out.world.near_radius = region.radius;
    out.world.far = 0;
    out.world.disc_levels = 0;
    if !out.lights.iter().any(|light| LightKind::of(light.kind).is_infinite()) {
        return;
    }
    out.world.far = (far > 2.0 * near) as u32;
    let widest = far.max(near);
    let narrowest = (near / NARROWEST).max(widest / f64::from(1u32 << (LEVELS - 2)));
    // rounding alone must not add a disc twice as wide
    let levels = ((widest / narrowest).log2() - 1e-9).ceil().max(0.0) as usize + 1;
    out.world.disc_radius = narrowest as Real;
    out.world.disc_levels = levels as u32;
    out.world.disc_first = out.distributions.len() as u32;
    let radii: Vec<f64> = (0..levels).map(|k| narrowest * (k as f64).exp2()).collect();
    let learned = probabilities(&points(eyes, region), &radii);
    let kept = by_width(&radii, near);
    let mixed = learned.iter().zip(&kept).map(|(a, b)| (1.0 - KEPT) * a + KEPT * b);
    out.distributions.extend(cumulative(&mixed.collect::<Vec<_>>()).map(|x| x as Real));
}

/// Squared distance from the center, and weight of each point: one over the area that gathers
/// there.
fn points(eyes: &EyePilots, region: Region) -> Vec<[f64; 2]> {
    let median = f64::from(eyes.footprint());
    let at = |point: &Seen| {
        let d = point.position - region.center;
        let width = f64::from(point.footprint).min(FOOTPRINTS * median);
        [f64::from(d.dot(d)), 1.0 / (width * width)]
    };
    eyes.points().map(at).filter(|point| point[1].is_finite()).collect()
}

/// Density per area at squared distance `r_sq`.
fn density(radii: &[f64], p: &[f64], r_sq: f64) -> f64 {
    let inside = radii.iter().zip(p).filter(|(radius, _)| r_sq <= *radius * *radius);
    inside.map(|(radius, p)| p / (radius * radius)).sum()
}

/// Probabilities that minimize the sum of `weight / density`, the variance of the gathered photons.
/// The problem is convex; at its solution the derivatives by all nonzero probabilities are equal.
fn probabilities(points: &[[f64; 2]], radii: &[f64]) -> Vec<f64> {
    let mut p = vec![1.0 / radii.len() as f64; radii.len()];
    for _ in 0..ROUNDS {
        let mut slope = vec![0.0; radii.len()];
        for [r_sq, weight] in points {
            let density = density(radii, &p, *r_sq);
            if density > 0.0 {
                let by = weight / (density * density);
                for (slope, radius) in slope.iter_mut().zip(radii) {
                    *slope += if *r_sq <= radius * radius { by / (radius * radius) } else { 0.0 };
                }
            }
        }
        for (p, slope) in p.iter_mut().zip(&slope) {
            *p *= slope.sqrt();
        }
        let total: f64 = p.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return by_width(radii, 0.0);
        }
        p.iter_mut().for_each(|p| *p /= total);
    }
    p
}

/// Distribution by width: half of the photons pass through the narrowest disc that contains the
/// near sphere, half of the others through the next one, and so on.
fn by_width(radii: &[f64], near: f64) -> Vec<f64> {
    let first = radii.iter().position(|radius| *radius >= near).unwrap_or(radii.len() - 1);
    let last = radii.len() - 1;
    let share = |k: usize| match k {
        k if k < first => 0.0,
        k if k == last => (-((k - first) as f64)).exp2(),
        k => (-((k - first + 1) as f64)).exp2(),
    };
    (0..radii.len()).map(share).collect()
}

/// Theory: the discs' probabilities minimize the variance. Points on one circle need only the
/// narrowest disc that contains it; points distributed evenly over a disc need evenly distributed
/// photons.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_variance() {
        let radii = [1.0, 2.0, 4.0, 8.0];
        let circle = probabilities(&[[2.25, 1.0]], &radii);
        assert!(circle[1] > 0.99, "{circle:?}");
        let even: Vec<[f64; 2]> =
            (0..1000).map(|i| [16.0 * (f64::from(i) + 0.5) / 1000.0, 1.0]).collect();
        let even = probabilities(&even, &radii);
        assert!(even[2] > 0.98, "{even:?}");
        // no other choice is better
        let points: Vec<[f64; 2]> = (0..500).map(|i| [f64::from(i * i) / 4000.0, 1.0]).collect();
        let best = probabilities(&points, &radii);
        let cost = |p: &[f64]| points.iter().map(|[r, w]| w / density(&radii, p, *r)).sum::<f64>();
        for k in 0..4 {
            let other: Vec<f64> =
                (0..4).map(|j| 0.95 * best[j] + if j == k { 0.05 } else { 0.0 }).collect();
            assert!(
                cost(&best) < 1.001 * cost(&other),
                "{k}: {} and {}",
                cost(&best),
                cost(&other)
            );
        }
    }
}
