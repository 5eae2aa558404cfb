//! Validation of checkpoint data: a forged file must neither hang a render nor corrupt it. `file`
//! has already checked the lengths of per-pixel data.

use super::Origin;
use crate::engine::{Space, State};
use crate::scene::settings::{Method, RadiusRule};

/// Number of items that are checked at a time, so that a large film is not copied as a whole.
const TOGETHER: usize = 4096;

/// Checks the engine state and, for a merged checkpoint, the cuts.
///
/// # Errors
/// The first value that no render produces.
pub(super) fn check(state: &State, cuts: &[[u32; 2]]) -> Result<(), String> {
    match state.bits {
        32 => single::check(state)?,
        _ => wide::check(state)?,
    }
    match cuts.iter().flatten().find(|cut| **cut > state.passes) {
        Some(cut) => Err(format!("a mean over {cut} passes in a film of {}", state.passes)),
        None => Ok(()),
    }
}

/// Checks the number of visible points with statistics and photon counts. Both are optional;
/// statistics require the local radius rule, photon counts a method that gathers photons.
///
/// # Errors
/// If a number is neither zero nor that of the image's visible points.
pub(super) fn check_points(origin: &Origin, statistics: u64, counts: u64) -> Result<(), String> {
    let settings = &origin.settings;
    let [columns, rows] = origin.window_size().map(u64::from);
    let samples = if settings.method == Method::Ppm { u64::from(settings.eye_samples) } else { 1 };
    let points = (columns * rows).saturating_mul(samples);
    let gathers = settings.method != Method::Path;
    let local = gathers && settings.radius_rule == RadiusRule::Local;
    for (name, found, kept) in
        [("statistics", statistics, local), ("photon counts", counts, gathers)]
    {
        if found != 0 && (found != points || !kept) {
            let points = if kept { points } else { 0 };
            return Err(format!("{name} of {found} visible points, but expected {points}"));
        }
    }
    Ok(())
}

/// Checks the conversion of scene units to world units.
///
/// # Errors
/// The first value that no scene has.
pub(super) fn check_space(space: &Space) -> Result<(), String> {
    let Space { center, unit, radiance_unit, photons: _, glint } = *space;
    let positive = |x: f64| x > 0.0 && x.is_finite();
    if !(positive(unit) && positive(radiance_unit)) {
        return Err(format!("a scene unit of {unit} and a radiance unit of {radiance_unit}"));
    }
    if !(glint >= 0.0 && glint.is_finite() && center.iter().all(|x| x.is_finite())) {
        return Err(format!("a scene center of {center:?} and glints of {glint}"));
    }
    Ok(())
}

macro_rules! precision {
    ($name:ident, $kernels:path, $real:path) => {
        mod $name {
            use super::*;
            use kernels::bytes::*;
            use $kernels as kernels;
            use $real as real;

            /// Checks per-pixel layers: means are finite, and counts are in range.
            fn check_layers(state: &State) -> Result<(), String> {
                let all_finite = |v: &real::Vec3| v.is_finite();
                for (number, bytes) in state.layers.aovs.chunks(AOV_BYTES * TOGETHER).enumerate() {
                    let sound = |a: &kernels::aov_trace::AovPixel| {
                        let counts = [a.hits, a.points].iter().all(|x| *x >= 0.0 && x.is_finite());
                        let vectors = [&a.albedo, &a.normal, &a.position, &a.emission, &a.direct];
                        counts
                            && a.depth.is_finite()
                            && a.radius.is_finite()
                            && vectors.into_iter().all(all_finite)
                    };
                    if let Some(i) = aovs_of(bytes).iter().position(|a| !sound(a)) {
                        return Err(format!("pixel {} has invalid layers", number * TOGETHER + i));
                    }
                }
                #[allow(clippy::unnecessary_cast)] // not a cast in the f64 instance
                let most = f64::from(state.passes) as real::Real;
                for (number, bytes) in state.layers.parts.chunks(PARTS_BYTES * TOGETHER).enumerate()
                {
                    let sound = |p: &kernels::resolve_parts::PartsPixel| {
                        (0.0..=most).contains(&p.passes)
                            && all_finite(&p.caustic)
                            && all_finite(&p.indirect)
                    };
                    if let Some(i) = parts_of(bytes).iter().position(|p| !sound(p)) {
                        return Err(format!(
                            "pixel {} has invalid light components",
                            number * TOGETHER + i
                        ));
                    }
                }
                Ok(())
            }

            pub fn check(state: &State) -> Result<(), String> {
                for (number, bytes) in state.film.chunks(FILM_BYTES * TOGETHER).enumerate() {
                    for (i, p) in film_of(bytes).iter().enumerate() {
                        let at = number * TOGETHER + i;
                        let means = [p.mean.x, p.mean.y, p.mean.z, p.carry.x, p.carry.y, p.carry.z];
                        // squares of bright passes may overflow to infinity
                        let rest = [
                            p.spread,
                            p.mean_at_pow2,
                            p.mean_at_half_pow2,
                            p.bias_probe,
                            p.bias_probe_alternating,
                            p.halves,
                        ];
                        let numbers =
                            means.iter().all(|x| x.is_finite()) && rest.iter().all(|x| !x.is_nan());
                        if !numbers || p.spread < 0.0 {
                            return Err(format!("pixel {at} has invalid radiance"));
                        }
                        let rejected: u64 = p.rejected.iter().map(|n| u64::from(*n)).sum();
                        if rejected > u64::from(state.passes) {
                            let passes = state.passes;
                            return Err(format!(
                                "pixel {at} rejects {rejected} of {passes} passes"
                            ));
                        }
                    }
                }
                for (number, bytes) in
                    state.statistics.chunks(STATISTICS_BYTES * TOGETHER).enumerate()
                {
                    for (i, s) in statistics_of(bytes).iter().enumerate() {
                        // radii only shrink; 0 marks a point that no pass has updated
                        if !((0.0..=1.0).contains(&s.scale_sq)
                            && (0.0..=s.scale_sq).contains(&s.drop))
                        {
                            let at = number * TOGETHER + i;
                            return Err(format!(
                                "visible point {at} has the invalid squared radius scale {}",
                                s.scale_sq
                            ));
                        }
                    }
                }
                check_layers(state)
            }
        }
    };
}

precision!(single, crate::kernels, crate::real);
precision!(wide, crate::double::kernels, crate::double::real);
