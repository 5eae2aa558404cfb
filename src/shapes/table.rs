//! Shapes as kernels read them, and references to them. Lengths are scene units.
//! Twin: `shaders/shapes/table.wgsl`; a test compares the layouts by name.

use super::real::{Plain, Real, Vec3};
use bytemuck::Zeroable;

/// Index that means "none".
pub const NONE: u32 = 0xffff_ffff;
/// Number of low bits of a reference that store the index; the bits above store the kind.
pub const REFERENCE_BITS: u32 = 28;
/// Kind of a reference, which a kd-tree leaf or an area light stores: see
/// [`Triangle`](super::triangle::Triangle).
pub const KIND_TRIANGLE: u32 = 0;
/// See [`Sphere`].
pub const KIND_SPHERE: u32 = 1;
/// See [`Rectangle`].
pub const KIND_RECTANGLE: u32 = 2;
/// See [`Disc`].
pub const KIND_DISC: u32 = 3;
/// See [`Cuboid`].
pub const KIND_CUBOID: u32 = 4;
/// See [`Patch`](super::revolution::Patch); for lights the index is that of the
/// [`Revolution`](super::revolution::Revolution).
pub const KIND_REVOLUTION: u32 = 5;
/// See [`Plane`].
pub const KIND_PLANE: u32 = 6;
/// See [`Instance`](super::instance::Instance).
pub const KIND_INSTANCE: u32 = 7;

/// Packs a reference from its kind and index.
pub const fn reference(kind: u32, index: usize) -> u32 {
    kind << REFERENCE_BITS | index as u32
}

/// Kind of the shape that a reference points at, one of `KIND_*`.
#[inline]
pub const fn kind_of(reference: u32) -> u32 {
    reference >> REFERENCE_BITS
}

/// Index of the shape that a reference points at, among the shapes of its kind.
#[inline]
pub const fn index_of(reference: u32) -> u32 {
    reference & ((1 << REFERENCE_BITS) - 1)
}

/// `(u, v)` are the shape's own parameters.
pub const UV_NATURAL: u32 = 0;
/// `(u, v)` are the world coordinates (x, z).
pub const UV_PLANAR: u32 = 1;
/// Like [`UV_NATURAL`], for a closed profile: v wraps around.
pub const UV_LOOP: u32 = 2;

/// Sphere given by a surface point `anchor` and the outward normal there: accurate in f32 for any
/// radius.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Sphere {
    /// Point of the sphere nearest to the scene's centre.
    pub anchor: Vec3,
    /// Curvature, `1 / radius`, per scene unit.
    pub curvature: Real,
    /// Outward unit normal at the anchor.
    pub normal: Vec3,
    /// Radius, scene units.
    pub radius: Real,
    /// Material index.
    pub material: u32,
    /// Light index or [`NONE`].
    pub light: u32,
    /// [`UV_NATURAL`] or [`UV_PLANAR`].
    pub uv: u32,
    /// Padding to 16 bytes.
    pub pad: u32,
}

/// Parallelogram `origin + s u + t v`, s and t in [0, 1].
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Rectangle {
    /// Corner at s = t = 0.
    pub origin: Vec3,
    /// Material index.
    pub material: u32,
    /// Unit normal along `u x v`.
    pub normal: Vec3,
    /// Light index or [`NONE`].
    pub light: u32,
    /// First edge.
    pub u: Vec3,
    /// [`UV_NATURAL`] or [`UV_PLANAR`].
    pub uv: u32,
    /// Second edge.
    pub v: Vec3,
    /// Area, square scene units.
    pub area: Real,
    /// In-plane vector with `dual_u . u = 1` and `dual_u . v = 0`.
    pub dual_u: Vec3,
    /// Index of its outline.
    pub outline: u32,
    /// In-plane vector with `dual_v . v = 1` and `dual_v . u = 0`.
    pub dual_v: Vec3,
    /// Padding to 16 bytes.
    pub pad: u32,
}

/// Flat disc.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Disc {
    /// Centre.
    pub center: Vec3,
    /// Radius, scene units.
    pub radius: Real,
    /// Unit normal.
    pub normal: Vec3,
    /// Material index.
    pub material: u32,
    /// Light index or [`NONE`].
    pub light: u32,
    /// [`UV_NATURAL`] or [`UV_PLANAR`].
    pub uv: u32,
    /// Index of its outline.
    pub outline: u32,
    /// Padding to 16 bytes.
    pub pad: u32,
}

/// Axis-parallel box.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Cuboid {
    /// Least corner.
    pub lower: Vec3,
    /// Material index.
    pub material: u32,
    /// Greatest corner.
    pub upper: Vec3,
    /// Light index or [`NONE`].
    pub light: u32,
    /// [`UV_NATURAL`] (each face is the unit square) or [`UV_PLANAR`].
    pub uv: u32,
    /// Index of the outline of the faces perpendicular to x; those for y and z follow.
    pub outline: u32,
    /// Padding to 16 bytes.
    pub pad: [u32; 2],
}

/// Infinite plane.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Plane {
    /// Point of the plane nearest to the scene's centre.
    pub point: Vec3,
    /// Material index.
    pub material: u32,
    /// Unit normal.
    pub normal: Vec3,
    /// [`UV_NATURAL`] (world units along the tangents) or [`UV_PLANAR`].
    pub uv: u32,
    /// First tangent; its length is the number of world units per scene unit.
    pub tangent: Vec3,
    /// u at `point`.
    pub u0: Real,
    /// Second tangent; its length is the number of world units per scene unit.
    pub bitangent: Vec3,
    /// v at `point`.
    pub v0: Real,
    /// Index of its outline if walls stand on it, or [`NONE`].
    pub outline: u32,
    /// Padding to 16 bytes.
    pub pad: [u32; 3],
}

/// Normals and texture coordinates of a triangle's vertices.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Attributes {
    /// Unit normal at `p0`.
    pub n0: Vec3,
    /// u at `p0`.
    pub u0: Real,
    /// Unit normal at `p1`.
    pub n1: Vec3,
    /// v at `p0`.
    pub v0: Real,
    /// Unit normal at `p2`.
    pub n2: Vec3,
    /// u at `p1`.
    pub u1: Real,
    /// v at `p1`.
    pub v1: Real,
    /// u at `p2`.
    pub u2: Real,
    /// v at `p2`.
    pub v2: Real,
    /// Bit 0: set if vertex normals are interpolated. Other bits: one plus the index of the outline
    /// of the flat region that the triangle is part of, or 0.
    pub outline_smooth: u32,
}
