//! Surfaces that lie on one another: glass on a floor, water in a glass, a lamp in a ceiling.
//!
//! Which of two coincident surfaces a ray meets first would depend on rounding. So what users mean is made
//! true before anything is rounded: bodies of glass that touch something grow by a few error bounds of a
//! hit, and lamps by twice that. Then glass reaches into the floor that it stands on and into the glass
//! beside it, where the order of bodies decides, and a lamp is in front of the ceiling.

use super::normalize::{Normalization, extent};
use super::parts::{TRIANGLES, parts, places};
use crate::scene::{Material, MaterialKind, Mesh, Scene, Shape, ShapeKind, Transform};
use glam::{DVec2, DVec3};
use std::borrow::Cow;

/// Growth of glass over the sum of the error bounds of two surfaces that touch.
const GLASS: f64 = 4.0;
/// The same of lamps.
const LAMP: f64 = 8.0;
/// Error bound of a hit over a rounding of the largest coordinate: that of the shapes' own bounds.
const ROUNDINGS: f64 = 16.0;
/// Most growth over a body's size.
const MOST: f64 = 1e-3;
/// Least cosine between a corner's mean normal and the normals of its faces that growth reckons with.
const LEAST_COS: f64 = 0.25;

/// The scene's shapes, those grown that touch others. `eps` is one rounding of 1.
pub fn grown<'a>(scene: &'a Scene, n: &Normalization, eps: f64) -> Vec<Cow<'a, ShapeKind>> {
    let mut errors = vec![0.0f64; scene.shapes.len()];
    let near = |shape: &Shape| {
        extent(&shape.kind).map(|(a, b)| {
            let (a, b) = (n.point(a), n.point(b));
            (a, b, a.abs().max(b.abs()).max_element())
        })
    };
    let boxes: Vec<Option<(DVec3, DVec3, f64)>> = scene.shapes.iter().map(near).collect();
    let grows = |i: usize| factor(&scene.shapes[i], &scene.materials) > 0.0;
    let mut touch = |i: usize, j: usize, error: f64| {
        for k in [i, j] {
            errors[k] = errors[k].max(error);
        }
    };
    let mut order: Vec<usize> = (0..boxes.len()).filter(|i| boxes[*i].is_some()).collect();
    let low = |i: usize| boxes[i].map_or(0.0, |b| b.0.x);
    order.sort_by(|a, b| low(*a).total_cmp(&low(*b)));
    let widest = ROUNDINGS * eps * GLASS * 4.0;
    for (at, &i) in order.iter().enumerate() {
        let Some((low_i, high_i, reach_i)) = boxes[i] else { continue };
        for &j in &order[at + 1..] {
            let Some((low_j, high_j, reach_j)) = boxes[j] else { continue };
            if low_j.x > high_i.x + widest * reach_i.max(low_j.x.abs()) {
                break;
            }
            if !grows(i) && !grows(j) {
                continue;
            }
            // of a large sphere what is near the other shape counts
            let own = |k: usize, reach: f64, other: f64| match scene.shapes[k].kind {
                ShapeKind::Sphere { .. } => reach.min(4.0 * other),
                _ => reach + (high_of(boxes[k]) - low_of(boxes[k])).max_element(),
            };
            let reach = own(i, reach_i, reach_j) + own(j, reach_j, reach_i);
            let error = ROUNDINGS * eps * reach;
            let slack = DVec3::splat(GLASS * error);
            if low_j.cmple(high_i + slack).all() && high_j.cmpge(low_i - slack).all() {
                touch(i, j, error);
            }
        }
    }
    for (i, shape) in scene.shapes.iter().enumerate() {
        let ShapeKind::Plane { point, normal } = shape.kind else { continue };
        let point = n.point(point);
        for (j, of) in boxes.iter().enumerate() {
            let Some((low, high, reach)) = of.filter(|_| grows(i) || grows(j)) else { continue };
            let error = ROUNDINGS * eps * 4.0 * (reach + point.dot(normal).abs());
            let middle = normal.dot(0.5 * (low + high) - point);
            let half = normal.abs().dot(0.5 * (high - low));
            if middle.abs() <= half + GLASS * error {
                touch(i, j, error);
            }
        }
    }
    let mut kinds = Vec::with_capacity(errors.len());
    for ((shape, error), of) in scene.shapes.iter().zip(&mut errors).zip(&boxes) {
        let factor = factor(shape, &scene.materials);
        if let (Some((low, high, reach)), ShapeKind::Mesh(mesh)) = (of, &shape.kind)
            && factor > 0.0
            && mesh.triangles.len() <= TRIANGLES
            && parts(mesh).0.len() > 1
        {
            // parts of one mesh may touch one another
            *error = error.max(ROUNDINGS * eps * (reach + (*high - *low).max_element()));
        }
        let size = of.map_or(f64::INFINITY, |(low, high, _)| low.distance(high));
        let by = (factor * *error).min(MOST * size) * n.unit;
        let kind = if by > 0.0 { Cow::Owned(larger(&shape.kind, by)) } else { Cow::Borrowed(&shape.kind) };
        kinds.push(kind);
    }
    kinds
}

fn low_of(of: Option<(DVec3, DVec3, f64)>) -> DVec3 {
    of.map_or(DVec3::ZERO, |of| of.0)
}

fn high_of(of: Option<(DVec3, DVec3, f64)>) -> DVec3 {
    of.map_or(DVec3::ZERO, |of| of.1)
}

/// Error bounds that a shape grows by; 0 for what is neither glass nor a lamp.
fn factor(shape: &Shape, materials: &[Material]) -> f64 {
    let glass = materials.get(shape.material).is_some_and(|m| matches!(m.kind, MaterialKind::Glass { .. }));
    match (shape.is_emitter(), glass) {
        (true, _) => LAMP,
        (false, true) => GLASS,
        (false, false) => 0.0,
    }
}

/// A shape whose surface lies `by` world units further out along its normals.
fn larger(kind: &ShapeKind, by: f64) -> ShapeKind {
    match kind {
        ShapeKind::Sphere { center, radius } => ShapeKind::Sphere { center: *center, radius: radius + by },
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
        ShapeKind::Mesh(mesh) => ShapeKind::Mesh(larger_mesh(mesh, by)),
        ShapeKind::Revolution { segments, transform, newton_tolerance } => ShapeKind::Revolution {
            segments: larger_profile(segments, by / transform.scale),
            transform: Transform { ..*transform },
            newton_tolerance: *newton_tolerance,
        },
    }
}

fn larger_mesh(mesh: &Mesh, by: f64) -> Mesh {
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
    let moved =
        |(position, place): (&DVec3, &usize)| *position + mean[*place] * (by / cos[*place].max(LEAST_COS));
    Mesh { positions: mesh.positions.iter().zip(&places).map(moved).collect(), ..mesh.clone() }
}

/// The profile whose control polygon lies `by` further out; the outer side is on the right of its course.
fn larger_profile(segments: &[Vec<DVec2>], by: f64) -> Vec<Vec<DVec2>> {
    let points: Vec<DVec2> = segments.iter().flatten().copied().collect();
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return Vec::new() };
    let is_loop = first == last && first.x != 0.0;
    let count = points.len();
    // the normal of the edge to the next other point, forward or backward
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
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangle = |position| crate::scene::Triangle { position, normal: None, uv: None };
        let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).map(triangle);
        let mesh = Mesh {
            positions: (0..8).map(corner).collect(),
            normals: Vec::new(),
            uvs: Vec::new(),
            triangles: triangles.collect(),
        };
        for (k, position) in (0..8).zip(&larger_mesh(&mesh, 0.01).positions) {
            let out = (*position - corner(k)) * (corner(k) * 2.0 - DVec3::ONE);
            assert!(out.min_element() >= 0.01 - 1e-12 && out.max_element() < 0.04, "{k}: {out}");
        }
    }
}
