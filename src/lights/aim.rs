//! Photons that scatter far outside, aimed back at the scene. Twin: `shaders/lights/aim.wgsl`.
//!
//! Light from infinity that falls on wide ground far away carries a flux that grows with the square
//! of its distance and returns to the scene with a probability that falls faster: few photons bring
//! it, each a bright dot. So half of the directions that a diffuse surface sends from far outside
//! are drawn from the cone about the sphere of radius `near_radius`, by the one-sample model with
//! the balance heuristic (Veach & Guibas 1995); roulette then measures the flux against what a
//! photon through the narrowest emission disc carries.

use super::materials::Bsdf;
use super::materials::shading::{Scatter, ShadingPoint};
use super::math::sampling::sample_cone;
use super::math::{INV_PI, TAU, from_frame, unit};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::tables::*;

/// Square of the distance, in near radii, from which on photons are aimed.
const FAR_OUTSIDE_SQ: Real = 4.0;

/// `scattered`, which a diffuse surface drew by its cosine from `u.xy`, or a direction into the
/// cone about the scene in its place, `u.z` deciding, with the weight of the mixture of both.
pub fn aimed_scatter(scene: &Scene, at: &ShadingPoint, u: Vec4, scattered: Scatter) -> Scatter {
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
        // by the sine: the cosine of a narrow cone has no digits left
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
