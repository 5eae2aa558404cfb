//! Emission of photons from suns and environments. Twin: `shaders/lights/infinity.wgsl`.

use super::LightKind;
use super::emission::Emission;
use super::environment::{eval_environment, pdf_environment, sample_environment};
use super::guide::{GUIDED, guided, pdf_guide};
use super::materials::interior::interior_from;
use super::math::sampling::sample_disc;
use super::math::{EPS, FAR, PI, basis};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::{find_interval, share_of};
use super::shapes::ray::Ray;
use super::sun_disc::{pdf_sun_disc, sample_sun_disc};
use super::tables::*;

/// Emits a photon of light from infinity. It passes through one of the emission discs about what
/// the camera sees, each twice as wide as the one before; or, if the light has a guide map, with
/// probability [`GUIDED`] through a cell of the square about the near disc. The balance heuristic
/// combines both densities.
#[inline(always)]
pub fn emit_from_infinity(scene: &SceneTables, light: &Light, u: Vec4, v: Vec4) -> Emission {
    let near = scene.world.near_radius;
    let mut ray = Ray { origin: Vec3::ZERO, t_min: 0.0, direction: light.direction, t_max: FAR };
    let mut radiance = light.color;
    if LightKind::of(light.kind).is_environment() {
        let w = sample_environment(scene, light, u);
        ray.direction = -w;
        radiance = eval_environment(scene, light, w) * (1.0 / pdf_environment(scene, light, w));
    }
    if LightKind::of(light.kind) == LightKind::SunDisc {
        ray.direction = -sample_sun_disc(light, u);
        radiance = light.color * (1.0 / pdf_sun_disc(light));
    }
    // choose a point on a disc or in the map's square
    let across = Vec2::new(v.x, v.y);
    let level = find_interval(scene, scene.world.disc_first, scene.world.disc_levels, v.z);
    let mut d = sample_disc(across) * disc_radius(scene, level);
    if light.guide != 0 && v.w < GUIDED {
        d = guided(scene, light, across, v.w * (1.0 / GUIDED)).0;
        d = (d * 2.0 - Vec2::ONE) * near;
    }
    // density per area of that point
    let mut pdf = pdf_discs(scene, d.dot(d));
    if light.guide != 0 {
        let by_map =
            pdf_guide(scene, light, (d * (1.0 / near) + Vec2::ONE) * 0.5) / (4.0 * near * near);
        pdf = GUIDED * by_map + (1.0 - GUIDED) * pdf;
    }
    // start far behind the plane of the discs
    let (tangent, bitangent) = basis(ray.direction);
    ray.origin = scene.world.near_center + tangent * d.x + bitangent * d.y;
    ray.t_min = -4.0 * disc_radius(scene, scene.world.disc_levels - 1);
    let flux = radiance * (1.0 / (pdf * light.selection));
    let usual = pdf_discs(scene, 0.25 * near * near);
    Emission {
        ray,
        flux,
        relative_flux: usual / pdf,
        interior: interior_from(scene, ray.direction),
        extended: false,
    }
}

/// Radius of emission disc `level`, which is at most 31, scene units.
pub fn disc_radius(scene: &SceneTables, level: u32) -> Real {
    scene.world.disc_radius * (1u32 << level) as Real
}

/// Density per area, at squared distance `r_sq` from the centre, of a point on a randomly chosen
/// emission disc.
pub fn pdf_discs(scene: &SceneTables, r_sq: Real) -> Real {
    let mut radius = scene.world.disc_radius;
    let mut sum = 0.0;
    for level in 0..scene.world.disc_levels {
        if r_sq <= radius * (radius * (1.0 + 16.0 * EPS)) {
            sum += share_of(scene, scene.world.disc_first, level) / (PI * radius * radius);
        }
        radius *= 2.0;
    }
    sum
}
