//! Density estimate at one visible point: the sum over the photons in its disc. Run by one invocation per
//! visible point and photon batch; reads `visible_points`, `sorted`, `starts` (and `statistics` under the
//! local rule), adds to `gathered`. Twin: `shaders/kernels/gather.wgsl`.

use super::grid::{grid_bucket, grid_cell};
use super::materials::scatter::eval_rough;
use super::math::{LUMINANCE, oct_decode, oct_vector, unit};
use super::real::{Real, Vec3};
use super::records::{Dispatch, Gathered, PhotonRecord, Statistics, VisiblePoint};
use super::tables::MATERIAL_METAL;
use glam::IVec3;

/// Photons farther than this from the tangent plane, in radii, lie on another surface.
const FLATNESS: Real = 0.25;
/// Least cosine with the geometric normal for which the shading normal's correction is formed.
const COS_MIN: Real = 1e-2;

/// Photons of a bucket that are summed up before they are added to the whole sum: so a million photons lose no more than
/// some thousand roundings.
const BLOCK: usize = 1024;

/// Squared radius of this pass over the squared start radius.
pub fn scale_sq(dispatch: &Dispatch, local: bool, statistics: &Statistics) -> Real {
    if !local {
        return dispatch.scale_sq;
    }
    if statistics.scale_sq == 0.0 { 1.0 } else { statistics.scale_sq - statistics.drop }
}

/// Adds the photons of one batch around a visible point to `gathered`.
pub fn gather(
    dispatch: &Dispatch,
    point: &VisiblePoint,
    scale_sq: Real,
    starts: &[u32],
    sorted: &[PhotonRecord],
    gathered: &mut Gathered,
) {
    if point.radius <= 0.0 {
        return;
    }
    let radius_sq = point.radius * point.radius * scale_sq;
    let radius = radius_sq.sqrt();
    let ng = oct_decode(point.normal);
    let flat = point.normal == point.shading;
    let n = oct_decode(point.shading);
    let low = grid_cell(point.position - Vec3::splat(radius), dispatch.inv_cell);
    let high = grid_cell(point.position + Vec3::splat(radius), dispatch.inv_cell);
    let inner_sq = 0.5 * radius_sq;
    let tint = point.weight * LUMINANCE;
    let mut sum = Vec3::ZERO;
    for z in low.z..=high.z {
        for y in low.y..=high.y {
            for x in low.x..=high.x {
                let cell = IVec3::new(x, y, z);
                let bucket = grid_bucket(cell, dispatch.mask) as usize;
                let records = &sorted[starts[bucket] as usize..starts[bucket + 1] as usize];
                for some in records.chunks(BLOCK) {
                    let mut block = Vec3::ZERO;
                    for record in some {
                        let d = record.position - point.position;
                        let distance_sq = d.dot(d);
                        if distance_sq > radius_sq
                            || d.dot(ng).abs() > FLATNESS * radius
                            || grid_cell(record.position, dispatch.inv_cell) != cell
                        {
                            continue;
                        }
                        let toward_light = oct_vector(record.direction);
                        if toward_light.dot(ng) <= 0.0 {
                            continue;
                        }
                        gathered.count += 1;
                        let mut flux = record.flux;
                        if !flat || point.alpha > 0.0 {
                            let wi = unit(toward_light);
                            // flux arrives by the geometric cosine, the BRDF asks for the shading one
                            let cos_g = wi.dot(ng).max(COS_MIN);
                            if point.alpha > 0.0 {
                                let reflectance = point.reflectance;
                                let f = eval_rough(MATERIAL_METAL, point.alpha, reflectance, n, point.wo, wi);
                                flux = f * record.flux * (1.0 / cos_g);
                            } else {
                                flux = record.flux * (wi.dot(n).max(0.0) / cos_g);
                            }
                        }
                        block += flux;
                        let side = if distance_sq > inner_sq { 1.0 } else { -1.0 };
                        gathered.ring += side * tint.dot(flux);
                    }
                    sum += block;
                }
            }
        }
    }
    gathered.flux += point.weight * sum;
}
