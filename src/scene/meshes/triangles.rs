//! Conversion of polygons to triangles: ear clipping, shared vertices.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::normals::Normals;
use crate::scene::{Mesh, Transform, Triangle};

/// A triangle is degenerate if twice its area is at most this fraction of its longest edge squared.
const DEGENERATE: f64 = 1e-12;

/// A corner of a polygon in object space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    pub position: DVec3,
    pub normal: Option<DVec3>,
    pub uv: Option<DVec2>,
}

/// Remaining steps of ear clipping. A polygon of n corners usually takes n^2 steps, and n^3 at
/// worst, which would not end with thousands of corners.
#[derive(Debug)]
pub(crate) struct Steps(u64);

impl Steps {
    /// Number of steps that takes about ten seconds.
    pub const MOST: u64 = 1_000_000_000;

    /// Takes `count` steps. If fewer are left, returns false and leaves none.
    fn take(&mut self, count: usize) -> bool {
        let left = self.0.checked_sub(count as u64);
        self.0 = left.unwrap_or(0);
        left.is_some()
    }

    pub fn are_used_up(&self) -> bool {
        self.0 == 0
    }
}

impl Default for Steps {
    fn default() -> Self {
        Self(Self::MOST)
    }
}

/// A face of a mesh file.
#[derive(Clone, Debug)]
pub(crate) struct Polygon {
    pub corners: Vec<Corner>,
    /// Smoothing group, whose faces share computed normals; `None` computes none.
    pub group: Option<u32>,
}

impl Polygon {
    /// Twice the area times the unit normal (Newell); exact for a planar polygon, and the best
    /// plane for a warped one.
    fn area_vector(&self) -> DVec3 {
        let base = self.corners[0].position;
        let edges = self.corners.windows(2);
        edges.map(|pair| (pair[0].position - base).cross(pair[1].position - base)).sum()
    }

    /// Number of triangles that [`Self::triangulate`] makes.
    pub fn triangles(&self) -> usize {
        self.corners.len().saturating_sub(2)
    }

    /// Triangulates by ear clipping in the plane of [`Self::area_vector`]; returns indices of
    /// corners. A self-intersecting polygon has no such triangulation, so its remainder becomes a
    /// fan.
    pub fn triangulate(&self, steps: &mut Steps) -> Vec<[usize; 3]> {
        let axis = self.area_vector();
        let mut left: Vec<usize> = (0..self.corners.len()).collect();
        let mut triangles = Vec::with_capacity(left.len().saturating_sub(2));
        while left.len() > 3 {
            let ear = (0..left.len()).find(|&at| self.is_ear(&left, at, axis, steps)).unwrap_or(1);
            triangles.push(around(&left, ear));
            left.remove(ear);
        }
        if let [a, b, c] = left[..] {
            triangles.push([a, b, c]);
        }
        triangles
    }

    fn is_ear(&self, left: &[usize], at: usize, axis: DVec3, steps: &mut Steps) -> bool {
        if !steps.take(1) {
            return false;
        }
        let corners = around(left, at);
        let [a, b, c] = corners.map(|corner| self.corners[corner].position);
        let turn = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(axis);
        if turn(a, b, c) <= 0.0 {
            return false;
        }
        steps.take(left.len());
        let others = left.iter().filter(|corner| !corners.contains(corner));
        let mut others =
            others.map(|&corner| self.corners[corner].position).filter(|p| ![a, b, c].contains(p));
        !others.any(|p| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0)
    }
}

fn around(left: &[usize], at: usize) -> [usize; 3] {
    let count = left.len();
    [left[(at + count - 1) % count], left[at], left[(at + 1) % count]]
}

/// Bits that distinguish positions; -0 equals 0.
pub(super) type Key<const N: usize> = [u64; N];

pub(super) fn key<const N: usize>(values: [f64; N]) -> Key<N> {
    values.map(|value| (value + 0.0).to_bits())
}

/// The normals divided by their lengths, if there are three that have a length.
fn all_unit(normals: [Option<DVec3>; 3]) -> Option<[DVec3; 3]> {
    match normals.map(|normal| normal?.try_normalize()) {
        [Some(a), Some(b), Some(c)] => Some([a, b, c]),
        _ => None,
    }
}

/// Builds a world-space mesh from polygons.
pub(crate) struct MeshBuilder {
    pub mesh: Mesh,
    /// Number of triangles dropped because they have no area.
    pub degenerate: usize,
    /// Number of triangles made flat because the file gives them a normal of length 0.
    pub unusable_normals: usize,
    transform: Transform,
    positions: HashMap<Key<3>, u32>,
    normals: HashMap<Key<3>, u32>,
    uvs: HashMap<Key<2>, u32>,
}

impl MeshBuilder {
    pub fn new(transform: Transform) -> Self {
        Self {
            mesh: Mesh::default(),
            degenerate: 0,
            unusable_normals: 0,
            transform,
            positions: HashMap::new(),
            normals: HashMap::new(),
            uvs: HashMap::new(),
        }
    }

    /// Adds a face, whose triangles are numbered from `first` on in the order of the file.
    /// `normals` provides those that the file lacks; `None` makes all faces flat.
    pub fn add(
        &mut self,
        polygon: &Polygon,
        first: usize,
        normals: Option<&Normals>,
        steps: &mut Steps,
    ) {
        for (at, triangle) in polygon.triangulate(steps).into_iter().enumerate() {
            let corners = triangle.map(|corner| polygon.corners[corner]);
            let shading = normals.map(|normals| {
                [0, 1, 2].map(|corner| {
                    let Corner { position, normal, .. } = corners[corner];
                    let own = normal.filter(|_| !normals.replace());
                    own.or_else(|| normals.at(position, polygon.group, (first + at, corner)))
                })
            });
            self.add_triangle(corners, shading);
        }
    }

    /// Adds a triangle with the shading normals of its corners, of any length; `None` makes it
    /// flat.
    fn add_triangle(&mut self, mut corners: [Corner; 3], shading: Option<[Option<DVec3>; 3]>) {
        let [a, b, c] = corners.map(|corner| corner.position);
        let area = (b - a).cross(c - a);
        let longest =
            (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        // Coordinates that are too large to square give no finite area.
        if area.length() <= DEGENERATE * longest || !area.is_finite() {
            self.degenerate += 1;
            return;
        }
        let normals = shading.and_then(all_unit);
        let own = shading.and_then(|_| all_unit(corners.map(|corner| corner.normal)));
        if normals.is_none() && shading.is_some() && corners[0].normal.is_some() {
            self.unusable_normals += 1;
        }
        let mut normals = normals.map(|normals| normals.map(|normal| self.normal(normal)));
        // The file's normals define the outside; some exporters wind the corners the other way.
        let outward = own.map(|own| own.into_iter().sum::<DVec3>());
        if outward.is_some_and(|outward| area.dot(outward) < 0.0) {
            corners.swap(1, 2);
            normals = normals.map(|[a, b, c]| [a, c, b]);
        }
        let position = corners.map(|corner| self.position(corner.position));
        let uv = match corners.map(|corner| corner.uv) {
            [Some(a), Some(b), Some(c)] => Some([a, b, c].map(|uv| self.uv(uv))),
            _ => None,
        };
        self.mesh.triangles.push(Triangle { position, normal: normals, uv });
    }

    fn position(&mut self, local: DVec3) -> u32 {
        let positions = &mut self.mesh.positions;
        *self.positions.entry(key(local.to_array())).or_insert_with(|| {
            positions.push(self.transform.point(local));
            positions.len() as u32 - 1
        })
    }

    fn normal(&mut self, local: DVec3) -> u32 {
        let normals = &mut self.mesh.normals;
        *self.normals.entry(key(local.to_array())).or_insert_with(|| {
            normals.push(self.transform.direction(local).normalize());
            normals.len() as u32 - 1
        })
    }

    fn uv(&mut self, uv: DVec2) -> u32 {
        let uvs = &mut self.mesh.uvs;
        *self.uvs.entry(key(uv.to_array())).or_insert_with(|| {
            uvs.push(uv);
            uvs.len() as u32 - 1
        })
    }
}
