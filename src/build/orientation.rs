//! Which side of a closed body its surface faces.
//!
//! The winding of a mesh's faces, and the direction of a profile, say where outside is. Of a closed body
//! the signed volume tells whether that is so.

use crate::scene::{Mesh, ShapeKind};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// Triangles of a mesh that are looked at, at most.
const TRIANGLES: usize = 1 << 18;
/// Points of a profile's segment.
const STEPS: u32 = 64;

/// Whether a shape is a closed body, or has one, that faces inward and lies in no other.
pub fn faces_inward(kind: &ShapeKind) -> bool {
    match kind {
        ShapeKind::Mesh(mesh) => mesh_faces_inward(mesh),
        ShapeKind::Revolution { segments, .. } => profile_faces_inward(segments),
        ShapeKind::Sphere { .. }
        | ShapeKind::Rectangle { .. }
        | ShapeKind::Disc { .. }
        | ShapeKind::Plane { .. }
        | ShapeKind::Cuboid { .. } => false,
    }
}

/// A profile that begins and ends on the axis, or where it began, encloses `pi` times the integral of
/// `r^2 dy`: above zero where it is drawn upward on its outer side.
fn profile_faces_inward(segments: &[Vec<DVec2>]) -> bool {
    let ends = segments.first().and_then(|s| s.first()).zip(segments.last().and_then(|s| s.last()));
    let closed = ends.is_some_and(|(a, b)| (a.x == 0.0 && b.x == 0.0) || a == b);
    let volume = |segment: &Vec<DVec2>| {
        let points: Vec<DVec2> =
            (0..=STEPS).map(|k| de_casteljau(segment, f64::from(k) / f64::from(STEPS))).collect();
        let slice = |pair: &[DVec2]| {
            let (a, b) = (pair[0], pair[1]);
            (b.y - a.y) * (a.x * a.x + a.x * b.x + b.x * b.x) / 3.0
        };
        points.windows(2).map(slice).sum::<f64>()
    };
    closed && segments.iter().map(volume).sum::<f64>() < 0.0
}

fn de_casteljau(points: &[DVec2], t: f64) -> DVec2 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        points = points.windows(2).map(|pair| pair[0].lerp(pair[1], t)).collect();
    }
    points.first().copied().unwrap_or_default()
}

/// A connected part of a mesh.
#[derive(Clone)]
struct Part {
    /// Six times its signed volume.
    volume: f64,
    low: DVec3,
    high: DVec3,
    closed: bool,
}

fn mesh_faces_inward(mesh: &Mesh) -> bool {
    if mesh.triangles.len() > TRIANGLES {
        return false;
    }
    let parts = parts(mesh);
    let holds = |outer: &Part, inner: &Part| {
        outer.low.cmple(inner.low).all()
            && outer.high.cmpge(inner.high).all()
            && (outer.low != inner.low || outer.high != inner.high)
    };
    // a shell within another one may face inward: the wall of a hollow body
    parts.iter().any(|part| {
        part.closed && part.volume < 0.0 && !parts.iter().any(|other| other.closed && holds(other, part))
    })
}

/// The connected parts of a mesh, corners at the same place being one.
fn parts(mesh: &Mesh) -> Vec<Part> {
    let mut numbers: HashMap<[u64; 3], usize> = HashMap::new();
    let mut corner = |i: u32| {
        // -0 and 0 are one place
        let key = (mesh.positions[i as usize] + DVec3::ZERO).to_array().map(f64::to_bits);
        let next = numbers.len();
        *numbers.entry(key).or_insert(next)
    };
    let triangles: Vec<[usize; 3]> = mesh.triangles.iter().map(|t| t.position.map(&mut corner)).collect();
    let mut root: Vec<usize> = (0..numbers.len()).collect();
    fn find(root: &mut [usize], mut i: usize) -> usize {
        while root[i] != i {
            root[i] = root[root[i]];
            i = root[i];
        }
        i
    }
    // an edge of a closed body is met once in each direction
    let mut edges: HashMap<[usize; 2], i32> = HashMap::new();
    for [a, b, c] in &triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            let (x, y) = (find(&mut root, from), find(&mut root, to));
            root[x] = y;
        }
    }
    let empty = Part { volume: 0.0, low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, closed: true };
    let origin = mesh.positions.first().copied().unwrap_or_default();
    let mut parts: HashMap<usize, Part> = HashMap::new();
    for (numbers, triangle) in triangles.iter().zip(&mesh.triangles) {
        let [a, b, c] = triangle.position.map(|i| mesh.positions[i as usize]);
        // about a corner of the mesh: far from the origin products of coordinates have no digits left
        let [p, q, r] = [a, b, c].map(|corner| corner - origin);
        let part = parts.entry(find(&mut root, numbers[0])).or_insert_with(|| empty.clone());
        part.volume += p.dot(q.cross(r));
        for p in [a, b, c] {
            (part.low, part.high) = (part.low.min(p), part.high.max(p));
        }
    }
    for ([a, _], count) in edges {
        if count != 0
            && let Some(part) = parts.get_mut(&find(&mut root, a))
        {
            part.closed = false;
        }
    }
    parts.into_values().collect()
}
