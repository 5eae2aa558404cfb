//! Vector functions and constants. Twin: `shaders/math/vector.wgsl`.

use super::real::{EXPONENT, Real, Vec3, consts};

/// pi.
pub const PI: Real = consts::PI;
/// Twice pi.
pub const TAU: Real = consts::TAU;
/// One over pi.
pub const INV_PI: Real = consts::FRAC_1_PI;
/// Distance beyond anything in a scene; WGSL does not guarantee infinities.
pub const FAR: Real = 1e30;
/// Unit roundoff: half an ulp of 1, the relative error bound of one rounding.
pub const EPS: Real = 0.5 * Real::EPSILON;

/// Weights of linear Rec. 709 components in luminance.
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Normalizes `v`.
pub fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}

/// Returns true if every component is finite (tested on the bits, since shader compilers may assume
/// finite numbers).
pub fn is_finite(v: Vec3) -> bool {
    [v.x, v.y, v.z].iter().all(|x| x.to_bits() & EXPONENT != EXPONENT)
}

/// Greatest component.
pub fn max_component(v: Vec3) -> Real {
    v.x.max(v.y).max(v.z)
}

/// Greatest absolute component.
pub fn max_abs(v: Vec3) -> Real {
    max_component(v.abs())
}

/// Rec. 709 luminance of a linear Rec. 709 colour.
pub fn luminance(v: Vec3) -> Real {
    v.dot(LUMINANCE)
}

/// Two unit vectors that complete `n` to a right-handed frame (Duff et al. 2017).
pub fn basis(n: Vec3) -> (Vec3, Vec3) {
    let s = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + s * n.x * n.x * a, s * b, -s * n.x), Vec3::new(b, s + n.y * n.y * a, -n.y))
}

/// Transforms `local` (x, y along the tangents of [`basis`], z along `n`) to the space of `n`.
pub fn from_frame(n: Vec3, local: Vec3) -> Vec3 {
    let (t, b) = basis(n);
    t * local.x + b * local.y + n * local.z
}

/// Mirrors `w` at the unit normal `n`; both vectors point away from the surface.
pub fn mirrored(w: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * w.dot(n)) - w
}

/// Origin of a ray that leaves `position` along `direction`, offset from the surface by the bound
/// on the hit's error (the method of pbrt-v4, section 6.8, with a scalar bound).
pub fn offset_origin(position: Vec3, error: Real, normal: Vec3, direction: Vec3) -> Vec3 {
    if direction.dot(normal) >= 0.0 { position + normal * error } else { position - normal * error }
}
