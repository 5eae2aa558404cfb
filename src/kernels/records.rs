//! What kernels hand to one another. Twin: `shaders/kernels/records.wgsl`.

use super::math::Direction;
use super::math::rng::Points;
use super::real::{Plain, Real, Vec3};
use bytemuck::Zeroable;

/// Numbers of one dispatch.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Dispatch {
    /// First item of this dispatch.
    pub first: u32,
    /// One past its last item.
    pub end: u32,
    /// Pass number of the random numbers, from 0.
    pub pass_number: u32,
    /// Seed.
    pub seed: u32,
    /// First visible point of the chunk within the picture's.
    pub chunk_first: u32,
    /// First photon of the batch within the pass's.
    pub batch_first: u32,
    /// Low bits of a record's key that hold the bounce and the class.
    pub key_bits: u32,
    /// Records that the buffers hold.
    pub capacity: u32,
    /// Most scattering events on a path.
    pub max_bounces: u32,
    /// Visible points per pixel.
    pub eye_samples: u32,
    /// Number of buckets less one.
    pub mask: u32,
    /// One over the side length of a grid cell.
    pub inv_cell: Real,
    /// Squared radius of this pass over the squared start radius (fixed and global rules).
    pub scale_sq: Real,
    /// `M`, photons emitted in a pass, as a float.
    pub photons: Real,
    /// `alpha` of the radius rule.
    pub alpha: Real,
    /// Start radius in pixel footprints, or 0.
    pub radius_pixels: Real,
    /// Start radius in scene units where `radius_pixels` is 0.
    pub radius_units: Real,
    /// Greatest start radius, in scene units.
    pub radius_max: Real,
    /// Columns of the strata of a pixel's visible points.
    pub strata: u32,
    /// Passes that the film holds already.
    pub passes_done: u32,
    /// Classes of photons with a disc and a grid of their own: 1, or 2 where those that a diffuse
    /// surface has scattered have a wider disc.
    pub classes: u32,
    /// Radius of the second class over that of the first.
    pub indirect_radius: Real,
    /// One over the side length of the second class's cells.
    pub inv_cell_indirect: Real,
    /// First pixel of the window that is rendered, counted in the whole picture.
    pub window_first: u32,
    /// Pixels per row of the window.
    pub window_width: u32,
    /// Padding.
    pub pad: [u32; 3],
    /// The pass's point for the first dimensions of eye paths.
    pub points: Points,
}

/// Maximum number of hidden glass faces that a path passes (see
/// [`super::materials::interior::passes_hidden`]); it ends beyond that.
pub const HIDDEN_FACES: u32 = 256;

/// The driver stopped the kernel's loops: the point is to be found again.
pub const STOPPED: u32 = 1;
/// What the eye path met on its way was not finite; it is left out of the radiance.
pub const BAD_EYE: u32 = 2;
/// The sampled direct light was not finite; it is left out of the radiance.
pub const BAD_DIRECT: u32 = 4;

/// First non-specular hit of an eye path.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct VisiblePoint {
    /// In scene space.
    pub position: Vec3,
    /// Start radius in scene units; 0 where the eye path met nothing.
    pub radius: Real,
    /// Throughput; for diffuse surfaces times the BRDF.
    pub weight: Vec3,
    /// Geometric normal on the viewer's side.
    pub normal: Direction,
    /// Radiance met on the way: emission, environment and sampled direct light, times throughput.
    pub radiance: Vec3,
    /// Shading normal on the viewer's side.
    pub shading: Direction,
    /// Reflectance of the lobe, unless it is diffuse.
    pub reflectance: Vec3,
    /// Width of the lobe, unless it is diffuse.
    pub alpha: Real,
    /// Direction to the viewer, unless the lobe is diffuse.
    pub wo: Direction,
    /// The outline that it lies in, among the outlines, or `NONE`.
    pub outline: u32,
    /// Sum of [`STOPPED`], [`BAD_EYE`] and [`BAD_DIRECT`].
    pub state: u32,
    /// Number of the lobe's [`Bsdf`](super::materials::Bsdf).
    pub bsdf: u32,
}

/// A photon at a non-specular hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct PhotonRecord {
    /// In scene space.
    pub position: Vec3,
    /// (photon within the batch, bounce, class): the order of summation. On the GPU the cell's
    /// code stands here once the record is sorted.
    pub key: u32,
    /// Flux in W times the number of photons in the pass.
    pub flux: Vec3,
    /// Direction to where it came from.
    pub direction: Direction,
}

/// What a visible point gathered in one pass.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Gathered {
    /// Sum of weight times BRDF times flux.
    pub flux: Vec3,
    /// Photons inside the disc, on the right side of the surface.
    pub count: u32,
    /// The part of `flux` of the first of two classes.
    pub caustic: Vec3,
    /// Luminance of what the outer half of the disc's area holds of `flux`, less that of the inner
    /// half.
    pub bias_probe: Real,
}

/// Local rule: statistics of a pixel (SPPM) or visible point (PPM), with radii over the start
/// radius.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct Statistics {
    /// `R^2` over the squared start radius, less what `drop` still holds back; 0 in fresh memory
    /// stands for 1.
    pub scale_sq: Real,
    /// Decrease of `R^2` not yet taken from `scale_sq`: small terms are summed here first, so that
    /// they count.
    pub drop: Real,
    /// Photons so far, low word; `N = alpha` times this count.
    pub count_low: u32,
    /// Photons so far, high word.
    pub count_high: u32,
}

/// Causes of a rejected pass, as indices: what the eye path met, ...
pub const REJECTED_EYE: u32 = 0;
/// ... sampled direct light, ...
pub const REJECTED_DIRECT: u32 = 1;
/// ... gathered photons, ...
pub const REJECTED_PHOTONS: u32 = 2;
/// ... or the estimate, though each of its parts was finite.
pub const REJECTED_ESTIMATE: u32 = 3;
/// No cause: the pass counts.
pub const ACCEPTED: u32 = 4;

/// A pixel's estimate so far.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct FilmPixel {
    /// Mean over the passes, in W sr^-1 m^-2 of scene units, less what `carry` still holds back.
    pub mean: Vec3,
    /// Luminance: mean square of the passes' deviations (see [`super::resolve::fold`]).
    pub spread: Real,
    /// Change of the mean not yet put into `mean`: small terms are summed here first, so that they
    /// count.
    pub carry: Vec3,
    /// Luminance of the mean over the first 2^k passes, 2^k the greatest power of two below the
    /// number of passes.
    pub mean_at_pow2: Real,
    /// Passes whose value was not finite and was left out, by cause: see `REJECTED_*`.
    pub rejected: [u32; 4],
    /// Luminance: mean over the passes of the estimate in the whole disc less that in the inner
    /// half of its area.
    pub bias_probe: Real,
    /// The same mean with odd passes turned over.
    pub bias_probe_alternating: Real,
    /// Luminance: mean over the passes of what two halves of the eye samples differ by, scaled so
    /// that its square is the variance of the mean over all.
    pub halves: Real,
    /// Luminance of the mean over the first 2^(k-1) passes.
    pub mean_at_half_pow2: Real,
}
