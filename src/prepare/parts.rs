//! Connected components of a mesh.

use crate::scene::{Mesh, Triangle};
use glam::DVec3;
use std::collections::HashMap;

/// Meshes with more triangles are not split into parts.
pub const TRIANGLES: usize = 1 << 18;

/// A connected component, in the mesh's coordinates.
#[derive(Clone, Debug)]
pub struct Part {
    /// Six times the signed volume, positive if a closed part faces outward.
    pub volume: f64,
    /// Twice the summed area vector; zero for a closed part.
    pub facing: DVec3,
    /// Twice the area.
    pub area: f64,
    /// Minimum corner of the bounding box.
    pub low: DVec3,
    /// Maximum corner of the bounding box.
    pub high: DVec3,
    /// True if every edge is used once in each direction.
    pub closed: bool,
}

impl Part {
    /// Returns whether the bounding box contains that of `other` and differs from it.
    pub fn holds(&self, other: &Part) -> bool {
        self.low.cmple(other.low).all()
            && self.high.cmpge(other.high).all()
            && (self.low != other.low || self.high != other.high)
    }
}

/// Returns the parts and the part index of each triangle. Vertices at equal positions are merged.
pub fn parts(mesh: &Mesh) -> (Vec<Part>, Vec<u32>) {
    let corners = places(mesh);
    let triangles: Vec<[usize; 3]> =
        mesh.triangles.iter().map(|t| t.position.map(|i| corners[i as usize])).collect();
    let mut root: Vec<usize> = (0..mesh.positions.len()).collect();
    fn find(root: &mut [usize], mut i: usize) -> usize {
        while root[i] != i {
            root[i] = root[root[i]];
            i = root[i];
        }
        i
    }
    let mut edges: HashMap<[usize; 2], i32> = HashMap::new();
    for [a, b, c] in &triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            *edges.entry([from.min(to), from.max(to)]).or_default() +=
                if from < to { 1 } else { -1 };
            let (x, y) = (find(&mut root, from), find(&mut root, to));
            root[x] = y;
        }
    }
    let empty = Part {
        volume: 0.0,
        facing: DVec3::ZERO,
        area: 0.0,
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
        closed: true,
    };
    let origin = mesh.positions.first().copied().unwrap_or_default();
    let mut numbers: HashMap<usize, u32> = HashMap::new();
    let mut parts: Vec<Part> = Vec::new();
    let mut of = Vec::with_capacity(triangles.len());
    for (places, triangle) in triangles.iter().zip(&mesh.triangles) {
        let number = *numbers.entry(find(&mut root, places[0])).or_insert_with(|| {
            parts.push(empty.clone());
            parts.len() as u32 - 1
        });
        of.push(number);
        let [a, b, c] = triangle.position.map(|i| mesh.positions[i as usize]);
        // relative to a corner of the mesh: far from the origin, products of coordinates lose all
        // their digits
        let [p, q, r] = [a, b, c].map(|corner| corner - origin);
        let across = (b - a).cross(c - a);
        let part = &mut parts[number as usize];
        part.volume += p.dot(q.cross(r));
        part.facing += across;
        part.area += across.length();
        for p in [a, b, c] {
            (part.low, part.high) = (part.low.min(p), part.high.max(p));
        }
    }
    for ([a, _], count) in edges {
        if count != 0
            && let Some(number) = numbers.get(&find(&mut root, a))
        {
            parts[*number as usize].closed = false;
        }
    }
    (parts, of)
}

/// Returns for each vertex the first vertex with an equal position.
pub fn places(mesh: &Mesh) -> Vec<usize> {
    let mut first: HashMap<[u64; 3], usize> = HashMap::new();
    let place = |(i, position): (usize, &DVec3)| {
        // -0 and 0 are the same position
        let key = (*position + DVec3::ZERO).to_array().map(f64::to_bits);
        *first.entry(key).or_insert(i)
    };
    mesh.positions.iter().enumerate().map(place).collect()
}

/// Removes pairs of triangles with equal vertices and opposite orientation: walls that two parts of
/// a glass mesh share. Returns `None` if there are none.
pub fn without_shared_walls(mesh: &Mesh) -> Option<Mesh> {
    if mesh.triangles.len() > TRIANGLES {
        return None;
    }
    let places = places(mesh);
    // rotated so that the smallest index comes first
    let key = |t: &Triangle| {
        let [a, b, c] = t.position.map(|i| places[i as usize]);
        if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        }
    };
    let mut count: HashMap<[usize; 3], i32> = HashMap::new();
    mesh.triangles.iter().for_each(|t| *count.entry(key(t)).or_default() += 1);
    let shared = |t: &Triangle| {
        let [a, b, c] = key(t);
        count.get(&[a, c, b]).is_some_and(|other| count.get(&[a, b, c]) == Some(other))
    };
    if !mesh.triangles.iter().any(shared) {
        return None;
    }
    let triangles: Vec<Triangle> = mesh.triangles.iter().filter(|t| !shared(t)).copied().collect();
    (!triangles.is_empty()).then(|| Mesh { triangles, ..mesh.clone() })
}
