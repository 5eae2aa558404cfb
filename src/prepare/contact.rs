//! Coincident surfaces: glass on a floor, water in a glass, a light in the plane of a ceiling.
//!
//! Rounding would decide which of two coincident surfaces a ray hits first. Glass bodies that touch
//! another shape are therefore grown by a few hit error bounds before anything is rounded, and area
//! lights by more. Glass then reaches into the floor below it and into adjacent glass, where the
//! ranks decide, and a light lies in front of the ceiling.

use super::bodies::Bodies;
use super::math::EPS;
use super::normalize::{Normalization, extent};
use super::parts::places;
use crate::scene::{Group, Mesh, Scene, Shape, ShapeKind, Transform};
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::sync::Arc;

/// Growth in units of the summed error bounds of two touching surfaces.
const GROWTH: f64 = 4.0;
/// A body grows by one more multiple than the lower-ranked bodies that it touches, up to this many,
/// so that flush faces are hit in the order of rank.
const MOST_TIMES: u32 = 16;
/// Hit error bound in units of the rounding error of the largest coordinate, as in the shapes' own
/// bounds.
const ROUNDINGS: f64 = 16.0;
/// Maximum growth relative to the body's size, and in scene units.
const MOST: f64 = 1e-3;
/// Lower limit of the cosine between a vertex's mean normal and its faces' normals.
const LEAST_COS: f64 = 0.25;

/// A shape or body that may touch others.
struct Item {
    shape: usize,
    /// Bounding box in scene space and its largest absolute coordinate; `None` for a plane.
    bounds: Option<(DVec3, DVec3, f64)>,
    /// Rank, 0 for lights; `None` if it does not grow.
    rank: Option<usize>,
    /// Largest summed error bound with a shape that it touches, scene units; 0 if it touches none.
    error: f64,
    /// Touching items that grow.
    touching: Vec<usize>,
    times: u32,
}

/// Grows the shapes that touch others. Both precisions use the rounding error of f32 and hence get
/// the same scene.
pub fn grown<'a>(
    scene: &Scene,
    kinds: Vec<Cow<'a, ShapeKind>>,
    bodies: &Bodies,
    n: &Normalization,
) -> Vec<Cow<'a, ShapeKind>> {
    let mut items = items(scene, &kinds, bodies, n);
    find_contacts(&mut items, &kinds, n);
    let mut order: Vec<usize> = (0..items.len()).filter(|i| items[*i].rank.is_some()).collect();
    order.sort_by_key(|i| std::cmp::Reverse(items[*i].rank));
    for i in order {
        let behind = |j: &usize| items[*j].rank > items[i].rank;
        let most = items[i].touching.iter().filter(|j| behind(j)).map(|j| items[*j].times).max();
        items[i].times = (most.unwrap_or(0) + 1).min(MOST_TIMES);
    }
    let by = |item: &Item| {
        if item.rank.is_none() {
            return 0.0;
        }
        let size = item.bounds.map_or(f64::INFINITY, |(low, high, _)| low.distance(high));
        (GROWTH * f64::from(item.times) * item.error).min(MOST * size.min(1.0)) * n.unit
    };
    let mut growth = vec![Vec::new(); kinds.len()];
    items.iter().for_each(|item| growth[item.shape].push(by(item)));
    let mut first = 0;
    let larger = |(shape, kind): (usize, Cow<'a, ShapeKind>)| {
        let growth = &growth[shape];
        let numbers = bodies.of.get(shape).map_or(&[][..], Vec::as_slice);
        let base = first;
        first += if numbers.is_empty() { 0 } else { growth.len() as u32 };
        if growth.iter().all(|by| *by == 0.0) {
            return kind;
        }
        let of = |k: usize| numbers.get(k).map_or(growth[0], |body| growth[(body - base) as usize]);
        Cow::Owned(larger(&kind, &of))
    };
    kinds.into_iter().enumerate().map(larger).collect()
}

fn items(scene: &Scene, kinds: &[Cow<ShapeKind>], bodies: &Bodies, n: &Normalization) -> Vec<Item> {
    let mut rank = vec![0; bodies.all.len()];
    for (place, body) in bodies.ranking().into_iter().enumerate() {
        rank[body] = place + 1;
    }
    let item = |shape: usize, bounds: Option<(DVec3, DVec3)>, rank| {
        let bounds = bounds.map(|(low, high)| (n.point(low), n.point(high)));
        let bounds = bounds.map(|(low, high)| (low, high, low.abs().max(high.abs()).max_element()));
        Item { shape, bounds, rank, error: 0.0, touching: Vec::new(), times: 1 }
    };
    let mut items = Vec::new();
    let mut rest = bodies.all.iter().zip(rank).peekable();
    for (index, (shape, kind)) in scene.shapes.iter().zip(kinds).enumerate() {
        let before = items.len();
        while let Some((body, rank)) = rest.next_if(|(body, _)| body.shape == index) {
            items.push(item(index, body.bounds, Some(if shape.is_emitter() { 0 } else { rank })));
        }
        if items.len() == before {
            items.push(item(index, extent(kind), shape.is_emitter().then_some(0)));
        }
    }
    items
}

/// Finds the items whose bounding boxes meet within the hit error bounds.
fn find_contacts(items: &mut [Item], kinds: &[Cow<ShapeKind>], n: &Normalization) {
    let eps = f64::from(EPS);
    let touch = |items: &mut [Item], i: usize, j: usize, error: f64| {
        for (a, b) in [(i, j), (j, i)] {
            items[a].error = items[a].error.max(error);
            if items[a].rank.is_some() && items[b].rank.is_some() {
                items[a].touching.push(b);
            }
        }
    };
    let low = |item: &Item| item.bounds.map_or(0.0, |b| b.0.x);
    let mut order: Vec<usize> = (0..items.len()).filter(|i| items[*i].bounds.is_some()).collect();
    order.sort_by(|a, b| low(&items[*a]).total_cmp(&low(&items[*b])));
    let widest = ROUNDINGS * eps * GROWTH * 8.0;
    for (at, &i) in order.iter().enumerate() {
        let Some((low_i, high_i, reach_i)) = items[i].bounds else { continue };
        for &j in &order[at + 1..] {
            let Some((low_j, high_j, reach_j)) = items[j].bounds else { continue };
            if low_j.x > high_i.x + widest * reach_i.max(reach_j) {
                break;
            }
            if items[i].rank.is_none() && items[j].rank.is_none() {
                continue;
            }
            // only the part of a large sphere near the other shape matters
            let own = |k: usize, reach: f64, size: DVec3, other: f64| match *kinds[items[k].shape] {
                ShapeKind::Sphere { .. } => reach.min(4.0 * other),
                _ => reach + size.max_element(),
            };
            let reach =
                own(i, reach_i, high_i - low_i, reach_j) + own(j, reach_j, high_j - low_j, reach_i);
            let error = ROUNDINGS * eps * reach;
            let slack = DVec3::splat(GROWTH * error);
            if low_j.cmple(high_i + slack).all() && high_j.cmpge(low_i - slack).all() {
                touch(items, i, j, error);
            }
        }
    }
    for i in 0..items.len() {
        let ShapeKind::Plane { point, normal } = *kinds[items[i].shape] else { continue };
        let point = n.point(point);
        for j in 0..items.len() {
            let grows = items[i].rank.or(items[j].rank).is_some();
            let Some((low, high, reach)) = items[j].bounds.filter(|_| grows) else { continue };
            // only the point of a large sphere next to the plane matters
            let reach = match *kinds[items[j].shape] {
                ShapeKind::Sphere { .. } => {
                    let (center, radius) = (0.5 * (low + high), 0.5 * (high.y - low.y));
                    let off = normal.dot(center - point);
                    (center - normal * off.signum() * radius).abs().max_element()
                }
                _ => reach,
            };
            let error = ROUNDINGS * eps * 4.0 * (reach + point.dot(normal).abs());
            let middle = normal.dot(0.5 * (low + high) - point);
            let half = normal.abs().dot(0.5 * (high - low));
            if middle.abs() <= half + GROWTH * error {
                touch(items, i, j, error);
            }
        }
    }
}

/// Moves the surface outward by `of` world units, given for each triangle of a mesh.
fn larger(kind: &ShapeKind, of: &dyn Fn(usize) -> f64) -> ShapeKind {
    let by = of(0);
    match kind {
        ShapeKind::Sphere { center, radius } => {
            ShapeKind::Sphere { center: *center, radius: radius + by }
        }
        ShapeKind::Cuboid { min, max } => {
            ShapeKind::Cuboid { min: *min - DVec3::splat(by), max: *max + DVec3::splat(by) }
        }
        ShapeKind::Rectangle { origin, u, v } => {
            ShapeKind::Rectangle { origin: *origin + u.cross(*v).normalize() * by, u: *u, v: *v }
        }
        ShapeKind::Disc { center, normal, radius } => {
            ShapeKind::Disc { center: *center + *normal * by, normal: *normal, radius: *radius }
        }
        ShapeKind::Plane { point, normal } => {
            ShapeKind::Plane { point: *point + *normal * by, normal: *normal }
        }
        ShapeKind::Mesh(mesh) => ShapeKind::Mesh(larger_mesh(mesh, of)),
        ShapeKind::Revolution { segments, transform, newton_tolerance } => ShapeKind::Revolution {
            segments: larger_profile(segments, by / transform.scale),
            transform: Transform { ..*transform },
            newton_tolerance: *newton_tolerance,
        },
        // a length along the normal in the group's space is at least its smallest singular value
        // times as long in the world
        ShapeKind::Instance { group, map } => {
            let inverse = map.matrix3.inverse();
            let squares = inverse.to_cols_array().iter().map(|x| x * x).sum::<f64>();
            let of = |k: usize| of(k) * squares.sqrt();
            let shape = |shape: &Shape| Shape { kind: larger(&shape.kind, &of), ..shape.clone() };
            let shapes = group.shapes().iter().map(shape).collect();
            ShapeKind::Instance { group: Arc::new(Group::new(shapes)), map: *map }
        }
    }
}

fn larger_mesh(mesh: &Mesh, of: &dyn Fn(usize) -> f64) -> Mesh {
    let places = places(mesh);
    let normal = |t: &crate::scene::Triangle| {
        let [a, b, c] = t.position.map(|i| mesh.positions[i as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let mut mean = vec![DVec3::ZERO; places.len()];
    for triangle in &mesh.triangles {
        for i in triangle.position {
            mean[places[i as usize]] += normal(triangle);
        }
    }
    mean.iter_mut().for_each(|m| *m = m.normalize_or_zero());
    let mut cos = vec![1.0f64; places.len()];
    for triangle in &mesh.triangles {
        for i in triangle.position {
            let place = places[i as usize];
            cos[place] = cos[place].min(normal(triangle).dot(mean[place]));
        }
    }
    let mut by = vec![0.0f64; places.len()];
    for (k, triangle) in mesh.triangles.iter().enumerate() {
        triangle.position.iter().for_each(|i| by[places[*i as usize]] = of(k));
    }
    let moved = |(position, place): (&DVec3, &usize)| {
        *position + mean[*place] * (by[*place] / cos[*place].max(LEAST_COS))
    };
    Mesh { positions: mesh.positions.iter().zip(&places).map(moved).collect(), ..mesh.clone() }
}

/// Offsets the control polygon outward, to the right of its direction, by `by`.
fn larger_profile(segments: &[Vec<DVec2>], by: f64) -> Vec<Vec<DVec2>> {
    let points: Vec<DVec2> = segments.iter().flatten().copied().collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let is_loop = first == last && first.x != 0.0;
    let count = points.len();
    // normal of the edge to the nearest distinct point, forward or backward
    let edge = |i: usize, forward: bool| {
        let steps = if is_loop {
            count
        } else if forward {
            count - 1 - i
        } else {
            i
        };
        let at = |k: usize| points[if forward { (i + k) % count } else { (i + count - k) % count }];
        let other = (1..=steps).map(at).find(|p| *p != points[i])?;
        let along = if forward { other - points[i] } else { points[i] - other };
        let along = along.normalize_or_zero();
        Some(DVec2::new(along.y, -along.x))
    };
    let moved = |i: usize| {
        let (before, after) = (edge(i, false), edge(i, true));
        let (Some(a), Some(b)) = (before.or(after), after.or(before)) else { return points[i] };
        let mean = (a + b).normalize_or_zero();
        if points[i].x == 0.0 {
            let up = if a.y.abs() > b.y.abs() { a.y } else { b.y };
            return points[i] + DVec2::new(0.0, up.signum() * by / up.abs().max(LEAST_COS));
        }
        let out = points[i] + mean * (by / mean.dot(a).max(LEAST_COS));
        DVec2::new(out.x.max(0.0), out.y)
    };
    let mut at = 0;
    let of = |segment: &Vec<DVec2>| {
        let moved: Vec<DVec2> = (at..at + segment.len()).map(moved).collect();
        at += segment.len();
        moved
    };
    segments.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    // Theory: every point of the larger surface lies `by` outside of the smaller one's planes.
    #[test]
    fn profiles_and_meshes_grow_outward() {
        let can = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.6], [0.0, 0.6]].map(DVec2::from_array);
        let segments: Vec<Vec<DVec2>> = can.windows(2).map(<[DVec2]>::to_vec).collect();
        let grown = larger_profile(&segments, 0.1);
        let expected = [[0.0, -0.1], [0.6, -0.1], [0.6, 0.7], [0.0, 0.7]].map(DVec2::from_array);
        for (segment, pair) in grown.iter().zip(expected.windows(2)) {
            for (a, b) in segment.iter().zip(pair) {
                assert!(a.distance(*b) < 1e-12, "{grown:?}");
            }
        }
        let corner = |k: u32| DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2 & 1) as f64);
        let faces =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangle = |position| crate::scene::Triangle { position, normal: None, uv: None };
        let triangles =
            faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).map(triangle);
        let mesh = Mesh {
            positions: (0..8).map(corner).collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: triangles.collect(),
        };
        for (k, position) in (0..8).zip(&larger_mesh(&mesh, &|_| 0.01).positions) {
            let out = (*position - corner(k)) * (corner(k) * 2.0 - DVec3::ONE);
            assert!(out.min_element() >= 0.01 - 1e-12 && out.max_element() < 0.04, "{k}: {out}");
        }
    }
}
