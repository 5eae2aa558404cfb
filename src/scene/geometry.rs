//! Geometry of surfaces.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::appearance::Rgb;
use super::extent;

/// A surface with its material and emission.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Geometric primitive.
    pub kind: ShapeKind,
    /// Index into [`super::Scene::materials`].
    pub material: usize,
    /// Radiance in W sr^-1 m^-2 emitted on the side that the normal points to; zero for a surface
    /// that does not emit, and for planes.
    pub emission: Rgb,
    /// True if (u, v) is world (x, z) instead of the shape's own.
    pub planar_uv: bool,
}

impl Shape {
    /// A shape without emission, with its own texture coordinates.
    pub fn new(kind: ShapeKind, material: usize) -> Self {
        Self { kind, material, emission: [0.0; 3], planar_uv: false }
    }

    /// Returns whether it emits in any channel.
    pub fn is_emitter(&self) -> bool {
        self.emission.iter().any(|&channel| channel > 0.0)
    }
}

/// Geometric primitives. Normals are unit; lengths are in scene units.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeKind {
    /// Normal outward; u = 0.5 - atan2(z, x) / 2pi, v = 0 at the south pole.
    Sphere {
        /// Centre in world space.
        center: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// `origin + s u + t v`, s and t in [0, 1]; a parallelogram when `u` and `v` are not
    /// perpendicular. Normal along `u x v`, which is not zero; uv = (s, t).
    Rectangle {
        /// A corner.
        origin: DVec3,
        /// Edge along s.
        u: DVec3,
        /// Edge along t.
        v: DVec3,
    },
    /// A flat disc.
    Disc {
        /// Centre in world space.
        center: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// An infinite plane; uv = world units along two tangents.
    Plane {
        /// A point on the plane.
        point: DVec3,
        /// Unit normal.
        normal: DVec3,
    },
    /// Axis-aligned box, closed, normals outward.
    Cuboid {
        /// Corner with the least coordinates.
        min: DVec3,
        /// Corner with the greatest coordinates, each greater than in `min`.
        max: DVec3,
    },
    /// A triangle mesh.
    Mesh(Mesh),
    /// Bezier profiles revolved about the local y axis:
    /// `S(theta, t) = (r(t) cos theta, y(t), r(t) sin theta)`.
    Revolution {
        /// Control points (radius, height) of each Bezier segment, degree 1 to 15. Each segment
        /// starts where the previous one ends. The curve's radius is nowhere negative.
        segments: Vec<Vec<DVec2>>,
        /// Transform from object to world space.
        transform: Transform,
        /// Step length, relative to the size of the profile, below which the Newton search for a
        /// ray's hit ends; 0, which scene files imply, iterates to the limit of the precision.
        newton_tolerance: f64,
    },
    /// A group of shapes in another place. Its shapes keep their materials, so that of the instance
    /// is that of the first one.
    Instance {
        /// The group, which instances share.
        group: Arc<Group>,
        /// Map from the group's space to world space; invertible.
        map: DAffine3,
    },
}

/// Shapes in the group's space, with a kd-tree that all instances share.
///
/// They do not emit, and are neither planes nor instances. Glass is the only shape of its group,
/// since each instance of it is a separate body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    shapes: Vec<Shape>,
    bounds: Option<(DVec3, DVec3)>,
}

impl Group {
    /// A group of some shapes.
    pub fn new(shapes: Vec<Shape>) -> Self {
        let boxes = shapes.iter().filter_map(|shape| extent(&shape.kind));
        let bounds = boxes.reduce(|(a, b), (low, high)| (a.min(low), b.max(high)));
        Self { shapes, bounds }
    }

    /// The shapes.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// Bounding box in the group's space; `None` if it is empty.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        self.bounds
    }
}

/// Triangles in world space with separate indices for positions, normals and texture coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions in scene units.
    pub positions: Vec<DVec3>,
    /// Shading normals; of at most unit length, and of unequal lengths only after an uneven
    /// transform.
    pub normals: Vec<DVec3>,
    /// Texture coordinates; v = 0 is an image's bottom row.
    pub uvs: Vec<DVec2>,
    /// Faces of positive area, counter-clockwise seen from outside.
    pub triangles: Vec<Triangle>,
}

/// Indices of a triangle's corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into [`Mesh::positions`].
    pub position: [u32; 3],
    /// Indices into [`Mesh::normals`]; `None` for a flat triangle.
    pub normal: Option<[u32; 3]>,
    /// Indices into [`Mesh::uvs`]; `None` reads textures at (0, 0).
    pub uv: Option<[u32; 3]>,
}

/// Transform from object to world space: scale, then rotation, then translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Uniform scale, > 0.
    pub scale: f64,
    /// Rotation matrix (orthonormal, determinant one).
    pub rotation: DMat3,
    /// Translation in scene units.
    pub translation: DVec3,
}

impl Transform {
    /// The identity transform.
    pub const IDENTITY: Self =
        Self { scale: 1.0, rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Transforms a point from object to world space.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.rotation * (point * self.scale) + self.translation
    }

    /// Transforms a direction or unit normal from object to world space; preserves its length.
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }
}
