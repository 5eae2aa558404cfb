//! Selection of lights for shadow rays by position: a tree whose leaves contain about equal numbers
//! of pilot points, and for each leaf the probabilities of the lights by their contribution there.

use super::eye_pilots::{EyePilots, Seen};
use super::geometry::intersect::occluded;
use super::lights::light::sample_one_light;
use super::lights::select::{CELL_DEPTH, CELL_LEAF};
use super::math::luminance;
use super::math::rng::pcg4d;
use super::real::{Real, Vec3, Vec4};
use super::shapes::ray::Ray;
use super::tables::*;
use crate::prepare::distribution::cumulative;
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Minimum number of points per leaf.
const LEAST_POINTS: usize = 32;
/// Maximum number of probabilities in all leaves together.
const ENTRIES: usize = 1 << 19;
/// Number of light samples in all leaves together.
const SAMPLES: usize = 1 << 18;
/// Maximum number of points per leaf at which each light is sampled.
const POINTS: usize = 16;
/// Weight of a light's mean unoccluded contribution, which keeps a light whose samples were all
/// occluded.
const OCCLUDED: f64 = 0.1;
/// Probability reserved for selection by power, so that no light is left out.
const KEPT: f64 = 0.1;
/// Maximum factor by which a probability changes when its interval is rounded to multiples of a
/// power of 1/2.
const MOVED: f64 = 1.5;
/// Exponent of the smallest such power.
const FINEST: u32 = 8;
/// A stream of random numbers that no kernel uses.
const STREAM: u32 = 0x2000_0001;

/// Builds the light selection tree of `out` if it has several lights. `power` is the power of each
/// light.
pub fn learn_cells(out: &mut SceneTables, eyes: &EyePilots, power: &[f64]) {
    out.cells.clear();
    if out.lights.len() < 2 {
        return;
    }
    let mut points: Vec<Seen> = eyes.points().copied().collect();
    let most = (ENTRIES / out.lights.len()).max(1);
    let depth = CELL_DEPTH.min(most.ilog2());
    let mut leaves: Vec<(usize, Vec<Seen>)> = Vec::new();
    let mut cells = vec![Cell::zeroed()];
    divide(&mut cells, 0, &mut points, depth, &mut leaves);
    let each = (SAMPLES / (leaves.len() * out.lights.len())).clamp(1, POINTS);
    let scene = &*out;
    let tables: Vec<Vec<Real>> =
        leaves.par_iter().map(|(_, points)| probabilities(scene, points, each, power)).collect();
    for ((cell, _), table) in leaves.iter().zip(tables) {
        cells[*cell].first = out.distributions.len() as u32;
        out.distributions.extend(table);
    }
    out.cells = cells;
}

/// Builds the tree below cell `index`, at most `depth` levels deep, by splitting the points at the
/// median of their widest extent.
fn divide(
    cells: &mut Vec<Cell>,
    index: usize,
    points: &mut [Seen],
    depth: u32,
    leaves: &mut Vec<(usize, Vec<Seen>)>,
) {
    let low = points.iter().fold(Vec3::MAX, |low, seen| low.min(seen.position));
    let high = points.iter().fold(Vec3::MIN, |high, seen| high.max(seen.position));
    let extent = high - low;
    let axis = (0..3).fold(0, |best, k| if extent[k] > extent[best] { k } else { best });
    let middle = points.len() / 2;
    let split = (depth > 0 && points.len() >= 2 * LEAST_POINTS).then(|| {
        let by = |a: &Seen, b: &Seen| a.position[axis].total_cmp(&b.position[axis]);
        points.select_nth_unstable_by(middle, by).1.position[axis]
    });
    match split {
        Some(split) if split > low[axis] => {
            let first = cells.len();
            cells[index] = Cell { split, axis: axis as u32, first: first as u32, pad: 0 };
            cells.extend([Cell::zeroed(); 2]);
            let below = move_to_front(points, |seen| seen.position[axis] < split);
            let (below, above) = points.split_at_mut(below);
            divide(cells, first, below, depth - 1, leaves);
            divide(cells, first + 1, above, depth - 1, leaves);
        }
        _ => {
            cells[index] = Cell { split: 0.0, axis: CELL_LEAF, first: 0, pad: 0 };
            leaves.push((index, points.to_vec()));
        }
    }
}

/// Moves the points for which `first` is true to the front, and returns their number.
fn move_to_front(points: &mut [Seen], first: impl Fn(&Seen) -> bool) -> usize {
    let mut count = 0;
    for i in 0..points.len() {
        if first(&points[i]) {
            points.swap(i, count);
            count += 1;
        }
    }
    count
}

/// Cumulative probabilities of the lights at `points`: proportional to the root mean square of a
/// sample's contribution, which minimizes the variance, and mixed with the power.
fn probabilities(scene: &SceneTables, points: &[Seen], each: usize, power: &[f64]) -> Vec<Real> {
    let total: f64 = power.iter().sum();
    let step = (points.len() / each).max(1);
    let chosen: Vec<&Seen> = points.iter().step_by(step).take(each).collect();
    let values: Vec<f64> =
        (0..scene.lights.len()).map(|index| contribution(scene, &chosen, index)).collect();
    let sum: f64 = values.iter().sum();
    let kept = if sum > 0.0 { KEPT } else { 1.0 };
    let learned = |value: f64| if sum > 0.0 { value / sum } else { 0.0 };
    let mixed = values
        .iter()
        .zip(power)
        .map(|(value, power)| (1.0 - kept) * learned(*value) + kept * power / total);
    dyadic(&cumulative(&mixed.collect::<Vec<_>>()).collect::<Vec<_>>())
}

/// Rounds cumulative probabilities to multiples of large powers of 1/2, as long as no probability
/// changes by more than a factor of [`MOVED`]. Sobol points are evenly distributed over such
/// intervals; over other intervals they are no better than random ones.
fn dyadic(ends: &[f64]) -> Vec<Real> {
    let (mut before, mut moved_before) = (0.0, 0.0);
    let moved = ends.iter().enumerate().map(|(index, end)| {
        let share = end - before;
        let next = ends.get(index + 1).copied().unwrap_or(*end) - end;
        let near = |a: f64, b: f64| a <= MOVED * b && b <= MOVED * a;
        let fits = |moved: &f64| {
            let left = ends.get(index + 1).copied().unwrap_or(*end) - moved;
            near(moved - moved_before, share) && near(left, next) && *moved < 1.0
        };
        let candidates =
            (1..=FINEST).map(|bits| (end * f64::from(1 << bits)).round() / f64::from(1 << bits));
        let moved = candidates.into_iter().find(fits).unwrap_or(*end);
        (before, moved_before) = (*end, moved);
        moved as Real
    });
    moved.collect()
}

/// Root mean square of the irradiance from samples of a light at `points`, plus [`OCCLUDED`] times
/// the mean unoccluded irradiance.
fn contribution(scene: &SceneTables, points: &[&Seen], index: usize) -> f64 {
    let (mut seen_sq, mut all) = (0.0, 0.0);
    for (k, point) in points.iter().enumerate() {
        let number = |word: u32| (word >> 8) as Real * (1.0 / 16777216.0);
        let u = pcg4d([k as u32, index as u32, STREAM, 0]).map(number);
        let origin = point.position + point.normal * (point.footprint * 1e-3);
        let u = Vec4::new(u[0], u[1], u[2], u[3]);
        let light = sample_one_light(scene, &scene.lights[index], 1.0, origin, u);
        let cos = light.direction.dot(point.normal);
        let brought = f64::from(luminance(light.radiance) * cos / light.pdf);
        if cos <= 0.0 || brought.is_nan() || brought <= 0.0 {
            continue;
        }
        all += brought;
        let ray = Ray { origin, t_min: 0.0, direction: light.direction, t_max: light.distance };
        if !occluded(scene, &ray) {
            seen_sq += brought * brought;
        }
    }
    let count = points.len().max(1) as f64;
    (seen_sq / count).sqrt() + OCCLUDED * all / count
}
