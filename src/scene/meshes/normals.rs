//! Normals of the corners of faces that the file gives none: averages over the faces of a
//! smoothing group, or over those that meet at edges below a crease angle.

use std::borrow::Borrow;
use std::collections::HashMap;

use glam::DVec3;

use super::triangles::{Key, Polygon, Steps, key};

/// Cosines closer than this to that of the crease angle count as equal, so that the edges of a box
/// are creases at 90 degrees.
const COSINE_ERROR: f64 = 1e-9;

/// Sums of face normals, weighted by the corner's angle (Thuermer & Wuethrich 1998); not
/// normalized.
#[derive(Debug)]
pub(crate) enum Normals {
    /// For each position, the sum over the faces of each smoothing group.
    Grouped(HashMap<(Key<3>, u32), DVec3>),
    /// For each corner of each triangle, in the order of the polygons, the sum over the faces that
    /// can be reached around the corner without crossing a crease; zero for a flat triangle.
    Creased(Vec<[DVec3; 3]>),
}

impl Normals {
    /// Normals that are averaged over smoothing groups and, with a crease angle in degrees, only
    /// across edges of exactly two faces whose normals differ by less.
    pub fn of(
        polygons: impl Iterator<Item = impl Borrow<Polygon>>,
        crease_angle: Option<f64>,
        steps: &mut Steps,
    ) -> Self {
        match crease_angle {
            None => Self::Grouped(grouped(polygons, steps)),
            Some(degrees) => {
                let mut fans = Fans::new(polygons, steps);
                fans.join(degrees.to_radians().cos() + COSINE_ERROR);
                Self::Creased(fans.normals())
            }
        }
    }

    /// Returns whether these replace the normals of the file.
    pub fn replace(&self) -> bool {
        matches!(self, Self::Creased(_))
    }

    /// The normal at a corner of a triangle, which has its number among all triangles.
    pub fn at(
        &self,
        position: DVec3,
        group: Option<u32>,
        (triangle, corner): (usize, usize),
    ) -> Option<DVec3> {
        match self {
            Self::Grouped(sums) => sums.get(&(key(position.to_array()), group?)).copied(),
            Self::Creased(sums) => sums.get(triangle).map(|sums| sums[corner]),
        }
    }
}

/// Unit normal of a triangle and the angles of its corners; `None` if it has no area.
fn facing(p: [DVec3; 3]) -> Option<(DVec3, [f64; 3])> {
    let normal = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize()?;
    let angle = |corner: usize| {
        let to_next = p[(corner + 1) % 3] - p[corner];
        let to_last = p[(corner + 2) % 3] - p[corner];
        to_next.angle_between(to_last)
    };
    Some((normal, [0, 1, 2].map(angle)))
}

fn grouped(
    polygons: impl Iterator<Item = impl Borrow<Polygon>>,
    steps: &mut Steps,
) -> HashMap<(Key<3>, u32), DVec3> {
    let mut normals = HashMap::new();
    for polygon in polygons {
        let polygon = polygon.borrow();
        let Some(group) = polygon.group else { continue };
        for triangle in polygon.triangulate(steps) {
            let p = triangle.map(|corner| polygon.corners[corner].position);
            let Some((normal, angles)) = facing(p) else { continue };
            for corner in 0..3 {
                let place = (key(p[corner].to_array()), group);
                let sum: &mut DVec3 = normals.entry(place).or_default();
                *sum += angles[corner] * normal;
            }
        }
    }
    normals
}

/// A triangle with the numbers of its positions.
struct Facing {
    vertices: [u32; 3],
    /// Zero for a triangle that takes no part.
    normal: DVec3,
    angles: [f64; 3],
    group: Option<u32>,
}

/// The corners of all triangles, in sets of those that share a normal. A corner is numbered by
/// three times its triangle plus its place in it.
struct Fans {
    triangles: Vec<Facing>,
    /// Union-find: another corner of the set, or the corner itself.
    parents: Vec<usize>,
}

impl Fans {
    fn new(polygons: impl Iterator<Item = impl Borrow<Polygon>>, steps: &mut Steps) -> Self {
        let mut triangles = Vec::new();
        let mut vertices: HashMap<Key<3>, u32> = HashMap::new();
        for polygon in polygons {
            let polygon = polygon.borrow();
            for triangle in polygon.triangulate(steps) {
                let p = triangle.map(|corner| polygon.corners[corner].position);
                let vertices = p.map(|p| {
                    let count = vertices.len() as u32;
                    *vertices.entry(key(p.to_array())).or_insert(count)
                });
                let (normal, angles) =
                    facing(p).filter(|_| polygon.group.is_some()).unwrap_or_default();
                triangles.push(Facing { vertices, normal, angles, group: polygon.group });
            }
        }
        Self { parents: (0..3 * triangles.len()).collect(), triangles }
    }

    fn find(&mut self, corner: usize) -> usize {
        let mut at = corner;
        while self.parents[at] != at {
            self.parents[at] = self.parents[self.parents[at]];
            at = self.parents[at];
        }
        at
    }

    /// Joins the corners on both sides of each edge whose faces differ by an angle with at least
    /// this cosine.
    fn join(&mut self, least_cosine: f64) {
        let mut edges: Vec<(u64, usize)> = Vec::with_capacity(3 * self.triangles.len());
        for (at, triangle) in self.triangles.iter().enumerate() {
            if triangle.normal != DVec3::ZERO {
                edges.extend((0..3).map(|corner| {
                    let [a, b] = [corner, corner + 1].map(|k| triangle.vertices[k % 3]);
                    (u64::from(a.min(b)) << 32 | u64::from(a.max(b)), 3 * at + corner)
                }));
            }
        }
        edges.sort_unstable();
        for sides in edges.chunk_by(|a, b| a.0 == b.0) {
            // Where three faces or more meet, no two of them belong together more than others.
            let [(_, a), (_, b)] = sides else { continue };
            let [s, t] = [a, b].map(|side| &self.triangles[side / 3]);
            if s.group == t.group && s.normal.dot(t.normal) >= least_cosine {
                self.join_ends(*a, *b);
            }
        }
    }

    /// Joins the corners at both ends of an edge, which begins at corner `a` of one triangle and at
    /// corner `b` of another.
    fn join_ends(&mut self, a: usize, b: usize) {
        let next = |corner: usize| corner - corner % 3 + (corner + 1) % 3;
        let vertex = |corner: usize| self.triangles[corner / 3].vertices[corner % 3];
        let pairs = if vertex(a) == vertex(b) {
            [(a, b), (next(a), next(b))]
        } else {
            [(a, next(b)), (next(a), b)]
        };
        for (a, b) in pairs {
            let (a, b) = (self.find(a), self.find(b));
            self.parents[a.max(b)] = a.min(b);
        }
    }

    fn normals(mut self) -> Vec<[DVec3; 3]> {
        let mut sums = vec![DVec3::ZERO; self.parents.len()];
        for corner in 0..sums.len() {
            let set = self.find(corner);
            let triangle = &self.triangles[corner / 3];
            sums[set] += triangle.angles[corner % 3] * triangle.normal;
        }
        let all: Vec<DVec3> = (0..sums.len()).map(|corner| sums[self.find(corner)]).collect();
        all.as_chunks().0.to_vec()
    }
}
