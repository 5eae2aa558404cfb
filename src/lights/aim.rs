//! Redirection of photons that scatter far from the scene back towards it. Twin:
//! `shaders/lights/aim.wgsl`.
//!
//! Light from infinity that falls on distant ground carries a flux that grows with the square of
//! its distance and returns to the scene with a probability that falls faster: few photons carry
//! it, each a bright dot. Half of the directions that a diffuse surface scatters far outside are
//! therefore sampled from the cone about the sphere of radius `near_radius`, by the one-sample
//! model with the balance heuristic (Veach & Guibas 1995); roulette then compares the flux with
//! that of a photon through the narrowest emission disc.

use super::materials::Bsdf;
use super::materials::shading::{Scatter, ShadingPoint};
use super::math::sampling::sample_cone;
use super::math::{INV_PI, TAU, from_frame, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::tables::*;

/// Square of the distance, in near radii, from which photons are redirected.
const FAR_OUTSIDE_SQ: Real = 4.0;

/// Samples the mixture of the cosine and of the cone about the scene, at a distant diffuse surface.
/// `scattered` is the cosine sample drawn from `u.xy`; if `u.z` is below 0.5, a direction in the
/// cone replaces it. The weight is that of the mixture.
pub fn aimed_scatter(
    scene: &SceneTables,
    at: &ShadingPoint,
    u: Vec4,
    scattered: Scatter,
) -> Scatter {
    let p = at.s.position - scene.world.near_center;
    let distance_sq = p.dot(p);
    let radius_sq = scene.world.near_radius * scene.world.near_radius;
    if at.lobe.bsdf != Bsdf::Diffuse || distance_sq < FAR_OUTSIDE_SQ * radius_sq {
        return scattered;
    }
    let axis = -unit(p);
    let sin_sq = radius_sq / distance_sq;
    let one_minus_cos = sin_sq / (1.0 + (1.0 - sin_sq).sqrt());
    let mut wi = scattered.direction;
    let mut in_cone = true;
    if u.z < 0.5 {
        wi = unit(from_frame(axis, sample_cone(Vec2::new(u.x, u.y), one_minus_cos)));
    } else {
        // test by the sine: the cosine of a narrow cone loses all digits
        let across = wi.cross(axis);
        in_cone = wi.dot(axis) > 0.0 && across.dot(across) < sin_sq;
    }
    let cos = wi.dot(at.ng);
    if cos <= 0.0 {
        return Scatter { direction: wi, interior: scattered.interior, weight: Vec3::ZERO };
    }
    let by_cosine = INV_PI * cos;
    let by_cone = if in_cone { 1.0 / (TAU * one_minus_cos) } else { 0.0 };
    let weight = scattered.weight * (by_cosine / (0.5 * by_cosine + 0.5 * by_cone));
    Scatter { direction: wi, interior: scattered.interior, weight }
}
