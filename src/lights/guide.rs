//! Where a light's photons meet glass and mirrors: a map of their two main numbers, learned before the render (the
//! idea of projection maps, Jensen 1996; learned as in Peter & Pietrek 1998, though before the render, so that passes stay
//! independent). Half of the light's photons are sent by the map, the rest go everywhere, and each carries flux over its
//! density: nothing is missed and nothing counted twice. Twin: `shaders/lights/guide.wgsl`; only the host learns.

use super::emission::emit_from;
use super::light::find_interval;
use super::materials::scatter::{IMPORTANCE, is_specular, scatter_specular};
use super::math::rng::{STREAM_PHOTON, pcg4d, rng_new, rng_next};
use super::math::{FAR, max_component, offset_origin};
use super::real::{Real, Vec2, Vec4};
use super::shape::pdf_bin;
use super::shapes::intersect::intersect_scene;
use super::shapes::ray::Ray;
use super::shapes::surface::surface_at;
use super::tables::*;
use rayon::prelude::*;

/// Cells along each side of a map.
pub const GUIDE_SIDE: u32 = 32;
/// Cells of a map.
pub const GUIDE_CELLS: u32 = GUIDE_SIDE * GUIDE_SIDE;
/// Share of a light's photons that its map sends.
const GUIDED: f64 = 0.5;
/// Lights that get a map, the strongest.
const LIGHTS: usize = 16;
/// Photons that learn, of all lights together, in each of two rounds: even, then as the first round's map sends them.
const PILOTS: u32 = 1 << 15;
/// A pass number that no render reaches.
const PASS: u32 = u32::MAX;
/// Mirrors and glass on a pilot's way, at the most.
const BOUNCES: u32 = 16;

/// Numbers in place of `across`, by the map of `light` if it has one, and one over their density. `u` chooses the cell.
#[inline(always)]
pub fn guided(scene: &Scene, light: &Light, across: Vec2, u: Real) -> (Vec2, Real) {
    if light.guide == 0 {
        return (across, 1.0);
    }
    let cell = find_interval(scene, light.guide, GUIDE_CELLS, u);
    let x = ((cell % GUIDE_SIDE) as Real + across.x) * (1.0 / GUIDE_SIDE as Real);
    let y = ((cell / GUIDE_SIDE) as Real + across.y) * (1.0 / GUIDE_SIDE as Real);
    (Vec2::new(x, y), 1.0 / pdf_bin(scene, light.guide, cell, GUIDE_CELLS))
}

/// Gives the strongest lights their maps.
pub fn learn_guides(scene: &mut Scene) {
    if !scene.materials.iter().any(|m| is_specular(m.kind)) {
        return;
    }
    let mut strongest: Vec<usize> = (0..scene.lights.len()).collect();
    strongest.sort_by(|a, b| scene.lights[*b].selection.total_cmp(&scene.lights[*a].selection));
    strongest.truncate(LIGHTS);
    let pilots = PILOTS / strongest.len().max(1) as u32;
    for index in strongest {
        let mut tallies = vec![Tally::default(); GUIDE_CELLS as usize];
        for round in 0..2 {
            explore(scene, index, round * pilots, pilots, &mut tallies);
            let Some(map) = cumulative(&tallies) else { break };
            let first = scene.lights[index].guide;
            if first == 0 {
                scene.lights[index].guide = scene.distributions.len() as u32;
                scene.world.guided = 1;
                scene.distributions.extend(map);
            } else {
                scene.distributions[first as usize..][..map.len()].copy_from_slice(&map);
            }
        }
    }
}

/// The cumulative shares of each light's map, for an engine of other precision that is to send its photons alike.
pub fn guides(scene: &Scene) -> Vec<Option<Vec<f64>>> {
    let map =
        |first: usize| scene.distributions[first..first + GUIDE_CELLS as usize].iter().map(|x| *x as f64);
    scene.lights.iter().map(|light| (light.guide != 0).then(|| map(light.guide as usize).collect())).collect()
}

/// Puts maps in the place of those that the scene has.
pub fn take_guides(scene: &mut Scene, maps: &[Option<Vec<f64>>]) {
    for (light, map) in scene.lights.iter_mut().zip(maps) {
        light.guide = map.as_ref().map_or(0, |_| scene.distributions.len() as u32);
        scene.distributions.extend(map.iter().flatten().map(|x| *x as Real));
    }
    scene.world.guided = scene.lights.iter().any(|light| light.guide != 0) as u32;
}

/// Pilots in a cell.
#[derive(Clone, Copy, Default)]
struct Tally {
    count: u32,
    /// Sum of the squared shares of flux that came through glass or by mirrors to a surface that scatters.
    sum_sq: f64,
}

/// Sends `count` pilots from number `first` on from a light.
fn explore(scene: &Scene, index: usize, first: u32, count: u32, tallies: &mut [Tally]) {
    let found: Vec<(u32, f64)> = (first..first + count)
        .into_par_iter()
        .map(|id| {
            let light = &scene.lights[index];
            let mut rng = rng_new(id, PASS, STREAM_PHOTON, index as u32);
            let (u, v) = (rng_next(&mut rng), rng_next(&mut rng));
            // without a map yet: cell after cell, which leaves none out
            let (x, y) = (id % GUIDE_SIDE, id / GUIDE_SIDE % GUIDE_SIDE);
            let even = Vec2::new(x as Real + v.x, y as Real + v.y) * (1.0 / GUIDE_SIDE as Real);
            let across =
                if light.guide == 0 { even } else { guided(scene, light, Vec2::new(v.x, v.y), v.w).0 };
            let row = ((across.y * GUIDE_SIDE as Real) as u32).min(GUIDE_SIDE - 1);
            let column = ((across.x * GUIDE_SIDE as Real) as u32).min(GUIDE_SIDE - 1);
            let share = specular_share(scene, light, u, v, across, id);
            (row * GUIDE_SIDE + column, share as f64)
        })
        .collect();
    for (cell, share) in found {
        let tally = &mut tallies[cell as usize];
        tally.count += 1;
        tally.sum_sq += share * share;
    }
}

/// The share of its flux that a photon brings through glass or by mirrors to a surface that scatters.
fn specular_share(scene: &Scene, light: &Light, u: Vec4, v: Vec4, across: Vec2, id: u32) -> Real {
    let emission = emit_from(scene, light, u, v, across);
    let mut ray = emission.ray;
    let mut medium = emission.medium;
    let mut share = 1.0;
    for bounce in 0..BOUNCES {
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            return 0.0;
        }
        let s = surface_at(scene, &ray, &hit);
        if !is_specular(scene.materials[s.material as usize].kind) {
            return if bounce > 0 { share } else { 0.0 };
        }
        let u = (pcg4d([id, bounce, PASS, 0])[0] >> 8) as Real * (1.0 / 16777216.0);
        let scattered = scatter_specular(scene, &s, -ray.direction, medium, u, IMPORTANCE);
        share *= max_component(scattered.weight);
        if share <= 0.0 {
            return 0.0;
        }
        medium = scattered.medium;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
    }
    0.0
}

/// The map's cumulative shares; none where no pilot came through. A cell is chosen in proportion to the root mean square
/// of the shares, which leaves the least variance, and a little by its neighbours, since pilots are few.
fn cumulative(tallies: &[Tally]) -> Option<Vec<Real>> {
    let side = GUIDE_SIDE as i32;
    let mean_sq = |x: i32, y: i32| {
        let tally = tallies[(y.rem_euclid(side) * side + x.clamp(0, side - 1)) as usize];
        tally.sum_sq / tally.count.max(1) as f64
    };
    let values: Vec<f64> = (0..side * side)
        .map(|cell| {
            let (x, y) = (cell % side, cell / side);
            let around: f64 = (-1..=1)
                .flat_map(|j| (-1..=1).map(move |i| (i, j)))
                .map(|(i, j)| mean_sq(x + i, y + j))
                .sum();
            (0.5 * mean_sq(x, y) + 0.5 * around / 9.0).sqrt()
        })
        .collect();
    let total: f64 = values.iter().sum();
    if total <= 0.0 {
        return None;
    }
    let mut sum = 0.0;
    let shares = values.iter().map(|value| {
        sum += (1.0 - GUIDED) / GUIDE_CELLS as f64 + GUIDED * value / total;
        // multiples of the random numbers' step: a cell's probability is then exactly the difference
        ((sum * 16777216.0).round() / 16777216.0) as Real
    });
    let mut shares: Vec<Real> = shares.collect();
    if let Some(last) = shares.last_mut() {
        *last = 1.0;
    }
    Some(shares)
}
