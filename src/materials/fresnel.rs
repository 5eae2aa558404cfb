//! Fresnel terms. Twin: `shaders/materials/fresnel.wgsl`.

use super::real::{Real, Vec3};

/// Schlick's Fresnel term.
pub fn schlick(f0: Vec3, cos: Real) -> Vec3 {
    let m = (1.0 - cos).max(0.0);
    let m2 = m * m;
    f0 + (Vec3::ONE - f0) * (m2 * m2 * m)
}

/// Reflection and refraction at a dielectric interface.
#[derive(Clone, Copy, Debug)]
pub struct Interface {
    /// Fresnel reflectance for unpolarised light; 1 beyond the critical angle.
    pub reflectance: Real,
    /// Cosine of the refracted ray with the normal on the far side; 0 under total internal
    /// reflection.
    pub cos_t: Real,
}

/// Fresnel equations: `cos_i` > 0 on the side the ray comes from, `eta` = ior on that side / ior on
/// the far side.
pub fn fresnel(cos_i: Real, eta: Real) -> Interface {
    // as a product: 1 - cos^2 loses all digits near the normal, where dense glass has its critical
    // angle
    let sin_t_sq = eta * eta * ((1.0 - cos_i) * (1.0 + cos_i)).max(0.0);
    if sin_t_sq >= 1.0 {
        return Interface { reflectance: 1.0, cos_t: 0.0 };
    }
    let cos_t = (1.0 - sin_t_sq).sqrt();
    let parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    Interface { reflectance: 0.5 * (parallel * parallel + perpendicular * perpendicular), cos_t }
}

/// Direction of the refracted ray; `wo` points away from the surface on the side of `n`.
pub fn refracted(wo: Vec3, n: Vec3, cos_i: Real, cos_t: Real, eta: Real) -> Vec3 {
    n * (eta * cos_i - cos_t) - wo * eta
}

/// Fresnel reflectance of a conductor for unpolarised light, per channel: `eta` and `k` are the
/// real and imaginary part of its index relative to the outside (Born & Wolf, section 14.2).
pub fn fresnel_conductor(cos: Real, eta: Vec3, k: Vec3) -> Vec3 {
    let cos_sq = cos * cos;
    let sin_sq = (1.0 - cos_sq).max(0.0);
    let base = (eta - k) * (eta + k) - Vec3::splat(sin_sq);
    let crossed = eta * k;
    let root = base * base + 4.0 * (crossed * crossed);
    // a^2 + b^2 and a, where a + ib is the cosine inside times the index
    let sum = Vec3::new(root.x.sqrt(), root.y.sqrt(), root.z.sqrt());
    let half = (sum + base) * 0.5;
    let a = Vec3::new(half.x.max(0.0).sqrt(), half.y.max(0.0).sqrt(), half.z.max(0.0).sqrt());
    let outer = sum + Vec3::splat(cos_sq);
    let inner = a * (2.0 * cos);
    let perpendicular = (outer - inner) / (outer + inner);
    let long = sum * cos_sq + Vec3::splat(sin_sq * sin_sq);
    let short = inner * sin_sq;
    // the parallel part is that fraction of the perpendicular one
    let fraction = (long - short) / (long + short);
    perpendicular * (Vec3::splat(0.5) + 0.5 * fraction)
}
