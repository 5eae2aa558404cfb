//! Adds one pass's photon estimate of a pixel, split into its caustic and indirect parts, to the
//! layer. Run by one invocation per pixel, before `resolve`; reads `visible_points` and `gathered`
//! (and `statistics` under the local rule), updates `parts`. Twin:
//! `shaders/kernels/resolve_parts.wgsl`.

use super::gather::scale_sq;
use super::math::{PI, is_finite};
use super::real::{Plain, Real, Vec3};
use super::records::{BAD_DIRECT, BAD_EYE, Dispatch, Gathered, Statistics, VisiblePoint};
use bytemuck::Zeroable;

/// Means over the accepted passes, in W sr^-1 m^-2 of scene units.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Plain, Zeroable)]
pub struct PartsPixel {
    /// Radiance from photons that no diffuse surface has scattered.
    pub caustic: Vec3,
    /// Number of accepted passes.
    pub passes: Real,
    /// Radiance from all other photons.
    pub indirect: Vec3,
    /// Padding to 16 bytes.
    pub pad: u32,
}

/// Adds what the visible points of a pixel have gathered to `parts`. `statistics` has one entry per
/// visible point under the local rule.
pub fn resolve_parts(
    dispatch: &Dispatch,
    points: &[VisiblePoint],
    gathered: &[Gathered],
    statistics: Option<&[Statistics]>,
    parts: &mut PartsPixel,
) {
    let mut caustic = Vec3::ZERO;
    let mut indirect = Vec3::ZERO;
    let mut state = 0;
    for k in 0..dispatch.eye_samples as usize {
        state |= points[k].state;
        if gathered[k].count > 0 {
            let scale = match statistics {
                Some(all) => scale_sq(dispatch, true, &all[k]),
                None => dispatch.scale_sq,
            };
            let area = PI * points[k].radius * points[k].radius * scale;
            let share = 1.0 / (dispatch.photons * area);
            caustic += gathered[k].caustic * share;
            indirect += (gathered[k].flux - gathered[k].caustic) * share;
        }
    }
    // as in `resolve`, a pass that is not finite is rejected
    if (state & (BAD_EYE | BAD_DIRECT)) != 0 || !is_finite(caustic) || !is_finite(indirect) {
        return;
    }
    parts.passes += 1.0;
    let samples = 1.0 / dispatch.eye_samples as Real;
    let share = 1.0 / parts.passes;
    parts.caustic += (caustic * samples - parts.caustic) * share;
    parts.indirect += (indirect * samples - parts.indirect) * share;
}
