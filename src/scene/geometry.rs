//! Where surfaces are.

use glam::{DMat3, DVec2, DVec3};

use super::appearance::Rgb;

/// A surface with its material and its light.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// What and where it is.
    pub kind: ShapeKind,
    /// Index into [`super::Scene::materials`].
    pub material: usize,
    /// Radiance in W sr^-1 m^-2 that leaves the side that the normal points to; zero for no light,
    /// and for planes.
    pub emission: Rgb,
    /// Whether (u, v) is world (x, z) in place of the shape's own.
    pub planar_uv: bool,
}

impl Shape {
    /// A shape that does not emit, with its own texture coordinates.
    pub fn new(kind: ShapeKind, material: usize) -> Self {
        Self { kind, material, emission: [0.0; 3], planar_uv: false }
    }

    /// Whether it shines.
    pub fn is_emitter(&self) -> bool {
        self.emission.iter().any(|&channel| channel > 0.0)
    }
}

/// Kinds of surfaces. Normals are unit; lengths are in scene units.
#[derive(Clone, Debug, PartialEq)]
pub enum ShapeKind {
    /// Normal outward; u = 0.5 - atan2(z, x)/2pi, v = 0 at the south pole.
    Sphere {
        /// Centre.
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
        /// Centre.
        center: DVec3,
        /// Unit normal.
        normal: DVec3,
        /// Radius, > 0.
        radius: f64,
    },
    /// An infinite plane; uv = world units along two tangents.
    Plane {
        /// A point on it.
        point: DVec3,
        /// Unit normal.
        normal: DVec3,
    },
    /// Axis-aligned, closed, normals outward.
    Cuboid {
        /// Least corner.
        min: DVec3,
        /// Greatest corner, greater than `min` in every coordinate.
        max: DVec3,
    },
    /// Triangles.
    Mesh(Mesh),
    /// Bezier profiles turned about the local y axis:
    /// `S(theta, t) = (r(t) cos theta, y(t), r(t) sin theta)`.
    Revolution {
        /// Control points (radius, height) of each Bezier segment, degree 1 to 15; each segment
        /// starts where the one before ends. The curve's radius is nowhere negative.
        segments: Vec<Vec<DVec2>>,
        /// World from object.
        transform: Transform,
        /// Newton steps shorter than this, in sizes of the profile, end the search of a ray's hit;
        /// 0, which scene files mean, goes on as far as the precision allows.
        newton_tolerance: f64,
    },
}

/// Triangles in world space with separate indices for positions, normals and texture coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in scene units.
    pub positions: Vec<DVec3>,
    /// Unit shading normals.
    pub normals: Vec<DVec3>,
    /// Texture coordinates; v = 0 is an image's bottom row.
    pub uvs: Vec<DVec2>,
    /// Faces of positive area, counter-clockwise seen from outside.
    pub triangles: Vec<Triangle>,
}

/// Indices of a triangle's corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Into [`Mesh::positions`].
    pub position: [u32; 3],
    /// Into [`Mesh::normals`]; `None` is flat.
    pub normal: Option<[u32; 3]>,
    /// Into [`Mesh::uvs`]; `None` reads textures at (0, 0).
    pub uv: Option<[u32; 3]>,
}

/// World from object: scale, then rotate, then translate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Uniform scale, > 0.
    pub scale: f64,
    /// A rotation (orthonormal, determinant one).
    pub rotation: DMat3,
    /// In scene units.
    pub translation: DVec3,
}

impl Transform {
    /// Changes nothing.
    pub const IDENTITY: Self =
        Self { scale: 1.0, rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// A point of the object, in the world.
    pub fn point(&self, point: DVec3) -> DVec3 {
        self.rotation * (point * self.scale) + self.translation
    }

    /// A direction or unit normal of the object, in the world; keeps lengths.
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }
}
