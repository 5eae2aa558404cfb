//! Data that kernels pass to one another. Twin: `shaders/kernels/records.wgsl`.

use super::math::Direction;
use super::math::rng::Points;
use super::real::{Plain, Real, Vec3};
use bytemuck::Zeroable;

/// Parameters of one dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Dispatch {
    /// Index of the first item of this dispatch.
    pub first: u32,
    /// One past the index of its last item.
    pub end: u32,
    /// Pass number of the random numbers, from 0.
    pub pass_number: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Index of the chunk's first visible point among those of the image.
    pub chunk_first: u32,
    /// Index of the batch's first photon among those of the pass.
    pub batch_first: u32,
    /// Number of low bits of a record's key that store the bounce and the class.
    pub key_bits: u32,
    /// Capacity of the record buffers.
    pub capacity: u32,
    /// Greatest number of scattering events on a path.
    pub max_bounces: u32,
    /// Visible points per pixel.
    pub eye_samples: u32,
    /// Number of grid buckets, a power of two, less one.
    pub mask: u32,
    /// Reciprocal side length (along y and z) of a grid cell, per scene unit.
    pub inv_cell: Real,
    /// Squared radius of this pass over the squared start radius (fixed and global rules).
    pub scale_sq: Real,
    /// `M`, the number of photons emitted in a pass.
    pub photons: Real,
    /// `alpha` of the radius rule.
    pub alpha: Real,
    /// Start radius in pixel footprints; 0 if `radius_units` applies.
    pub radius_pixels: Real,
    /// Start radius in scene units if `radius_pixels` is 0.
    pub radius_units: Real,
    /// Greatest start radius, in scene units.
    pub radius_max: Real,
    /// Number of columns of the strata of a pixel's visible points.
    pub strata: u32,
    /// Number of passes that the film contains already.
    pub passes_done: u32,
    /// Number of photon classes with separate discs and grids: 1, or 2 if photons scattered by a
    /// diffuse surface use a wider disc.
    pub classes: u32,
    /// Radius of the second class's disc over that of the first.
    pub indirect_radius: Real,
    /// Reciprocal side length of the second class's cells.
    pub inv_cell_indirect: Real,
    /// First pixel of the render window, as an index into the full image.
    pub window_first: u32,
    /// Number of pixels per row of the window.
    pub window_width: u32,
    /// 1 if the passes share their visible points, else 0.
    pub fixed_points: u32,
    /// 0 if eye paths end at the first rough surface. Otherwise they continue at narrow lobes:
    /// [`CONTINUED`], plus [`FOCUSED`] if there may be such photons.
    pub continued: u32,
    /// Number of low bits of a record's key below the bounce: 1, or 2 if `continued`.
    pub bounce_shift: u32,
    /// Sobol point of the pass for the first dimensions of eye paths.
    pub points: Points,
}

/// Greatest number of hidden glass faces that a path may pass (see
/// [`super::materials::interior::passes_hidden`]); the path ends beyond it.
pub const HIDDEN_FACES: u32 = 256;

/// State bit: the driver stopped the kernel's loops, so the point must be traced again.
pub const STOPPED: u32 = 1;
/// State bit: the emission and environment along the eye path were not finite and are left out of
/// the radiance.
pub const BAD_EYE: u32 = 2;
/// State bit: the sampled direct light was not finite and is left out of the radiance.
pub const BAD_DIRECT: u32 = 4;
/// State bit: the point gathers only [`FOCUSED`] photons; continued paths find the other light.
pub const ONLY_FOCUSED: u32 = 8;

/// Bit of [`Dispatch::continued`]: eye paths continue at narrow lobes.
pub const CONTINUED: u32 = 1;
/// Bit of [`Dispatch::continued`] and of a record's key: only specular surfaces have scattered the
/// photon, and its light has no extent, so that scattered rays cannot find it.
pub const FOCUSED: u32 = 2;

/// Number of bits for the lobe's kind in [`VisiblePoint::bsdf`].
pub const BSDF_BITS: u32 = 8;

/// First non-specular hit of an eye path.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct VisiblePoint {
    /// Position in scene space.
    pub position: Vec3,
    /// Start radius in scene units; 0 if the eye path ends without a visible point.
    pub radius: Real,
    /// Throughput; for diffuse surfaces multiplied by the BRDF.
    pub weight: Vec3,
    /// Geometric normal on the viewer's side.
    pub normal: Direction,
    /// Emission, environment and sampled direct light along the path, times throughput.
    pub radiance: Vec3,
    /// Shading normal on the viewer's side.
    pub shading: Direction,
    /// Reflectance of the lobe, unless it is diffuse.
    pub reflectance: Vec3,
    /// Width of the lobe (roughness alpha), unless it is diffuse.
    pub alpha: Real,
    /// Direction to the viewer, unless the lobe is diffuse.
    pub wo: Direction,
    /// Index of the outline that contains the point, or `NONE`.
    pub outline: u32,
    /// Sum of [`STOPPED`], [`BAD_EYE`], [`BAD_DIRECT`] and [`ONLY_FOCUSED`].
    pub state: u32,
    /// Number of the lobe's [`Bsdf`](super::materials::Bsdf) in the lowest [`BSDF_BITS`] bits;
    /// above them the index of the material, if the gather reads its parameters.
    pub bsdf: u32,
}

/// Photon stored at a non-specular hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct PhotonRecord {
    /// Position in scene space.
    pub position: Vec3,
    /// (photon within the batch, bounce, [`FOCUSED`] bit, class): the order of summation. On the
    /// GPU the cell's code replaces it once the record is sorted.
    pub key: u32,
    /// Flux in W, times the number of photons in the pass.
    pub flux: Vec3,
    /// Direction that the photon came from.
    pub direction: Direction,
}

/// Sums over the photons that a visible point gathered in one pass.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Gathered {
    /// Sum of weight times BRDF times flux.
    pub flux: Vec3,
    /// Number of photons inside the disc, on the right side of the surface.
    pub count: u32,
    /// Part of `flux` from photons of the first class, if there are two.
    pub caustic: Vec3,
    /// Luminance of `flux` less that of the estimate from the inner half of the disc's area; for an
    /// unclipped disc, the outer half's flux less the inner half's.
    pub bias_probe: Real,
}

/// Statistics of the local rule for a pixel (SPPM) or a visible point (PPM), with radii relative to
/// the start radius.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Statistics {
    /// `R^2` over the squared start radius, before subtraction of `drop`; 0 in zeroed memory stands
    /// for 1.
    pub scale_sq: Real,
    /// Decrease of `R^2` not yet subtracted from `scale_sq`: accumulates small terms that rounding
    /// would lose.
    pub drop: Real,
    /// Number of photons so far, low word; `N = alpha` times this count.
    pub count_low: u32,
    /// Number of photons so far, high word.
    pub count_high: u32,
}

/// Reason for rejecting a pass, an index: emission or environment along the eye path.
pub const REJECTED_EYE: u32 = 0;
/// Reason for rejecting a pass: sampled direct light.
pub const REJECTED_DIRECT: u32 = 1;
/// Reason for rejecting a pass: gathered photons.
pub const REJECTED_PHOTONS: u32 = 2;
/// Reason for rejecting a pass: the estimate, although its parts were finite.
pub const REJECTED_ESTIMATE: u32 = 3;
/// The pass is accepted.
pub const ACCEPTED: u32 = 4;

/// Running estimate of a pixel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct FilmPixel {
    /// Mean over the passes, in W sr^-1 m^-2 of scene units, without `carry`.
    pub mean: Vec3,
    /// Mean square of the passes' luminance deviations (see [`super::resolve::fold`]).
    pub spread: Real,
    /// Change of the mean not yet added to `mean`: accumulates small terms that rounding would
    /// lose.
    pub carry: Vec3,
    /// Luminance of the mean over the first 2^k passes, 2^k the greatest power of two below the
    /// number of passes.
    pub mean_at_pow2: Real,
    /// Number of passes rejected because a value was not finite, by reason: see `REJECTED_*`.
    pub rejected: [u32; 4],
    /// Mean over the passes of the luminance of the estimate from the whole disc less that from the
    /// inner half of its area.
    pub bias_probe: Real,
    /// The same mean with the sign of odd passes flipped.
    pub bias_probe_alternating: Real,
    /// Mean over the passes of the luminance difference between two halves of the eye samples,
    /// scaled so that its square is the variance of the mean over all samples.
    pub halves: Real,
    /// Luminance of the mean over the first 2^(k-1) passes.
    pub mean_at_half_pow2: Real,
}
