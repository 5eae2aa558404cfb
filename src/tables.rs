//! The flattened scene: plain data that the kernels of both engines read, in scene space (the host
//! has moved the scene to its own centre and scaled it near one; see [`crate::prepare::normalize`]).
//!
//! Each struct is the twin of the WGSL struct of the same name in `shaders/tables.wgsl`; a test
//! compares the layouts by name. The short tables travel in one storage buffer, `scene`; the long
//! ones have their own.

use super::real::{Bits, Plain, Real, Vec2, Vec3};
use super::shapes::simd4::{FourRectangles, FourSpheres};
use bytemuck::Zeroable;

pub use super::shapes::kdtree::Node;
pub use super::shapes::outline::Outline;
pub use super::shapes::revolution::{Patch, Revolution};
pub use super::shapes::table::*;
pub use super::shapes::triangle::Triangle;

/// Medium that the kernels determine for each point.
pub const ASTRIDE: u32 = 0xffff_fffe;

/// Facts about the scene as a whole.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct World {
    /// Least corner of the kd-tree's box.
    pub bounds_min: Vec3,
    /// World units in one scene unit.
    pub unit: Real,
    /// Greatest corner of the kd-tree's box.
    pub bounds_max: Vec3,
    /// Radius of the sphere about `near_center` that holds most of what the camera sees.
    pub near_radius: Real,
    /// Center of what the camera sees, and of the emission discs.
    pub near_center: Vec3,
    /// Radius of the narrowest emission disc.
    pub disc_radius: Real,
    /// Number of lights.
    pub light_count: u32,
    /// The light that rays which leave the scene meet, or [`NONE`].
    pub environment: u32,
    /// Shapes tested against every ray (planes and huge spheres).
    pub unbounded_count: u32,
    /// Emission discs for light from infinity: radius `disc_radius * 2^k`, k below this; 0 without
    /// such light.
    pub disc_levels: u32,
    /// First entry in `distributions` of the cumulative probabilities of the emission discs.
    pub disc_first: u32,
    /// 1 where light from infinity meets surfaces beyond twice `near_radius`, else 0.
    pub far: u32,
    /// 1 where bodies of glass may touch or hold one another, else 0.
    pub nested: u32,
    /// 1 where some light has a map of where its photons meet glass and mirrors, else 0.
    pub guided: u32,
    /// See [`Tree::primitive_size`](super::shapes::kdtree::Tree::primitive_size).
    pub primitive_size: Real,
    /// Index of the first material that belongs to a glass body.
    pub body_first: u32,
    /// Number of such materials.
    pub body_count: u32,
    /// Padding.
    pub pad: u32,
}

/// Pinhole or thin-lens camera.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Camera {
    /// Centre of the lens.
    pub position: Vec3,
    /// Lens radius; 0 is a pinhole.
    pub aperture: Real,
    /// Half the picture's width at distance one, to the right.
    pub right: Vec3,
    /// Distance in focus along `forward`.
    pub focus: Real,
    /// Half the picture's height at distance one, upward.
    pub up: Vec3,
    /// A pixel's height at distance one.
    pub pixel: Real,
    /// Unit view direction.
    pub forward: Vec3,
    /// Pixels per row.
    pub width: u32,
    /// Unit vector to the right.
    pub lens_right: Vec3,
    /// Rows.
    pub height: u32,
    /// Unit vector upward.
    pub lens_up: Vec3,
    /// Medium of the lens: a glass material index, [`NONE`] or [`ASTRIDE`].
    pub medium: u32,
}

/// What a surface does with light.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Material {
    /// Reflectance, in [0, 1]; at normal incidence for metal. For an open glass sheet: its unit
    /// mean normal; zero for closed glass.
    pub reflectance: Vec3,
    /// The number of its [`Bsdf`](super::materials::Bsdf).
    pub kind: u32,
    /// Glass: absorption coefficient, per scene unit.
    pub absorption: Vec3,
    /// Glass: index of refraction against the outside.
    pub ior: Real,
    /// Texture that replaces `reflectance`, or [`NONE`].
    pub texture: u32,
    /// Metal: GGX width, `roughness^2`. Rough diffuse: roughness. Translucent: share transmitted.
    pub alpha: Real,
    /// World (x, z) of the origin, where planar uv starts, reduced by the texture's period.
    pub planar_origin: Vec2,
}

impl Material {
    /// A black material without a texture.
    pub const EMPTY: Self = Self {
        reflectance: Vec3::ZERO,
        kind: 0,
        absorption: Vec3::ZERO,
        ior: 1.0,
        texture: NONE,
        alpha: 0.0,
        planar_origin: Vec2::ZERO,
    };
}

/// Two colours in unit cells.
pub const TEXTURE_CHECKER: u32 = 0;
/// A picture.
pub const TEXTURE_IMAGE: u32 = 1;
/// A picture laid as staggered floor boards.
pub const TEXTURE_PLANKS: u32 = 2;
/// Nearest texel instead of bilinear.
pub const TEXTURE_NEAREST: u32 = 1;
/// Clamp to the edge instead of repeat.
pub const TEXTURE_CLAMP_U: u32 = 2;
/// The same of v: rows of the picture.
pub const TEXTURE_CLAMP_V: u32 = 4;
/// Texels are one word, RGBA8 coded through the sRGB table at the head of `texels`.
pub const TEXELS_SRGB8: u32 = 0;
/// Texels are one word, RGBA8 linear.
pub const TEXELS_LINEAR8: u32 = 1;
/// Texels are three words, f32.
pub const TEXELS_FLOAT: u32 = 2;

/// A texture, read at `scale * (u, v)`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Texture {
    /// Factor on (u, v); for planks one over the board's size.
    pub scale: Vec2,
    /// One of `TEXTURE_CHECKER`, `TEXTURE_IMAGE`, `TEXTURE_PLANKS`.
    pub kind: u32,
    /// Sum of `TEXTURE_NEAREST`, `TEXTURE_CLAMP_U` and `TEXTURE_CLAMP_V`.
    pub flags: u32,
    /// First word of the picture in `texels`.
    pub first: u32,
    /// Texels per row.
    pub width: u32,
    /// Rows, the top one first.
    pub height: u32,
    /// One of `TEXELS_*`.
    pub format: u32,
    /// Checker: colour of cell (0, 0).
    pub color0: Vec3,
    /// Padding.
    pub pad0: u32,
    /// Checker: the other colour.
    pub color1: Vec3,
    /// Padding.
    pub pad1: u32,
}

/// Emitting shape, Lambertian on the side of its normal.
pub const LIGHT_AREA: u32 = 0;
/// Isotropic point.
pub const LIGHT_POINT: u32 = 1;
/// Point with a cone.
pub const LIGHT_SPOT: u32 = 2;
/// Parallel light.
pub const LIGHT_SUN: u32 = 3;
/// The same radiance from everywhere.
pub const LIGHT_CONSTANT: u32 = 4;
/// Radiance from an equirectangular picture.
pub const LIGHT_IMAGE: u32 = 5;

/// A source of light.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Light {
    /// Radiance (area, constant: W sr^-1 m^-2; image: factor), intensity (point, spot: W/sr) or
    /// irradiance (sun: W m^-2), all in scene units.
    pub color: Vec3,
    /// One of `LIGHT_*`.
    pub kind: u32,
    /// Point and spot.
    pub position: Vec3,
    /// Probability that a photon starts here.
    pub selection: Real,
    /// Spot and sun: unit direction in which light travels.
    pub direction: Vec3,
    /// Area of the shape.
    pub area: Real,
    /// Area: the shape's reference; image: texture index.
    pub reference: u32,
    /// First entry in `distributions`: revolution: where each patch's part of v starts, then the
    /// cumulative share of the area by patch; image: cumulative rows, then each row's cumulative
    /// columns.
    pub first: u32,
    /// Spot: 1 - cos of the angle where it is dark, which f32 holds for narrow ones, too; image:
    /// cosine of the rotation about y.
    pub outer: Real,
    /// Spot: 1 - cos of the angle up to which it is full; image: sine of the rotation.
    pub inner: Real,
    /// Revolution: its first patch.
    pub patch_first: u32,
    /// Revolution: number of its patches.
    pub patch_count: u32,
    /// Medium of a lamp: a glass material index, [`NONE`] or [`ASTRIDE`].
    pub medium: u32,
    /// First entry in `distributions` of the map of where its photons meet glass and mirrors (see
    /// `lights::guide`), or 0.
    pub guide: u32,
}

/// A node of the tree over space in which each leaf has its own probabilities of the lights for
/// shadow rays.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Cell {
    /// Coordinate of the splitting plane; 0 in a leaf.
    pub split: Real,
    /// Axis of the splitting plane, 0 to 2; 3 marks a leaf.
    pub axis: u32,
    /// The child below the plane, the one above follows; in a leaf the first entry in
    /// `distributions` of the cumulative probabilities of the lights.
    pub first: u32,
    /// Padding.
    pub pad: u32,
}

/// The flattened scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Facts about the whole.
    pub world: World,
    /// The camera.
    pub camera: Camera,
    /// Spheres.
    pub spheres: Vec<Sphere>,
    /// Parallelograms.
    pub rectangles: Vec<Rectangle>,
    /// Discs.
    pub discs: Vec<Disc>,
    /// Boxes.
    pub cuboids: Vec<Cuboid>,
    /// Infinite planes.
    pub planes: Vec<Plane>,
    /// Surfaces of revolution.
    pub revolutions: Vec<Revolution>,
    /// Their patches, which the kd-tree points at.
    pub patches: Vec<Patch>,
    /// Their control points.
    pub profile_points: Vec<Vec2>,
    /// References of the shapes outside the kd-tree.
    pub unbounded: Vec<u32>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Cumulative distributions: first the light of a photon, then what `Light::first` points at,
    /// then what was learned from pilots.
    pub distributions: Vec<Real>,
    /// Where which light is chosen for shadow rays; empty where there is one light at most.
    pub cells: Vec<Cell>,
    /// kd-tree.
    pub nodes: Vec<Node>,
    /// References in the order of the kd-tree's leaves.
    pub refs: Vec<u32>,
    /// Triangles.
    pub triangles: Vec<Triangle>,
    /// Corners of the triangles that have any.
    pub attributes: Vec<Attributes>,
    /// Outlines of flat shapes.
    pub outlines: Vec<Outline>,
    /// The rectangles, four at a time: for the CPU alone, as are the spheres. Where they are
    /// missing, one at a time is taken.
    pub four_rectangles: Vec<FourRectangles>,
    /// The spheres, four at a time.
    pub four_spheres: Vec<FourSpheres>,
    /// Pictures; the first 256 words are the sRGB decoding table when any is stored so.
    pub texels: Vec<Bits>,
}
