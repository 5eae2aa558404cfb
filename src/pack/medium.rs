//! The glass in which cameras and lights stand.

use super::math::{FAR, offset_origin, unit};
use super::real::Vec3;
use super::shapes::intersect::intersect_scene;
use super::shapes::ray::Ray;
use super::shapes::surface::surface_at;
use super::tables::*;
use crate::build::normalize::extent;
use crate::scene;
use glam::DVec3;

/// Surfaces that one look passes through at most.
const CROSSINGS: u32 = 1000;
/// Directions of the looks; askew, so that they seldom meet edges of what people build.
const LOOKS: [Vec3; 5] = [
    Vec3::new(0.31, 0.89, 0.33),
    Vec3::new(-0.77, 0.23, 0.59),
    Vec3::new(0.53, -0.71, 0.46),
    Vec3::new(-0.37, -0.41, -0.83),
    Vec3::new(0.67, 0.47, -0.57),
];

/// The glass material around `position`, or [`NONE`]. All looks must agree: an open sheet of glass is left behind in
/// some directions only and has no inside.
pub fn medium_at(scene: &Scene, position: Vec3) -> u32 {
    if scene.materials.iter().all(|m| m.kind != MATERIAL_GLASS) {
        return NONE;
    }
    let first = innermost(scene, position, LOOKS[0]);
    let agree = LOOKS[1..].iter().all(|look| first == NONE || innermost(scene, position, *look) == first);
    if agree { first } else { NONE }
}

/// The glass that a ray leaves first without having entered it.
fn innermost(scene: &Scene, position: Vec3, look: Vec3) -> u32 {
    let direction = unit(look);
    let mut origin = position;
    let mut entered = 0;
    for _ in 0..CROSSINGS {
        let ray = Ray { origin, t_min: 0.0, direction, t_max: FAR };
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            break;
        }
        let s = surface_at(scene, &ray, &hit);
        if scene.materials[s.material as usize].kind == MATERIAL_GLASS {
            if direction.dot(s.normal) < 0.0 {
                entered += 1;
            } else if entered > 0 {
                entered -= 1;
            } else {
                return s.material;
            }
        }
        origin = offset_origin(s.position, s.error, s.normal, direction);
    }
    NONE
}

/// Whether bodies of glass may touch or hold one another: boxes of two of them meet, within a rounding.
pub fn glass_meets_glass(scene: &scene::Scene) -> bool {
    let is_glass =
        |s: &&scene::Shape| matches!(scene.materials[s.material].kind, scene::MaterialKind::Glass { .. });
    let mut boxes: Vec<(DVec3, DVec3)> =
        scene.shapes.iter().filter(is_glass).filter_map(|s| extent(&s.kind)).collect();
    boxes.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    boxes.iter().enumerate().any(|(i, (low, high))| {
        let slack = DVec3::splat(1e-6 * low.abs().max(high.abs()).max_element());
        let (low, high) = (*low - slack, *high + slack);
        let mut near = boxes[i + 1..].iter().take_while(|b| b.0.x <= high.x);
        near.any(|b| b.0.cmple(high).all() && b.1.cmpge(low).all())
    })
}
