//! Conversion of polygons to triangles: ear clipping, vertex normals, shared vertices.

use std::borrow::Borrow;
use std::collections::HashMap;

use glam::{DVec2, DVec3};

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
pub(crate) struct Polygon(pub Vec<Corner>);

impl Polygon {
    /// Twice the area times the unit normal (Newell); exact for a planar polygon, and the best
    /// plane for a warped one.
    fn area_vector(&self) -> DVec3 {
        let base = self.0[0].position;
        let edges = self.0.windows(2);
        edges.map(|pair| (pair[0].position - base).cross(pair[1].position - base)).sum()
    }

    /// Triangulates by ear clipping in the plane of [`Self::area_vector`]; returns indices of
    /// corners. A self-intersecting polygon has no such triangulation, so its remainder becomes a
    /// fan.
    fn triangulate(&self, steps: &mut Steps) -> Vec<[usize; 3]> {
        let axis = self.area_vector();
        let mut left: Vec<usize> = (0..self.0.len()).collect();
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
        let [a, b, c] = corners.map(|corner| self.0[corner].position);
        let turn = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).dot(axis);
        if turn(a, b, c) <= 0.0 {
            return false;
        }
        steps.take(left.len());
        let others = left.iter().filter(|corner| !corners.contains(corner));
        let mut others =
            others.map(|&corner| self.0[corner].position).filter(|p| ![a, b, c].contains(p));
        !others.any(|p| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0)
    }
}

fn around(left: &[usize], at: usize) -> [usize; 3] {
    let count = left.len();
    [left[(at + count - 1) % count], left[at], left[(at + 1) % count]]
}

/// Bits that distinguish positions; -0 equals 0.
type Key<const N: usize> = [u64; N];

fn key<const N: usize>(values: [f64; N]) -> Key<N> {
    values.map(|value| (value + 0.0).to_bits())
}

/// Sums of face normals at each position, weighted by the corner's angle (Thuermer & Wuethrich
/// 1998); not normalized.
pub(crate) fn vertex_normals(
    polygons: impl Iterator<Item = impl Borrow<Polygon>>,
    steps: &mut Steps,
) -> HashMap<Key<3>, DVec3> {
    let mut normals = HashMap::new();
    for polygon in polygons {
        let polygon = polygon.borrow();
        for triangle in polygon.triangulate(steps) {
            let p = triangle.map(|corner| polygon.0[corner].position);
            let Some(normal) = (p[1] - p[0]).cross(p[2] - p[0]).try_normalize() else {
                continue;
            };
            for corner in 0..3 {
                let to_next = p[(corner + 1) % 3] - p[corner];
                let to_last = p[(corner + 2) % 3] - p[corner];
                let sum: &mut DVec3 = normals.entry(key(p[corner].to_array())).or_default();
                *sum += to_next.angle_between(to_last) * normal;
            }
        }
    }
    normals
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

    /// Adds a face. `smooth` provides normals for faces without their own; `None` makes all faces
    /// flat.
    pub fn add(
        &mut self,
        polygon: &Polygon,
        smooth: Option<&HashMap<Key<3>, DVec3>>,
        steps: &mut Steps,
    ) {
        for triangle in polygon.triangulate(steps) {
            self.add_triangle(triangle.map(|corner| polygon.0[corner]), smooth);
        }
    }

    fn add_triangle(&mut self, mut corners: [Corner; 3], smooth: Option<&HashMap<Key<3>, DVec3>>) {
        let [a, b, c] = corners.map(|corner| corner.position);
        let area = (b - a).cross(c - a);
        let longest =
            (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        // Coordinates that are too large to square give no finite area.
        if area.length() <= DEGENERATE * longest || !area.is_finite() {
            self.degenerate += 1;
            return;
        }
        let normals = smooth.and_then(|smooth| self.corner_normals(&corners, smooth));
        let mut normals = normals.map(|normals| normals.map(|normal| self.normal(normal)));
        if let Some(own) = corners[0].normal.and(normals) {
            // The file's normals define the outside; some exporters wind the corners the other way.
            let side: DVec3 = own.iter().map(|&index| self.mesh.normals[index as usize]).sum();
            if self.transform.direction(area).dot(side) < 0.0 {
                corners.swap(1, 2);
                normals = Some([own[0], own[2], own[1]]);
            }
        }
        let position = corners.map(|corner| self.position(corner.position));
        let uv = match corners.map(|corner| corner.uv) {
            [Some(a), Some(b), Some(c)] => Some([a, b, c].map(|uv| self.uv(uv))),
            _ => None,
        };
        self.mesh.triangles.push(Triangle { position, normal: normals, uv });
    }

    fn corner_normals(
        &mut self,
        corners: &[Corner; 3],
        smooth: &HashMap<Key<3>, DVec3>,
    ) -> Option<[DVec3; 3]> {
        let normals = corners.map(|corner| {
            let normal = corner.normal.or(smooth.get(&key(corner.position.to_array())).copied());
            normal.and_then(|normal| normal.try_normalize())
        });
        match normals {
            [Some(a), Some(b), Some(c)] => Some([a, b, c]),
            _ => {
                self.unusable_normals += usize::from(corners[0].normal.is_some());
                None
            }
        }
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
