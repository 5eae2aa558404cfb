//! Shapes as kernels read them, and references to them. Lengths are scene units.
//! Twin: `shaders/shapes/table.wgsl`; a test compares the layouts by name.

use super::real::{Plain, Real, Vec3};
use bytemuck::Zeroable;

/// "No such index".
pub const NONE: u32 = 0xffff_ffff;
/// Number of low bits of a reference that hold the index; the bits above hold the kind.
pub const REFERENCE_BITS: u32 = 28;
/// Reference kinds: what a leaf of the kd-tree or an area light points at.
pub const KIND_TRIANGLE: u32 = 0;
/// See [`Sphere`].
pub const KIND_SPHERE: u32 = 1;
/// See [`Rectangle`].
pub const KIND_RECTANGLE: u32 = 2;
/// See [`Disc`].
pub const KIND_DISC: u32 = 3;
/// See [`Cuboid`].
pub const KIND_CUBOID: u32 = 4;
/// See [`Patch`](super::revolution::Patch); for lights the index is that of the [`Revolution`](super::revolution::Revolution).
pub const KIND_REVOLUTION: u32 = 5;
/// See [`Plane`].
pub const KIND_PLANE: u32 = 6;

/// A reference from its kind and index.
pub const fn reference(kind: u32, index: usize) -> u32 {
    kind << REFERENCE_BITS | index as u32
}

/// Kind of the shape that a reference points at, one of `KIND_*`.
#[inline]
pub fn kind_of(reference: u32) -> u32 {
    reference >> REFERENCE_BITS
}

/// Index of the shape that a reference points at, among the shapes of its kind.
#[inline]
pub fn index_of(reference: u32) -> u32 {
    reference & ((1 << REFERENCE_BITS) - 1)
}

/// `(u, v)` is the shape's own.
pub const UV_NATURAL: u32 = 0;
/// `(u, v)` is world (x, z).
pub const UV_PLANAR: u32 = 1;
/// The same as [`UV_NATURAL`], of a profile that ends where it begins: v goes on there.
pub const UV_LOOP: u32 = 2;

/// A sphere through `anchor` with outward normal `normal` there: exact in f32 for any radius.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Sphere {
    /// The point of the sphere nearest to the scene's middle.
    pub anchor: Vec3,
    /// `k = 1 / radius`.
    pub curvature: Real,
    /// Outward unit normal at the anchor.
    pub normal: Vec3,
    /// Radius.
    pub radius: Real,
    /// Material index.
    pub material: u32,
    /// Light index or [`NONE`].
    pub light: u32,
    /// [`UV_NATURAL`] or [`UV_PLANAR`].
    pub uv: u32,
    /// Padding.
    pub pad: u32,
}

/// A parallelogram `origin + s u + t v`, s and t in [0, 1].
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Rectangle {
    /// Corner.
    pub origin: Vec3,
    /// Material index.
    pub material: u32,
    /// Unit normal, along `u x v`.
    pub normal: Vec3,
    /// Light index or [`NONE`].
    pub light: u32,
    /// First edge.
    pub u: Vec3,
    /// [`UV_NATURAL`] or [`UV_PLANAR`].
    pub uv: u32,
    /// Second edge.
    pub v: Vec3,
    /// Area.
    pub area: Real,
    /// In-plane vector with `dual_u . u = 1` and `dual_u . v = 0`.
    pub dual_u: Vec3,
    /// Its outline among the outlines.
    pub outline: u32,
    /// In-plane vector with `dual_v . v = 1` and `dual_v . u = 0`.
    pub dual_v: Vec3,
    /// Padding.
    pub pad: u32,
}

/// A flat disc.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Disc {
    /// Centre.
    pub center: Vec3,
    /// Radius.
    pub radius: Real,
    /// Unit normal.
    pub normal: Vec3,
    /// Material index.
    pub material: u32,
    /// Light index or [`NONE`].
    pub light: u32,
    /// [`UV_NATURAL`] or [`UV_PLANAR`].
    pub uv: u32,
    /// Its outline among the outlines.
    pub outline: u32,
    /// Padding.
    pub pad: u32,
}

/// An axis-parallel box.
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
    /// The outline of the faces across x among the outlines; those across y and z follow.
    pub outline: u32,
    /// Padding.
    pub pad: [u32; 2],
}

/// An infinite plane.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Plane {
    /// The plane's point nearest to the scene's middle.
    pub point: Vec3,
    /// Material index.
    pub material: u32,
    /// Unit normal.
    pub normal: Vec3,
    /// [`UV_NATURAL`] (world units along the tangents) or [`UV_PLANAR`].
    pub uv: u32,
    /// First tangent, in world units per scene unit.
    pub tangent: Vec3,
    /// u at `point`.
    pub u0: Real,
    /// Second tangent, in world units per scene unit.
    pub bitangent: Vec3,
    /// v at `point`.
    pub v0: Real,
    /// Its outline among the outlines where walls stand on it, or [`NONE`].
    pub outline: u32,
    /// Padding.
    pub pad: [u32; 3],
}

/// Smooth normals and texture coordinates of a triangle's corners.
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
    /// Bit 0: whether corner normals are interpolated. The rest: one plus the outline of the flat
    /// region that the triangle is part of, or 0.
    pub outline_smooth: u32,
}
