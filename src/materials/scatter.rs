//! Scattering at a surface: the dispatch over materials. Twin: `shaders/materials/scatter.wgsl`.

use super::glass::{fresnel, refracted};
use super::interior::{Interior, interior_beyond, relative_ior};
use super::math::sampling::sample_cosine;
use super::math::{INV_PI, basis, from_frame, mirrored};
use super::metal::{eval_metal, pdf_metal, sample_metal, weight_metal};
use super::real::{Real, Vec2, Vec3};
use super::shapes::surface::Surface;
use super::tables::*;
use super::texture::eval_texture;

/// Transport of radiance: an eye path.
pub const RADIANCE: u32 = 0;
/// Transport of importance, that is of flux: a photon path.
pub const IMPORTANCE: u32 = 1;

/// Least cosine with the geometric normal for which a shading normal's correction is formed.
const ADJOINT_COS_MIN: Real = 1e-2;

/// Where a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// Unit direction.
    pub direction: Vec3,
    /// Interior list of the new ray.
    pub interior: Interior,
    /// BSDF times cosine over density; zero where the path ends.
    pub weight: Vec3,
}

/// Reflectance of a material at `uv`.
#[inline(always)]
pub fn reflectance_at(scene: &Scene, material: u32, uv: Vec2) -> Vec3 {
    let m = &scene.materials[material as usize];
    if m.texture != NONE {
        return eval_texture(scene, m.texture, uv);
    }
    m.reflectance
}

/// Whether a material scatters into single directions only.
#[inline(always)]
pub fn is_specular(kind: u32) -> bool {
    kind == MATERIAL_MIRROR || kind == MATERIAL_GLASS
}

/// `v` turned to the side of `w`.
#[inline(always)]
pub fn toward(v: Vec3, w: Vec3) -> Vec3 {
    if v.dot(w) >= 0.0 { v } else { -v }
}

/// The shading normal on the side of `wo`. Where `wo` lies behind it: the geometric one, except on
/// diffuse surfaces, which look the same from everywhere.
#[inline(always)]
pub fn shading_normal(scene: &Scene, s: &Surface, wo: Vec3) -> Vec3 {
    let ng = toward(s.normal, wo);
    let ns = toward(s.shading, ng);
    let diffuse = scene.materials[s.material as usize].kind == MATERIAL_DIFFUSE;
    if diffuse || wo.dot(ns) > 0.0 { ns } else { ng }
}

/// Mirror and glass. `interior` is the list in front of the surface; `u` decides between reflection
/// and refraction.
#[inline(always)]
pub fn scatter_specular(
    scene: &Scene,
    s: &Surface,
    wo: Vec3,
    interior: &Interior,
    u: Real,
    mode: u32,
) -> Scatter {
    let m = &scene.materials[s.material as usize];
    let ng = toward(s.normal, wo);
    let mut n = shading_normal(scene, s, wo);
    if m.kind == MATERIAL_GLASS {
        let beyond = interior_beyond(scene, s, wo, interior);
        let eta = relative_ior(scene, s, wo, interior, &beyond);
        let cos_i = wo.dot(n);
        let interface = fresnel(cos_i, eta);
        if u >= interface.reflectance {
            let mut wi = refracted(wo, n, cos_i, interface.cos_t, eta);
            if wi.dot(ng) >= 0.0 {
                n = ng;
                let cos_g = wo.dot(ng);
                let flat = fresnel(cos_g, eta);
                wi = refracted(wo, ng, cos_g, flat.cos_t, eta);
            }
            // radiance is compressed into a smaller solid angle inside (Veach 1997, section 5.2)
            let mut weight = eta * eta;
            if mode == IMPORTANCE {
                weight = shading_correction(s, n, ng, wo, wi);
            }
            return Scatter { direction: wi, interior: beyond, weight: Vec3::splat(weight) };
        }
    }
    if mirrored(wo, n).dot(ng) <= 0.0 {
        n = ng;
    }
    let wi = mirrored(wo, n);
    let mut weight = Vec3::ONE;
    if mode == IMPORTANCE {
        weight *= shading_correction(s, n, ng, wo, wi);
    }
    if m.kind != MATERIAL_GLASS {
        weight *= reflectance_at(scene, s.material, s.uv);
    }
    Scatter { direction: wi, interior: *interior, weight }
}

/// Diffuse and metal: a direction by the material's own density.
#[inline(always)]
pub fn scatter_rough(
    scene: &Scene,
    s: &Surface,
    wo: Vec3,
    interior: &Interior,
    u: Vec2,
    mode: u32,
) -> Scatter {
    let m = &scene.materials[s.material as usize];
    let ng = toward(s.normal, wo);
    let n = shading_normal(scene, s, wo);
    let mut wi: Vec3;
    let mut weight = reflectance_at(scene, s.material, s.uv);
    if m.kind == MATERIAL_METAL {
        let (t, b) = basis(n);
        let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
        let h = sample_metal(local_wo, m.alpha, u);
        let local_wi = mirrored(local_wo, h);
        weight = weight_metal(local_wo, h, local_wi, weight, m.alpha);
        wi = from_frame(n, local_wi);
    } else {
        let mut axis = n;
        if mode == IMPORTANCE {
            // the adjoint of a diffuse surface sends about the geometric normal what the shading
            // one receives
            axis = ng;
            if s.shading != s.normal {
                weight *= wo.dot(n).max(0.0) / wo.dot(ng).max(ADJOINT_COS_MIN);
            }
        }
        wi = from_frame(axis, sample_cosine(u));
    }
    wi *= 1.0 / wi.dot(wi).sqrt();
    let cos_g = wi.dot(ng);
    if cos_g <= 0.0 {
        weight = Vec3::ZERO;
    } else if mode == IMPORTANCE && m.kind == MATERIAL_METAL {
        // from behind the shading normal an eye path would get nothing
        let seen = wo.dot(toward(s.shading, ng)) > 0.0;
        weight *= if seen { shading_correction(s, n, ng, wo, wi) } else { 0.0 };
    }
    Scatter { direction: wi, interior: *interior, weight }
}

/// Adjoint correction of shading normals for particles (Veach 1997, eq. 5.19); 1 where both normals
/// agree.
pub fn shading_correction(s: &Surface, n: Vec3, ng: Vec3, wo: Vec3, wi: Vec3) -> Real {
    if s.shading == s.normal {
        return 1.0;
    }
    let denominator = (wo.dot(ng) * wi.dot(n)).abs();
    if denominator <= 1e-6 {
        return 0.0;
    }
    (wo.dot(n) * wi.dot(ng)).abs() / denominator
}

/// BRDF of diffuse and metal times the cosine with the shading normal `n`, both directions on its
/// side.
#[inline(always)]
pub fn eval_rough(kind: u32, alpha: Real, reflectance: Vec3, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return Vec3::ZERO;
    }
    if kind == MATERIAL_METAL {
        let (t, b) = basis(n);
        let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
        let local_wi = Vec3::new(wi.dot(t), wi.dot(b), cos);
        return eval_metal(local_wo, local_wi, reflectance, alpha) * cos;
    }
    reflectance * (INV_PI * cos)
}

/// Density of [`scatter_rough`], sr^-1.
pub fn pdf_rough(kind: u32, alpha: Real, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return 0.0;
    }
    if kind == MATERIAL_METAL {
        let (t, b) = basis(n);
        let local_wo = Vec3::new(wo.dot(t), wo.dot(b), wo.dot(n));
        return pdf_metal(local_wo, Vec3::new(wi.dot(t), wi.dot(b), cos), alpha);
    }
    cos * INV_PI
}
