//! Whether the numbers of a checkpoint can be those of a render: a forged file must neither hang a render
//! nor fill it with nonsense. Lengths are checked before (`file`).

use crate::engine::{Space, State};

/// Items that are looked at together, so that a large film is not copied as a whole.
const TOGETHER: usize = 4096;

/// Checks what the engine is to take over; `passes` is the number of passes of the film.
///
/// # Errors
/// The first number that no render gives.
pub(super) fn check(state: &State, cuts: &[[u32; 2]]) -> Result<(), String> {
    match state.bits {
        32 => single::check(state)?,
        _ => wide::check(state)?,
    }
    match cuts.iter().flatten().find(|cut| **cut > state.passes) {
        Some(cut) => Err(format!("a mean over {cut} of {} passes", state.passes)),
        None => Ok(()),
    }
}

/// Checks what tells scene units.
///
/// # Errors
/// The first number that no scene has.
pub(super) fn check_space(space: &Space) -> Result<(), String> {
    let Space { center, unit, radiance_unit, photons: _, glint } = *space;
    let positive = |x: f64| x > 0.0 && x.is_finite();
    if !(positive(unit) && positive(radiance_unit)) {
        return Err(format!("a scene unit of {unit} and a radiance unit of {radiance_unit}"));
    }
    if !(glint >= 0.0 && glint.is_finite() && center.iter().all(|x| x.is_finite())) {
        return Err(format!("a scene about {center:?} with glints of {glint}"));
    }
    Ok(())
}

macro_rules! precision {
    ($name:ident, $kernels:path) => {
        mod $name {
            use super::*;
            use kernels::bytes::{FILM_BYTES, STATISTICS_BYTES, film_of, statistics_of};
            use $kernels as kernels;

            pub fn check(state: &State) -> Result<(), String> {
                for (number, bytes) in state.film.chunks(FILM_BYTES * TOGETHER).enumerate() {
                    for (i, p) in film_of(bytes).iter().enumerate() {
                        let at = number * TOGETHER + i;
                        let means = [p.mean.x, p.mean.y, p.mean.z, p.carry.x, p.carry.y, p.carry.z];
                        // squares of bright passes may go beyond what a number holds
                        let rest = [p.spread, p.early, p.earlier, p.ring, p.ring_swing, p.halves];
                        let numbers = means.iter().all(|x| x.is_finite()) && rest.iter().all(|x| !x.is_nan());
                        if !numbers || p.spread < 0.0 {
                            return Err(format!("pixel {at} holds no radiance"));
                        }
                        let rejected: u64 = p.rejected.iter().map(|n| u64::from(*n)).sum();
                        if rejected > u64::from(state.passes) {
                            let passes = state.passes;
                            return Err(format!("pixel {at} leaves out {rejected} of {passes} passes"));
                        }
                    }
                }
                for (number, bytes) in state.statistics.chunks(STATISTICS_BYTES * TOGETHER).enumerate() {
                    for (i, s) in statistics_of(bytes).iter().enumerate() {
                        // radii only shrink; 0 is a point that no pass has looked at
                        if !((0.0..=1.0).contains(&s.scale_sq) && (0.0..=s.scale_sq).contains(&s.drop)) {
                            let at = number * TOGETHER + i;
                            return Err(format!(
                                "visible point {at} has {} of its squared radius",
                                s.scale_sq
                            ));
                        }
                    }
                }
                Ok(())
            }
        }
    };
}

precision!(single, crate::kernels);
precision!(wide, crate::double::kernels);
