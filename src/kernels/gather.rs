//! Density estimate at one visible point: the sum over the photons in its disc, or in two discs if
//! indirect photons use a wider one. Run by one invocation per visible point and photon batch;
//! reads `visible_points`, `sorted`, `starts` (and `statistics` under the local rule), adds to
//! `gathered`. Twin: `shaders/kernels/gather.wgsl`, which tests photons one at a time; this module
//! tests several at once and sums those inside in the same order.

use super::grid::{grid_bucket, grid_cell, grid_code};
use super::grid_build::SortedRecords;
use super::materials::shading::Lobe;
use super::materials::{Bsdf, eval_rough};
use super::math::{LUMINANCE, oct_decode, unit};
use super::real::{Real, Vec3, Vec4};
use super::records::{BSDF_BITS, Dispatch, Gathered, ONLY_FOCUSED, Statistics, VisiblePoint};
use super::shapes::outline::{before_walls, clip_at, in_outline};
use super::tables::{Material, Outline};
use bytemuck::Zeroable;
use glam::IVec3;
use std::ops::Range;

/// Distance from the tangent plane, in radii, beyond which photons lie on another surface.
const FLATNESS: Real = 0.25;
/// Lower bound of the cosine to the geometric normal that the shading-normal correction divides by.
const COS_MIN: Real = 1e-2;

/// Added to the squared sine between an axis and the normal, so that rounding never makes the box
/// about a disc too small.
const BOX_SLACK: Real = 1e-4;

/// Number of consecutive photons that are summed before their sum is added to the total: a sum of a
/// million photons accumulates about 2000 roundings.
const BLOCK: usize = 1024;
/// Number of photons that are tested at once.
const LANES: usize = 16;

/// Shading frame of a visible point.
#[derive(Clone, Copy)]
struct Frame<'a> {
    /// Geometric normal.
    ng: Vec3,
    /// Shading normal.
    n: Vec3,
    /// Direction to the viewer; zero for a diffuse lobe.
    wo: Vec3,
    /// Lobe of the material.
    lobe: Lobe<'a>,
}

impl<'a> Frame<'a> {
    #[inline(always)]
    fn at(materials: &'a [Material], point: &VisiblePoint) -> Self {
        let ng = oct_decode(point.normal);
        let n = if point.normal == point.shading { ng } else { oct_decode(point.shading) };
        let bsdf = Bsdf::of(point.bsdf & ((1 << BSDF_BITS) - 1));
        let wo = if bsdf == Bsdf::Diffuse { Vec3::ZERO } else { oct_decode(point.wo) };
        let material = point.bsdf >> BSDF_BITS;
        let m = materials.get(material as usize).unwrap_or(const { &Material::EMPTY });
        let lobe = Lobe { bsdf, alpha: point.alpha, reflectance: point.reflectance, material, m };
        Self { ng, n, wo, lobe }
    }
}

/// Squared radius of this pass over the squared start radius.
pub fn scale_sq(dispatch: &Dispatch, local: bool, statistics: &Statistics) -> Real {
    if !local {
        return dispatch.scale_sq;
    }
    if statistics.scale_sq == 0.0 { 1.0 } else { statistics.scale_sq - statistics.drop }
}

/// Adds the photons of one batch around a visible point to `gathered`. Inlined, so that it is
/// compiled for the processor's widest vectors inside [`pulp::Arch::dispatch`].
#[inline(always)]
pub fn gather(
    materials: &[Material],
    outlines: &[Outline],
    dispatch: &Dispatch,
    point: &VisiblePoint,
    scale_sq: Real,
    starts: &[u32],
    sorted: &SortedRecords,
    gathered: &mut Gathered,
) {
    if point.radius <= 0.0 {
        return;
    }
    let radius_sq = point.radius * point.radius * scale_sq;
    let frame = Frame::at(materials, point);
    let mut found = gather_class(outlines, dispatch, point, &frame, 0, radius_sq, starts, sorted);
    if dispatch.classes == 2 {
        gathered.caustic += point.weight * found.flux;
        let wider_sq = dispatch.indirect_radius * dispatch.indirect_radius;
        let wide = gather_class(
            outlines,
            dispatch,
            point,
            &frame,
            1,
            radius_sq * wider_sq,
            starts,
            sorted,
        );
        found.flux += wide.flux * (1.0 / wider_sq);
        found.count += wide.count;
        found.bias_probe += wide.bias_probe * (1.0 / wider_sq);
    }
    gathered.flux += point.weight * found.flux;
    gathered.count += found.count;
    gathered.bias_probe += found.bias_probe;
}

/// Sums the photons of one class: BRDF times flux without the point's weight, their number, and the
/// bias probe.
#[inline(always)]
fn gather_class(
    outlines: &[Outline],
    dispatch: &Dispatch,
    point: &VisiblePoint,
    frame: &Frame,
    photon_class: u32,
    radius_sq: Real,
    starts: &[u32],
    sorted: &SortedRecords,
) -> Gathered {
    let inv_cell = if photon_class == 1 { dispatch.inv_cell_indirect } else { dispatch.inv_cell };
    let radius = radius_sq.sqrt();
    let Frame { ng, n, wo, lobe } = *frame;
    let folded = lobe.bsdf == Bsdf::Diffuse;
    let both = lobe.bsdf.transmits();
    let flat = point.normal == point.shading;
    let only_focused = point.state & ONLY_FOCUSED != 0;
    // clip the disc to the outline
    let clip = clip_at(outlines, point.outline, point.position, ng, radius);
    let depth = clip.depth.min(FLATNESS * radius);
    let inner = clip.whole - 2.0 * clip.inner;
    // range of cells that the disc overlaps
    let reach = disc_reach(ng, radius, depth);
    let low = grid_cell(point.position - reach, inv_cell);
    let high = grid_cell(point.position + reach, inv_cell);
    let mut count = 0;
    let mut sum = Vec4::ZERO;
    let mut ring = Vec4::ZERO;
    let mut outer = [false; LANES];
    // walk the rows of cells
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            let cell = IVec3::new(low.x, y, z);
            let code = grid_code(cell, photon_class);
            let bucket = grid_bucket(cell, dispatch.mask);
            let last = bucket + ((high.x - low.x) as u32).min(dispatch.mask);
            // a row that passes the end of the table continues at its start
            for part in 0..1 + (last > dispatch.mask) as u32 {
                let begin = if part == 0 { bucket } else { 0 };
                let to = if part == 0 { last.min(dispatch.mask) } else { last - dispatch.mask - 1 };
                let (mut first, end) =
                    (starts[begin as usize] as usize, starts[to as usize + 1] as usize);
                // walk the row's photons block by block
                while first < end {
                    let mut block = Vec4::ZERO;
                    let last = (first + BLOCK).min(end);
                    while first < last {
                        let lanes = first..last;
                        let mut near = near(
                            sorted,
                            lanes,
                            code,
                            point.position,
                            ng,
                            radius_sq,
                            depth,
                            both,
                            &mut outer,
                        );
                        while near != 0 {
                            let k = near.trailing_zeros() as usize / 8;
                            let i = first + k;
                            near &= near - 1;
                            // reject photons outside the outline or behind a wall
                            if clip.crossed {
                                let [xs, ys, zs] = &sorted.positions;
                                let position = Vec3::new(xs[i], ys[i], zs[i]);
                                let here = before_walls(&clip, point.position, position);
                                if !here || !in_outline(&outlines[point.outline as usize], position)
                                {
                                    continue;
                                }
                            }
                            let mut flux = sorted.fluxes[i];
                            // reject photons whose light the continued path carries
                            if only_focused && flux.w == 0.0 {
                                continue;
                            }
                            count += 1;
                            if !flat || !folded {
                                let [us, vs, ws] = &sorted.directions;
                                let wi = unit(Vec3::new(us[i], vs[i], ws[i]));
                                // flux arrives with the geometric cosine, the BSDF uses the shading
                                // one
                                if folded {
                                    flux *= wi.dot(n).max(0.0) / wi.dot(ng).max(COS_MIN);
                                } else {
                                    let cos_g = wi.dot(ng).abs().max(COS_MIN);
                                    let f = eval_rough(&lobe, n, wo, wi);
                                    flux = f.extend(0.0) * flux * (1.0 / cos_g);
                                }
                            }
                            block += flux;
                            ring += flux * if outer[k] { clip.whole } else { inner };
                        }
                        first += LANES;
                    }
                    sum += block;
                    first = last;
                }
            }
        }
    }
    let bias_probe = (point.weight * LUMINANCE).dot(ring.truncate());
    Gathered { flux: sum.truncate() * clip.whole, count, bias_probe, ..Gathered::zeroed() }
}

/// Half-extent along each axis of the part of a disc's surroundings that lies within `radius` of
/// its centre and within `depth` of its plane.
fn disc_reach(normal: Vec3, radius: Real, depth: Real) -> Vec3 {
    let sine_sq = (Vec3::splat(1.0 + BOX_SLACK) - normal * normal).max(Vec3::ZERO);
    Vec3::new(sine_sq.x.sqrt(), sine_sq.y.sqrt(), sine_sq.z.sqrt()) * radius + normal.abs() * depth
}

/// Tests the first [`LANES`] photons of `range`. A photon counts if it lies in the disc and in the
/// row of cells, no farther than `depth` from the disc's plane, and arrives on the viewer's side
/// or, with `both`, on either side. Returns one byte per photon, 1 if it counts. Sets `outer` for
/// photons in the outer half of the disc's area.
#[inline(always)]
fn near(
    sorted: &SortedRecords,
    Range { start: first, end: last }: Range<usize>,
    code: u32,
    position: Vec3,
    ng: Vec3,
    radius_sq: Real,
    depth: Real,
    both: bool,
    outer: &mut [bool; LANES],
) -> u128 {
    // in bounds, because `SortedRecords` is padded with entries that belong to no cell
    let lanes = first..first + LANES;
    let codes = &sorted.codes[lanes.clone()];
    let [xs, ys, zs] = sorted.positions.each_ref().map(|values| &values[lanes.clone()]);
    let [us, vs, ws] = sorted.directions.each_ref().map(|values| &values[lanes.clone()]);
    let mut near = [0u8; LANES];
    for k in 0..LANES {
        let d = Vec3::new(xs[k], ys[k], zs[k]) - position;
        let toward_light = Vec3::new(us[k], vs[k], ws[k]);
        let distance_sq = d.dot(d);
        let inside = (distance_sq <= radius_sq) & (d.dot(ng).abs() <= depth);
        outer[k] = distance_sq > 0.5 * radius_sq;
        near[k] = (inside & (codes[k] == code) & (both | (toward_light.dot(ng) > 0.0))) as u8;
    }
    let beyond = 8 * (LANES - (last - first).min(LANES)) as u32;
    u128::from_le_bytes(near) & (u128::MAX >> beyond)
}
