//! Pilot photons estimate the contribution of each light to the light that the camera sees, and the
//! start positions of the photons that reach it through mirrors and glass. From these follow the
//! probability that a photon starts at a light, and the lights' maps (`lights::guide`).

use super::geometry::intersect::intersect_scene;
use super::kernels::photon_trace::PhotonPath;
use super::kernels::records::Dispatch;
use super::lights::LightKind;
use super::lights::emission::emit_from;
use super::lights::guide::{GUIDE_CELLS, GUIDE_SIDE, GUIDED, guided};
use super::materials::Bsdf;
use super::math::rng::{STREAM_PHOTON, rng_new, rng_next};
use super::math::{basis, luminance};
use super::real::{Real, Vec2, Vec3};
use super::tables::*;
use super::visibility::Visibility;
use crate::prepare::distribution::cumulative;
use crate::telemetry::stage::stage;
use bytemuck::Zeroable;
use rayon::prelude::*;

/// Pilots of all lights together in each of two rounds, subject to the limits per light below.
const PILOTS: usize = 1 << 16;
/// Maximum number of pilots of a light in a round.
const MOST: usize = 1 << 14;
/// Minimum number of pilots of a light in a round.
const LEAST: usize = 32;
/// Maximum number of lights with a map.
const MAPS: usize = 64;
/// Probability reserved for selection by power, so that no light is left out.
const KEPT: f64 = 0.1;
/// Probability reserved for an even distribution over the cells of a lamp's map. Light from
/// infinity keeps its discs instead.
const EVEN: f64 = 0.5;
/// Weight of photons that arrive straight from the light, which shadow rays sample by default.
const STRAIGHT: f64 = 0.25;
/// Weight, in maps, of photons that arrive outside the camera's view.
const UNSEEN: f64 = 0.1;
/// Weight, in pilots, of the prior that a light contributes in proportion to its power.
const PRIOR: f64 = 4.0;
/// A pass number that no render reaches.
const PASS: u32 = u32::MAX;
/// Number of low bits of a record's key that hold bounce and class.
const KEY_BITS: u32 = 16;
/// Maximum number of scattering events of a pilot.
const BOUNCES: u32 = 32;

/// Results of a light's pilots.
#[derive(Clone, Debug, Default)]
struct Tally {
    count: f64,
    /// Sum of contributions to the light that the camera sees.
    sum: f64,
    /// Sum of squared contributions to the light that the camera sees.
    sum_sq: f64,
    /// Number of pilots, and sum of squared fractions of flux that passed mirrors or glass, for
    /// each cell of the map.
    cells: Vec<[f64; 2]>,
}

/// Sets the emission probabilities of the lights, and their maps. `power` is the power of each
/// light. Returns the fraction of the light seen by the camera that each light contributes; empty
/// if a single light brings all of it and no surface is specular.
pub fn learn_emission(out: &mut SceneTables, visibility: &Visibility, power: &[f64]) -> Vec<f64> {
    let specular = out.materials.iter().any(|m| Bsdf::of(m.kind).is_specular());
    for light in &mut out.lights {
        light.guide = 0;
    }
    out.world.guided = 0;
    choose_by(out, power);
    if out.lights.is_empty() || (out.lights.len() == 1 && !specular) {
        return Vec::new();
    }
    let _stage = stage("maps");
    let count = (PILOTS / out.lights.len()).clamp(LEAST, MOST);
    let mut tallies: Vec<Tally> = vec![Tally::default(); out.lights.len()];
    let mapped = if specular { candidates(out, visibility, count) } else { Vec::new() };
    for index in &mapped {
        let even: Vec<Real> = cumulative(&[1.0; GUIDE_CELLS as usize]).map(|x| x as Real).collect();
        out.lights[*index].guide = out.distributions.len() as u32;
        out.distributions.extend(even);
    }
    for round in 0..2 {
        for (index, tally) in tallies.iter_mut().enumerate() {
            let mut found = explore(out, visibility, index, round, count);
            // the second round's map resembles that of the passes to come, so its sums replace
            // those of the first
            (tally.count, tally.sum, tally.sum_sq) = (found.count, found.sum, found.sum_sq);
            if !mapped.contains(&index) {
                continue;
            }
            for (all, new) in tally.cells.iter().zip(&mut found.cells) {
                *new = [new[0] + all[0], new[1] + all[1]];
            }
            tally.cells = found.cells;
            let first = out.lights[index].guide as usize;
            let lamp = !LightKind::of(out.lights[index].kind).is_infinite();
            match map(&tally.cells, if lamp { EVEN } else { 0.0 }, lamp) {
                Some(map) => out.distributions[first..][..map.len()].copy_from_slice(&map),
                None => out.lights[index].guide = 0,
            }
        }
    }
    out.world.guided = out.lights.iter().any(|light| light.guide != 0) as u32;
    choose_by(out, &shares(&tallies, power));
    let all: f64 = tallies.iter().map(|tally| tally.sum / tally.count).sum();
    tallies
        .iter()
        .map(|tally| if all > 0.0 { tally.sum / tally.count / all } else { 0.0 })
        .collect()
}

/// Sets the emission probabilities of the lights in proportion to `shares`.
fn choose_by(out: &mut SceneTables, shares: &[f64]) {
    let mut before = 0.0;
    for (index, end) in cumulative(shares).enumerate() {
        out.distributions[index] = end as Real;
        out.lights[index].selection = (end - before) as Real;
        before = end;
    }
}

/// Lights that may get a map: all, or the [`MAPS`] lights whose first pilots brought most through
/// mirrors and glass.
fn candidates(scene: &SceneTables, visibility: &Visibility, count: usize) -> Vec<usize> {
    let mut lights: Vec<usize> = (0..scene.lights.len()).collect();
    if lights.len() > MAPS {
        let sums: Vec<f64> = lights
            .iter()
            .map(|index| {
                explore(scene, visibility, *index, 2, count).cells.iter().map(|c| c[1]).sum()
            })
            .collect();
        let strength =
            |index: usize| sums[index] * f64::from(scene.lights[index].selection).powi(2);
        lights.sort_by(|a, b| strength(*b).total_cmp(&strength(*a)));
        lights.truncate(MAPS);
        lights.sort_unstable();
    }
    lights
}

/// Probabilities of the lights: proportional to the root mean square of a photon's contribution,
/// which minimizes the variance, and mixed with the power.
fn shares(tallies: &[Tally], power: &[f64]) -> Vec<f64> {
    let total: f64 = power.iter().sum();
    let by_power: f64 =
        tallies.iter().zip(power).map(|(tally, power)| tally.count * power * power).sum();
    let prior = tallies.iter().map(|tally| tally.sum_sq).sum::<f64>() / by_power;
    let rms = tallies.iter().zip(power).map(|(tally, power)| {
        ((tally.sum_sq + PRIOR * prior * power * power) / (tally.count + PRIOR)).sqrt()
    });
    let rms: Vec<f64> = rms.collect();
    let sum: f64 = rms.iter().sum();
    let usable = sum > 0.0 && sum.is_finite();
    let learned = |rms: f64, power: f64| if usable { rms / sum } else { power / total };
    rms.iter()
        .zip(power)
        .map(|(rms, power)| (1.0 - KEPT) * learned(*rms, *power) + KEPT * power / total)
        .collect()
}

/// Result of one pilot.
struct Pilot {
    /// Contribution to the light that the camera sees.
    contribution: f64,
    /// Fraction of its flux that passed mirrors or glass, weighted by the visibility of its hits.
    share: f64,
    /// Start position in the coordinates of a map.
    across: Vec2,
}

/// Sends `count` pilots of one round from a light.
fn explore(
    scene: &SceneTables,
    visibility: &Visibility,
    index: usize,
    round: usize,
    count: usize,
) -> Tally {
    let first = round * count;
    let (even, whole) = (round == 0, scene.lights.len() > 1);
    let pilots: Vec<Pilot> = (first..first + count)
        .into_par_iter()
        .map(|id| pilot(scene, visibility, index, id as u32, even, whole))
        .collect();
    let mut tally = Tally { cells: vec![[0.0; 2]; GUIDE_CELLS as usize], ..Tally::default() };
    for pilot in pilots {
        tally.count += 1.0;
        tally.sum += pilot.contribution;
        tally.sum_sq += pilot.contribution * pilot.contribution;
        let (x, y) = (pilot.across.x * GUIDE_SIDE as Real, pilot.across.y * GUIDE_SIDE as Real);
        let side = GUIDE_SIDE as Real;
        if x >= 0.0 && y >= 0.0 && x < side && y < side {
            let cell = &mut tally.cells[(y as u32 * GUIDE_SIDE + x as u32) as usize];
            *cell = [cell[0] + 1.0, cell[1] + pilot.share * pilot.share];
        }
    }
    tally
}

/// Sends pilot `id` from a light. In the first round (`even`), guided pilots visit the cells of the
/// map in turn. The path continues beyond the first non-specular surface only if `whole`.
fn pilot(
    scene: &SceneTables,
    visibility: &Visibility,
    index: usize,
    id: u32,
    even: bool,
    whole: bool,
) -> Pilot {
    let light = &scene.lights[index];
    let infinite = LightKind::of(light.kind).is_infinite();
    let mut rng = rng_new(id, PASS, STREAM_PHOTON, index as u32);
    let (u, mut v) = (rng_next(&mut rng), rng_next(&mut rng));
    let in_cell = |i: u32| ((i % GUIDE_CELLS) as Real + 0.5) / GUIDE_CELLS as Real;
    if even && infinite && id & 1 == 0 {
        v.w = in_cell(id / 2) * GUIDED;
    } else if even && !infinite {
        v.w = in_cell(id);
    }
    let emission = emit_from(scene, light, u, v);
    let sent = f64::from(luminance(emission.flux)).max(f64::MIN_POSITIVE);
    let across = if infinite {
        on_square(scene, emission.ray.origin, emission.ray.direction)
    } else {
        guided(scene, light, Vec2::new(v.x, v.y), v.w).0
    };
    let dispatch = Dispatch {
        max_bounces: BOUNCES,
        classes: 2,
        key_bits: KEY_BITS,
        bounce_shift: 1,
        ..Dispatch::zeroed()
    };
    let mut path = PhotonPath::emitted(emission, rng, 0);
    let (mut contribution, mut share, mut scattered) = (0.0, 0.0, false);
    while path.goes_on(&dispatch) {
        let hit = intersect_scene(scene, &path.ray);
        let goes_on = path.meet(scene, &dispatch, false, &hit, &mut |record| {
            scattered = true;
            let flux = f64::from(luminance(record.flux));
            let straight = record.key >> 1 == 0;
            let seen = visibility.density(record.position);
            contribution += flux * seen * if straight { STRAIGHT } else { 1.0 };
            if !straight && record.key & 1 == 0 {
                let worth = if visibility.is_seen(record.position) { 1.0 } else { UNSEEN };
                share += flux / sent * worth;
            }
        });
        if !goes_on || (scattered && !whole) {
            break;
        }
    }
    // as if all photons started at this light
    Pilot { contribution: contribution * f64::from(light.selection), share, across }
}

/// Map coordinates of a point on an emission disc, for light from infinity.
fn on_square(scene: &SceneTables, origin: Vec3, direction: Vec3) -> Vec2 {
    let (t, b) = basis(direction);
    let d = origin - scene.world.near_center;
    (Vec2::new(d.dot(t), d.dot(b)) * (1.0 / scene.world.near_radius) + Vec2::ONE) * 0.5
}

/// Cumulative probabilities of a map; `None` if no pilot passed mirrors or glass. The probability
/// of a cell is proportional to the root mean square of the fractions, which minimizes the
/// variance, and smoothed over its neighbours, because pilots are few. `even` is the total
/// probability of the even distribution. The map of a lamp wraps in y.
fn map(cells: &[[f64; 2]], even: f64, wraps: bool) -> Option<Vec<Real>> {
    let side = GUIDE_SIDE as i32;
    let mean_sq = |x: i32, y: i32| {
        let y = if wraps { y.rem_euclid(side) } else { y.clamp(0, side - 1) };
        let [count, sum_sq] = cells[(y * side + x.clamp(0, side - 1)) as usize];
        sum_sq / count.max(1.0)
    };
    let value = |cell: i32| {
        let (x, y) = (cell % side, cell / side);
        let around = (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j)));
        let around: f64 = around.map(|(i, j)| mean_sq(x + i, y + j)).sum();
        (0.5 * mean_sq(x, y) + 0.5 * around / 9.0).sqrt()
    };
    let values: Vec<f64> = (0..side * side).map(value).collect();
    let total: f64 = values.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let mixed =
        values.iter().map(|value| even / f64::from(GUIDE_CELLS) + (1.0 - even) * value / total);
    Some(cumulative(&mixed.collect::<Vec<_>>()).map(|x| x as Real).collect())
}
