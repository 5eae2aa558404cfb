//! Packed scene: plain data that the kernels of both engines read, in scene space (the host moves
//! the scene's centre to the origin and scales its size to about one; see
//! [`crate::prepare::normalize`]).
//!
//! Each struct is the twin of the WGSL struct of the same name in `shaders/tables.wgsl`; a test
//! compares the layouts by name. The short tables share one storage buffer, `scene`; each long
//! table has a separate buffer.

use super::real::{Bits, Plain, Real, Vec2, Vec3, Vec4};
use super::shapes::simd4::{FourRectangles, FourSpheres};
use bytemuck::Zeroable;

pub use super::shapes::instance::{Group, Instance};
pub use super::shapes::kdtree::Node;
pub use super::shapes::outline::Outline;
pub use super::shapes::revolution::{Patch, Revolution};
pub use super::shapes::table::*;
pub use super::shapes::triangle::Triangle;

/// Medium of a lens or lamp that lies partly in glass: kernels determine it for each point.
pub const ASTRIDE: u32 = 0xffff_fffe;

/// Properties of the whole scene.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct World {
    /// Least corner of the kd-tree's bounding box.
    pub bounds_min: Vec3,
    /// World units per scene unit.
    pub unit: Real,
    /// Greatest corner of the kd-tree's bounding box.
    pub bounds_max: Vec3,
    /// Radius of the sphere about `near_center` that contains most of what the camera sees, scene
    /// units.
    pub near_radius: Real,
    /// Centre of what the camera sees, and of the emission discs.
    pub near_center: Vec3,
    /// Radius of the narrowest emission disc, scene units.
    pub disc_radius: Real,
    /// Number of lights.
    pub light_count: u32,
    /// Index of the light that rays hit when they leave the scene, or [`NONE`].
    pub environment: u32,
    /// Number of shapes outside the kd-tree (planes and huge spheres), which are tested against
    /// every ray.
    pub unbounded_count: u32,
    /// Number of emission discs for light from infinity, with radii `disc_radius * 2^k` for k below
    /// this; 0 without such light.
    pub disc_levels: u32,
    /// First entry in `distributions` of the cumulative probabilities of the emission discs.
    pub disc_first: u32,
    /// 1 if light from infinity reaches surfaces farther than twice `near_radius`, else 0.
    pub far: u32,
    /// 1 if bodies of glass may touch or contain one another, else 0.
    pub nested: u32,
    /// 1 if some light has a guide map (see `lights::guide`), else 0.
    pub guided: u32,
    /// See [`Tree::primitive_size`](super::shapes::kdtree::Tree::primitive_size).
    pub primitive_size: Real,
    /// Index of the first material that belongs to a glass body.
    pub body_first: u32,
    /// Number of materials that belong to glass bodies.
    pub body_count: u32,
    /// Index of the first sun with an angular size, or [`NONE`]; [`Light::reference`] continues the
    /// list.
    pub sun_discs: u32,
}

/// Camera: projection, lens and pixel filter.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Camera {
    /// Centre of the lens, scene space. Orthographic: centre of the image's window.
    pub position: Vec3,
    /// Lens radius, scene units; 0 for a pinhole.
    pub aperture: Real,
    /// Vector to the right, half the image's width: at distance one, orthographic in scene units,
    /// fisheye in radians.
    pub right: Vec3,
    /// Focus distance along `forward`, scene units. Fisheye: greatest angle from `forward`,
    /// radians.
    pub focus: Real,
    /// Vector upward, half the image's height, likewise.
    pub up: Vec3,
    /// Height of a pixel at distance one; orthographic: in scene units.
    pub pixel: Real,
    /// Unit view direction.
    pub forward: Vec3,
    /// Image width in pixels.
    pub width: u32,
    /// Unit vector to the right, in the lens.
    pub lens_right: Vec3,
    /// Image height in pixels.
    pub height: u32,
    /// Unit vector upward, in the lens.
    pub lens_up: Vec3,
    /// Medium of the lens: a glass material index, [`NONE`] or [`ASTRIDE`].
    pub medium: u32,
    /// Perspective: vector to the centre of the image at distance one, `forward` plus the shift.
    pub center: Vec3,
    /// Number of its [`ProjectionKind`](super::camera::ProjectionKind).
    pub projection: u32,
    /// Number of its pixel filter's [`FilterKind`](super::math::pixel_filter::FilterKind).
    pub filter_kind: u32,
    /// Box and tent: half the width in pixels. Gaussian: standard deviation in pixels. Mitchell:
    /// integral of the absolute value of six times the filter from 0 to 2.
    pub filter_size: Real,
    /// Gaussian: fraction inside the circle. Mitchell: parameter B.
    pub filter_b: Real,
    /// Mitchell: parameter C.
    pub filter_c: Real,
}

/// Material parameters.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Material {
    /// Reflectance, in [0, 1]; at normal incidence for metal. Mix, opacity and graded: the amount,
    /// as the mean of the channels. Thin glass: transmittance. For an open glass sheet its unit
    /// mean normal; zero for closed glass.
    pub reflectance: Vec3,
    /// Number of its [`Bsdf`](super::materials::Bsdf).
    pub kind: u32,
    /// Glass: absorption coefficient, per scene unit.
    pub absorption: Vec3,
    /// Glass, plastic: index of refraction relative to the outside. Opacity: cutoff of a mask, or
    /// 0. Graded: the amount of the first material. Brushed metal: GGX alpha along v.
    pub ior: Real,
    /// Index of the texture that replaces `reflectance`, or [`NONE`].
    pub texture: u32,
    /// Microfacet lobes: GGX alpha, `roughness^2`; 0 for a smooth coat. Rough diffuse: roughness.
    /// Translucent: fraction transmitted. Graded: number of materials per unit of the amount.
    pub alpha: Real,
    /// World (x, z) of the scene's origin, where planar uv starts, modulo the texture's period.
    pub planar_origin: Vec2,
    /// Conductor: index of refraction relative to the outside, per channel. Rough glass: lowest
    /// coefficients of the polynomial `albedo` from inside; `k` and `mean_fresnel` hold the others.
    pub eta: Vec3,
    /// Mix, opacity, graded: index of the first material; two-sided: that of the front. Plastic: 1
    /// if light takes on the base's color at each reflection inside, else 0. Brushed metal: 1 for
    /// the exact Fresnel term.
    pub first: u32,
    /// Conductor: extinction coefficient relative to the outside, per channel.
    pub k: Vec3,
    /// Mix: index of the second material; two-sided: that of the back. Graded: number of materials
    /// after the first.
    pub second: u32,
    /// Microfacet lobes: mean over the hemisphere of the Fresnel reflectance (conductor).
    pub mean_fresnel: Vec3,
    /// Microfacet lobes: mean over the hemisphere of the polynomial `albedo`; 1 if no light needs
    /// to be added (see `materials::albedo`).
    pub mean_albedo: Real,
    /// Microfacet lobes: coefficients of the polynomial in the cosine that gives the fraction of
    /// light that is scattered once; coats: that is reflected. Lowest power first.
    pub albedo_low: Vec4,
    /// The coefficients of the higher powers.
    pub albedo_high: Vec4,
    /// Layered materials: 1 if photons are stored, because one of the materials is rough.
    pub stores: u32,
    /// 1 if the material, or one that it consists of, has a texture.
    pub textured: u32,
    /// Index of the texture that gives the shading normal, or [`NONE`].
    pub normal_map: u32,
    /// Factor on the first two components of that normal.
    pub normal_strength: Real,
    /// Index of the texture that gives the height of bumps, or [`NONE`].
    pub bump_map: u32,
    /// Height of a texel of value 1, scene units.
    pub bump_height: Real,
    /// 1 if one of the two textures bends the shading normal.
    pub bent: u32,
    /// Index of refraction of the outside over that of a clear coat above the material; 0 without.
    pub coated: Real,
}

impl Material {
    /// Black material without a texture.
    pub const EMPTY: Self = Self {
        reflectance: Vec3::ZERO,
        kind: 0,
        absorption: Vec3::ZERO,
        ior: 1.0,
        texture: NONE,
        alpha: 0.0,
        planar_origin: Vec2::ZERO,
        eta: Vec3::ONE,
        first: NONE,
        k: Vec3::ZERO,
        second: NONE,
        mean_fresnel: Vec3::ONE,
        mean_albedo: 1.0,
        albedo_low: Vec4::new(1.0, 0.0, 0.0, 0.0),
        albedo_high: Vec4::ZERO,
        stores: 0,
        textured: 0,
        normal_map: NONE,
        normal_strength: 1.0,
        bump_map: NONE,
        bump_height: 0.0,
        bent: 0,
        coated: 0.0,
    };
}

/// Texture kind: checkerboard of unit cells in two colours.
pub const TEXTURE_CHECKER: u32 = 0;
/// Texture kind: image.
pub const TEXTURE_IMAGE: u32 = 1;
/// Texture kind: image laid as staggered floor boards.
pub const TEXTURE_PLANKS: u32 = 2;
/// Texture flag: nearest texel instead of bilinear filtering.
pub const TEXTURE_NEAREST: u32 = 1;
/// Texture flag: clamp u to the edge instead of repeating.
pub const TEXTURE_CLAMP_U: u32 = 2;
/// Texture flag: clamp v to the edge instead of repeating.
pub const TEXTURE_CLAMP_V: u32 = 4;
/// Texel format: one word, RGBA8 decoded by the sRGB table at the start of `texels`.
pub const TEXELS_SRGB8: u32 = 0;
/// Texel format: one word, linear RGBA8.
pub const TEXELS_LINEAR8: u32 = 1;
/// Texel format: three words, f32.
pub const TEXELS_FLOAT: u32 = 2;

/// Texture, evaluated at `scale * (u, v)`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Texture {
    /// Factor on (u, v); for planks the reciprocal size of a board.
    pub scale: Vec2,
    /// One of `TEXTURE_CHECKER`, `TEXTURE_IMAGE`, `TEXTURE_PLANKS`.
    pub kind: u32,
    /// Sum of `TEXTURE_NEAREST`, `TEXTURE_CLAMP_U` and `TEXTURE_CLAMP_V`.
    pub flags: u32,
    /// Index of the image's first word in `texels`.
    pub first: u32,
    /// Image width in texels.
    pub width: u32,
    /// Image height in texels; the top row is first.
    pub height: u32,
    /// One of `TEXELS_*`.
    pub format: u32,
    /// Checker: colour of cell (0, 0).
    pub color0: Vec3,
    /// Padding to 16 bytes.
    pub pad0: u32,
    /// Checker: the other colour.
    pub color1: Vec3,
    /// Padding to 16 bytes.
    pub pad1: u32,
}

/// Light source.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Light {
    /// Radiance (area, sun disc, constant: W sr^-1 m^-2; image: factor), intensity (point, spot:
    /// W/sr) or irradiance (sun: W m^-2), all in scene units.
    pub color: Vec3,
    /// Number of its [`LightKind`](super::lights::LightKind).
    pub kind: u32,
    /// Point and spot: position in scene space. Tilted image: its x axis.
    pub position: Vec3,
    /// Probability that a photon starts at this light.
    pub selection: Real,
    /// Spot and suns: unit direction in which light travels. Tilted image: its y axis.
    pub direction: Vec3,
    /// Area: area of the shape, square scene units.
    pub area: Real,
    /// Area: reference of the shape. Image: index of the texture. Sun disc: index of the next sun
    /// disc, or [`NONE`].
    pub reference: u32,
    /// First entry in `distributions`. Revolution: start of each patch's part of v, then the
    /// cumulative area fraction by patch. Image: cumulative probabilities of the rows, then those
    /// of the columns of each row.
    pub first: u32,
    /// Spot and sun disc: 1 - cos of the outer cone's half-angle, which f32 represents accurately
    /// even for narrow cones. Image: cosine of the rotation about y.
    pub outer: Real,
    /// Spot: 1 - cos of the inner cone's half-angle, up to which the intensity is full. Image: sine
    /// of the rotation.
    pub inner: Real,
    /// Revolution: index of its first patch.
    pub patch_first: u32,
    /// Revolution: number of its patches. Image: 1 if it is tilted (see `lights::image`), else 0.
    pub patch_count: u32,
    /// Medium of a lamp: a glass material index, [`NONE`] or [`ASTRIDE`].
    pub medium: u32,
    /// First entry in `distributions` of its guide map (see `lights::guide`), or 0.
    pub guide: u32,
}

/// Node of the tree over space whose leaves have separate probabilities of the lights for shadow
/// rays.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Cell {
    /// Coordinate of the splitting plane; 0 in a leaf.
    pub split: Real,
    /// Axis of the splitting plane, 0 to 2; 3 marks a leaf.
    pub axis: u32,
    /// Index of the child below the plane, which the child above follows; in a leaf the first entry
    /// in `distributions` of the cumulative probabilities of the lights.
    pub first: u32,
    /// Padding to 16 bytes.
    pub pad: u32,
}

/// Packed scene.
#[derive(Clone, Debug)]
pub struct SceneTables {
    /// Properties of the whole scene.
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
    /// Patches of the surfaces of revolution, which kd-tree leaves refer to.
    pub patches: Vec<Patch>,
    /// Control points of the patches.
    pub profile_points: Vec<Vec2>,
    /// Placed groups.
    pub instances: Vec<Instance>,
    /// Groups of shapes; their shapes, nodes and references follow those of the scene.
    pub groups: Vec<Group>,
    /// References of the shapes outside the kd-tree.
    pub unbounded: Vec<u32>,
    /// Materials.
    pub materials: Vec<Material>,
    /// Textures.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Cumulative distributions: first the choice of a photon's light, then those of
    /// [`Light::first`], then those learned from pilot photons.
    pub distributions: Vec<Real>,
    /// Tree of the light probabilities for shadow rays; empty if there is at most one light.
    pub cells: Vec<Cell>,
    /// Nodes of the kd-tree.
    pub nodes: Vec<Node>,
    /// References in the order of the kd-tree's leaves.
    pub refs: Vec<u32>,
    /// Triangles.
    pub triangles: Vec<Triangle>,
    /// Vertex attributes of the triangles that have any.
    pub attributes: Vec<Attributes>,
    /// Outlines of flat shapes.
    pub outlines: Vec<Outline>,
    /// Rectangles packed in fours, for the CPU engine only; if absent, they are tested one at a
    /// time.
    pub four_rectangles: Vec<FourRectangles>,
    /// Spheres packed in fours, likewise.
    pub four_spheres: Vec<FourSpheres>,
    /// Texels of the images. If any image is stored as sRGB, the first 256 words are the sRGB
    /// decoding table.
    pub texels: Vec<Bits>,
}
