//! Glass bodies and their ranks where they overlap.

use super::normalize::extent;
use super::parts::{Part, TRIANGLES, parts, without_shared_walls};
use crate::scene::{MaterialKind, Mesh, Scene, Shape, ShapeKind};
use glam::{DVec2, DVec3};
use std::borrow::Cow;
use std::cmp::{Ordering, Reverse};

/// Maximum number of parts of a mesh that become separate bodies.
const PARTS: usize = 256;
/// A mesh whose summed area vector is shorter than this fraction of its area counts as closed.
const LEAST_FACING: f64 = 0.05;

/// Minimum and maximum corner.
pub type Bounds = (DVec3, DVec3);

/// A glass body in world space.
#[derive(Clone, Debug)]
pub struct Body {
    /// Index of the scene's shape.
    pub shape: usize,
    /// Index of the scene's material.
    pub material: usize,
    /// Priority, as in [`MaterialKind::Glass`].
    priority: i32,
    /// Bounding box; `None` for a plane.
    pub bounds: Option<Bounds>,
    /// Unit mean normal of an open sheet; `None` for a closed body.
    pub facing: Option<DVec3>,
}

impl Body {
    fn volume(&self) -> f64 {
        match (self.facing, self.bounds) {
            (None, Some((low, high))) => (high - low).element_product(),
            _ => f64::INFINITY,
        }
    }

    /// Compares ranks: where two bodies overlap, the lesser one is the medium.
    pub fn order(&self, other: &Self) -> Ordering {
        let priority = |body: &Self| Reverse(body.priority);
        priority(self).cmp(&priority(other)).then(self.volume().total_cmp(&other.volume()))
    }
}

/// The bodies of a scene, in the order of its shapes.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    /// All bodies.
    pub all: Vec<Body>,
    /// Body indices of each shape: none, one, or one per triangle.
    pub of: Vec<Vec<u32>>,
    /// True if bodies may overlap.
    pub nested: bool,
}

impl Bodies {
    /// Finds the bodies of `scene`, whose shapes are `kinds`.
    pub fn of(scene: &Scene, kinds: &[Cow<ShapeKind>]) -> Self {
        let mut bodies = Self::default();
        for (index, (shape, kind)) in scene.shapes.iter().zip(kinds).enumerate() {
            let first = bodies.all.len() as u32;
            let MaterialKind::Glass { priority, .. } = scene.materials[shape.material].kind else {
                bodies.of.push(Vec::new());
                continue;
            };
            let body = |facing, bounds| Body {
                shape: index,
                material: shape.material,
                priority,
                bounds,
                facing,
            };
            if let ShapeKind::Mesh(mesh) = &**kind {
                let (found, numbers) = bodies_of_mesh(mesh);
                bodies
                    .all
                    .extend(found.into_iter().map(|(facing, bounds)| body(facing, Some(bounds))));
                bodies.of.push(numbers.into_iter().map(|number| first + number).collect());
            } else {
                bodies.all.push(body(facing(kind), extent(kind)));
                bodies.of.push(vec![first]);
            }
        }
        // any body may lie below an open sheet
        let open = bodies.all.iter().any(|body| body.facing.is_some()) && bodies.all.len() > 1;
        bodies.nested =
            open || any_meet(bodies.all.iter().filter_map(|body| body.bounds).collect());
        bodies
    }

    /// Indices of the bodies by rank, the highest rank first.
    pub fn ranking(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.all.len()).collect();
        order.sort_by(|a, b| self.all[*a].order(&self.all[*b]).then(a.cmp(b)));
        order
    }
}

/// Returns the shapes, with shared walls removed from glass meshes.
pub fn joined(scene: &Scene) -> Vec<Cow<'_, ShapeKind>> {
    let joined = |shape: &Shape| match (&shape.kind, &scene.materials[shape.material].kind) {
        (ShapeKind::Mesh(mesh), MaterialKind::Glass { .. }) => without_shared_walls(mesh),
        _ => None,
    };
    let kind = |shape| {
        joined(shape).map_or(Cow::Borrowed(&shape.kind), |mesh| Cow::Owned(ShapeKind::Mesh(mesh)))
    };
    scene.shapes.iter().map(kind).collect()
}

/// Unit mean normal of an open shape.
fn facing(kind: &ShapeKind) -> Option<DVec3> {
    match kind {
        ShapeKind::Rectangle { u, v, .. } => Some(u.cross(*v).normalize_or_zero()),
        ShapeKind::Disc { normal, .. } | ShapeKind::Plane { normal, .. } => Some(*normal),
        ShapeKind::Revolution { segments, transform, .. } => {
            let ends = segments
                .first()
                .and_then(|s| s.first())
                .zip(segments.last().and_then(|s| s.last()));
            let closed = |(a, b): &(&DVec2, &DVec2)| a == b || (a.x == 0.0 && b.x == 0.0);
            // the area vector from radius a to b is pi (a^2 - b^2) along y
            let open = ends.filter(|ends| !closed(ends)).filter(|(a, b)| a.x != b.x);
            open.map(|(a, b)| transform.direction(DVec3::Y) * (a.x - b.x).signum())
        }
        ShapeKind::Instance { group, map } => {
            let own = group.shapes().first().and_then(|shape| facing(&shape.kind));
            own.map(|n| (map.matrix3.inverse().transpose() * n).normalize_or_zero())
        }
        ShapeKind::Sphere { .. } | ShapeKind::Cuboid { .. } | ShapeKind::Mesh(_) => None,
    }
}

/// Splits a mesh into bodies. Returns the mean normal (if open) and bounding box of each body, and
/// the body index of each triangle, or a single index for all of them. Parts become separate bodies
/// if their bounding boxes meet. The inner wall of a hollow body belongs to that body.
fn bodies_of_mesh(mesh: &Mesh) -> (Vec<(Option<DVec3>, Bounds)>, Vec<u32>) {
    let hull = || {
        mesh.positions.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
            (low.min(*p), high.max(*p))
        })
    };
    if mesh.triangles.len() > TRIANGLES {
        return (vec![(None, hull())], vec![0]);
    }
    let (parts, of) = parts(mesh);
    let whole = || (vec![(facing_of(&parts), hull())], vec![0]);
    if parts.len() <= 1
        || parts.len() > PARTS
        || !any_meet(parts.iter().map(|p| (p.low, p.high)).collect())
    {
        return whole();
    }
    let size = |other: &usize| (parts[*other].high - parts[*other].low).element_product();
    let body_of = |k: usize| {
        let part = &parts[k];
        if !part.closed || part.volume >= 0.0 {
            return k;
        }
        let around = |other: &usize| parts[*other].volume > 0.0 && parts[*other].holds(part);
        let outer = (0..parts.len()).filter(around).min_by(|a, b| size(a).total_cmp(&size(b)));
        outer.unwrap_or(k)
    };
    let bodies: Vec<u32> = (0..parts.len()).map(|k| body_of(k) as u32).collect();
    if bodies.iter().all(|body| *body == bodies[0]) {
        return whole();
    }
    let found =
        parts.iter().map(|part| (facing_of(std::slice::from_ref(part)), (part.low, part.high)));
    (found.collect(), of.iter().map(|part| bodies[*part as usize]).collect())
}

fn facing_of(parts: &[Part]) -> Option<DVec3> {
    let facing: DVec3 = parts.iter().map(|part| part.facing).sum();
    let area: f64 = parts.iter().map(|part| part.area).sum();
    let closed = parts.iter().all(|part| part.closed) || facing.length() <= LEAST_FACING * area;
    (!closed).then(|| facing.normalize_or_zero())
}

/// Returns whether any two boxes meet within rounding.
fn any_meet(mut boxes: Vec<Bounds>) -> bool {
    boxes.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    boxes.iter().enumerate().any(|(i, (low, high))| {
        let slack = DVec3::splat(1e-6 * low.abs().max(high.abs()).max_element());
        let (low, high) = (*low - slack, *high + slack);
        let mut near = boxes[i + 1..].iter().take_while(|b| b.0.x <= high.x);
        near.any(|b| b.0.cmple(high).all() && b.1.cmpge(low).all())
    })
}
