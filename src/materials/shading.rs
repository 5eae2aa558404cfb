//! Shading point, shading normals and their adjoint correction, shared by all materials. Twin:
//! `shaders/materials/shading.wgsl`.

use super::Bsdf;
use super::brushed::grain_angle;
use super::geometry::surface::Surface;
use super::interior::{Interior, interior_beyond, relative_ior};
use super::maps::mapped_normal;
use super::math::{INV_PI, mirrored, unit};
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Hit;
use super::tables::*;
use super::texture::eval_texture;

/// Transport of radiance, along eye paths.
pub const RADIANCE: u32 = 0;
/// Transport of importance, that is of flux, along photon paths.
pub const IMPORTANCE: u32 = 1;

/// Lower bound of the cosine to the geometric normal that the shading-normal correction divides by.
pub const ADJOINT_COS_MIN: Real = 1e-2;

/// Material parameters at a point. A rough material needs nothing else to be evaluated, so a
/// visible point stores these.
#[derive(Clone, Copy, Debug)]
pub struct Lobe<'a> {
    /// The material's kind.
    pub bsdf: Bsdf,
    /// Width (alpha) of the lobe, if the kind has one; the angle of the grain of brushed metal.
    pub alpha: Real,
    /// Reflectance, in [0, 1]; at normal incidence for metal. Rough glass: index in front of the
    /// surface over that behind it.
    pub reflectance: Vec3,
    /// Index in the material table.
    pub material: u32,
    /// Entry of the material table; WGSL reads it by the index.
    pub m: &'a Material,
}

/// Width (alpha) below which continued eye paths have less noise than the few photons that
/// contribute to a lobe.
pub const NARROW: Real = 0.08;
/// The same for glass, where the photons on both sides of a curved surface spread.
pub const NARROW_GLASS: Real = 0.3;

impl Lobe<'_> {
    /// Returns true if the lobe is so narrow that eye paths continue at it.
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        let width = if self.bsdf == Bsdf::Brushed { self.bsdf.width(self.m) } else { self.alpha };
        self.bsdf.is_narrow(width)
    }
}

/// A choice among the materials of a layered one.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// The chosen lobe. If its material is another one, the caller reads its other parameters.
    pub lobe: Lobe<'a>,
    /// Factor of the path's throughput.
    pub weight: Real,
    /// A random number for further choices.
    pub u: Real,
}

/// The choice of the entry `material` of the table, whose parameters the caller reads.
#[inline(always)]
pub fn another<'a>(p: &ShadingPoint<'a>, material: u32, u: Real) -> Layer<'a> {
    Layer { lobe: Lobe { material, ..p.lobe }, weight: 1.0, u }
}

/// Surface point viewed from `wo`.
#[derive(Clone, Copy, Debug)]
pub struct ShadingPoint<'a> {
    /// The surface.
    pub s: Surface,
    /// Unit direction that the path came from.
    pub wo: Vec3,
    /// Geometric normal on the side of `wo`.
    pub ng: Vec3,
    /// Interpolated normal on the side of `ng`.
    pub ns: Vec3,
    /// Shading normal: `ns`, or `ng` if `wo` is behind `ns` and the material is not wide; see
    /// [`set_normals`] for surfaces with maps.
    pub n: Vec3,
    /// True if a map has bent `ns`.
    pub bent: bool,
    /// Material parameters.
    pub lobe: Lobe<'a>,
}

/// Direction sampled at a rough surface.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Unit direction.
    pub direction: Vec3,
    /// BSDF times cosine over density; zero if the path ends.
    pub weight: Vec3,
}

/// Continuation of a path.
#[derive(Clone, Copy, Debug)]
pub struct Scatter {
    /// Unit direction.
    pub direction: Vec3,
    /// Interior list of the new ray.
    pub interior: Interior,
    /// BSDF times cosine over density; zero if the path ends.
    pub weight: Vec3,
}

/// Reflectance of a material at `uv`.
#[inline(always)]
pub fn reflectance_at(scene: &SceneTables, material: u32, uv: Vec2) -> Vec3 {
    let m = &scene.materials[material as usize];
    if m.texture != NONE {
        return eval_texture(scene, m.texture, uv);
    }
    m.reflectance
}

/// Parameters of the entry `material` of the table at `uv`.
#[inline(always)]
pub fn lobe_at(scene: &SceneTables, material: u32, uv: Vec2) -> Lobe<'_> {
    let m = &scene.materials[material as usize];
    let reflectance = reflectance_at(scene, material, uv);
    Lobe { bsdf: Bsdf::of(m.kind), alpha: m.alpha, reflectance, material, m }
}

/// Amount of a mix or opacity: the mean of the channels of its color.
#[inline(always)]
pub fn amount_at(p: &ShadingPoint) -> Real {
    let color = p.lobe.reflectance;
    (color.x + color.y + color.z) * (1.0 / 3.0)
}

/// Returns `v` or `-v`, whichever is on the side of `w`.
#[inline(always)]
pub fn toward(v: Vec3, w: Vec3) -> Vec3 {
    if v.dot(w) >= 0.0 { v } else { -v }
}

/// Computes the normals and material parameters of the surface `s` at `hit`, viewed from `wo`;
/// `interior` is the interior list on that side.
#[inline(always)]
pub fn shading_point<'a>(
    scene: &'a SceneTables,
    hit: &Hit,
    s: &Surface,
    wo: Vec3,
    interior: &Interior,
) -> ShadingPoint<'a> {
    let mut lobe = lobe_at(scene, s.material, s.uv);
    if lobe.bsdf == Bsdf::RoughGlass {
        let beyond = interior_beyond(scene, s, wo, interior);
        lobe.reflectance = Vec3::splat(relative_ior(scene, s, wo, interior, &beyond));
    }
    let mut s = *s;
    if lobe.m.bent != 0 {
        s.shading = mapped_normal(scene, lobe.m, *hit, s);
    }
    let ng = toward(s.normal, wo);
    let mut p = ShadingPoint { s, wo, ng, ns: ng, n: ng, bent: lobe.m.bent != 0, lobe };
    set_normals(&mut p);
    if lobe.bsdf == Bsdf::Brushed {
        p.lobe.alpha = grain_angle(scene, *hit, &{ p });
    }
    p
}

/// Sets the shading normals from that of the surface.
#[inline(always)]
pub fn set_normals(p: &mut ShadingPoint) {
    p.ns = toward(p.s.shading, p.ng);
    // wide lobes do not depend on the viewing direction
    let faces = p.lobe.bsdf.is_wide() || p.wo.dot(p.ns) > 0.0;
    p.n = if faces { p.ns } else { p.ng };
    if p.bent && p.lobe.bsdf.is_reflector() {
        p.n = facing_normal(p.ns, p.ng, p.wo, p.lobe.alpha);
    }
}

/// The normal nearest to `ns` that mirrors most of a lobe of width `alpha` from `wo` to directions
/// above the surface, whose normal is `ng`. (For mirrors by Keller et al. 2017, "The iray light
/// transport simulation and rendering system", section 5.)
#[inline(never)]
pub fn facing_normal(ns: Vec3, ng: Vec3, wo: Vec3, alpha: Real) -> Vec3 {
    let wi = mirrored(wo, ns);
    let least = (2.0 * alpha).min(wo.dot(ng));
    let lift = least - wi.dot(ng);
    if lift <= 0.0 {
        return ns;
    }
    unit(wo + renormalized(wi + ng * lift))
}

/// Normal of a mirror: the shading normal, or the geometric one if the mirrored direction would
/// point below the surface.
#[inline(always)]
pub fn mirror_normal(p: &ShadingPoint) -> Vec3 {
    if mirrored(p.wo, p.n).dot(p.ng) <= 0.0 { p.ng } else { p.n }
}

/// Mirror direction and, for photons, its weight.
#[inline(always)]
pub fn reflected(p: &ShadingPoint, mode: u32) -> Sample {
    let n = mirror_normal(p);
    let wi = mirrored(p.wo, n);
    let mut weight = Vec3::ONE;
    if mode == IMPORTANCE {
        weight *= shading_correction(p, n, wi);
    }
    Sample { direction: wi, weight }
}

/// Axis of a cosine-weighted direction, and the weight that the axis implies.
#[derive(Clone, Copy, Debug)]
pub struct CosineAxis {
    /// Unit normal.
    pub axis: Vec3,
    /// Reflectance, with the correction of photons.
    pub weight: Vec3,
}

/// Axis of the directions that a diffuse surface scatters: the shading normal. For photons the
/// adjoint applies: they scatter about the geometric normal, with the weight of the shading normal
/// on arrival (Veach 1997, eq. 5.19).
#[inline(always)]
pub fn cosine_axis(p: &ShadingPoint, mode: u32) -> CosineAxis {
    let mut axis = p.n;
    let mut weight = p.lobe.reflectance;
    if mode == IMPORTANCE {
        axis = p.ng;
        if p.s.shading != p.s.normal {
            weight *= p.wo.dot(p.n).max(0.0) / p.wo.dot(p.ng).max(ADJOINT_COS_MIN);
        }
    }
    CosineAxis { axis, weight }
}

/// Density of a cosine-weighted direction about `n`: `cos / pi`, sr^-1.
#[inline(always)]
pub fn pdf_cosine(n: Vec3, wi: Vec3) -> Real {
    let cos = wi.dot(n);
    if cos <= 0.0 {
        return 0.0;
    }
    cos * INV_PI
}

/// Adjoint correction for shading normals in particle transport (Veach 1997, eq. 5.19); 1 if both
/// normals agree.
pub fn shading_correction(p: &ShadingPoint, n: Vec3, wi: Vec3) -> Real {
    if p.s.shading == p.s.normal {
        return 1.0;
    }
    let denominator = (p.wo.dot(p.ng) * wi.dot(n)).abs();
    if denominator <= 1e-6 {
        return 0.0;
    }
    (p.wo.dot(n) * wi.dot(p.ng)).abs() / denominator
}

/// `v` divided by its length.
#[inline(always)]
pub fn renormalized(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}
