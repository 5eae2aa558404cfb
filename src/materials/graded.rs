//! A material with a parameter that a texture gives: the path chooses one of the two materials of a
//! graded series, for values in equal steps, between which the texture's value lies. The mean is
//! linear in the parameter between the steps. Twin: `shaders/materials/graded.wgsl`.

use super::real::Real;
use super::shading::{Layer, ShadingPoint, amount_at, another};
use super::tables::{Material, SceneTables};

/// See [`super::Bsdf::examples`].
pub const EXAMPLES: &[Material] = &[];

/// Chooses one of the two nearest materials of the series.
#[inline(always)]
pub fn choose_graded<'a>(_: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
    let m = p.lobe.m;
    let at = ((amount_at(p) - m.ior) * m.alpha).clamp(0.0, m.second as Real);
    let below = at.floor();
    let share = at - below;
    let k = m.first + below as u32;
    if u < share {
        return another(p, k + 1, u / share);
    }
    let u = (u - share) / (1.0 - share).max(1e-6);
    another(p, k, u)
}
