//! Packs glass bodies into the tables and determines the media of lamps and the camera.

use super::camera::ProjectionKind;
use super::lights::LightKind;
use super::lights::shape::sample_shape;
use super::materials::Bsdf;
use super::materials::enclosing::enclosing;
use super::materials::interior::medium_of;
use super::math::{EPS, FAR};
use super::real::{Real, ToReal, Vec2, Vec3};
use super::shapes::instance::placed_point;
use super::tables::*;
use crate::prepare::bodies::Bodies;
use crate::scene::{self, numbers::WIDEST_FILTER};

/// Appends a material for each body to `out`, in the order of rank, if the scene needs them.
/// Returns for each shape the material indices of its triangles, or a single one. Fills `sources`
/// with the scene material index of each table entry.
pub fn pack_bodies(
    scene: &scene::Scene,
    bodies: &Bodies,
    out: &mut SceneTables,
    sources: &mut Vec<u32>,
) -> Vec<Vec<u32>> {
    out.world.nested = bodies.nested as u32;
    let own = |shape: &scene::Shape| vec![shape.material as u32];
    let mut materials: Vec<Vec<u32>> = scene.shapes.iter().map(own).collect();
    if !bodies.nested && bodies.all.iter().all(|body| body.facing.is_none()) {
        return materials;
    }
    out.world.body_first = out.materials.len() as u32;
    out.world.body_count = bodies.all.len() as u32;
    let mut place = vec![0; bodies.all.len()];
    sources.extend(0..out.materials.len() as u32);
    for k in bodies.ranking() {
        let body = &bodies.all[k];
        place[k] = out.materials.len() as u32;
        sources.push(body.material as u32);
        let reflectance = body.facing.unwrap_or_default().to_real();
        out.materials.push(Material { reflectance, ..out.materials[body.material] });
    }
    for (numbers, materials) in bodies.of.iter().zip(&mut materials) {
        if !numbers.is_empty() {
            *materials = numbers.iter().map(|number| place[*number as usize]).collect();
        }
    }
    materials
}

/// Sets the medium of each lamp.
pub fn stand_lights(out: &mut SceneTables) {
    for i in 0..out.lights.len() {
        let light = &out.lights[i];
        out.lights[i].medium = match LightKind::of(light.kind) {
            LightKind::Area => {
                let index = index_of(light.reference) as usize;
                let p = sample_shape(out, light, Vec2::splat(0.5), 0.5);
                let (low, high) = lamp_box(out, kind_of(light.reference), index);
                medium_of_box(out, p.position + p.normal * p.error, low, high)
            }
            LightKind::Point | LightKind::Spot => {
                medium_of_box(out, light.position, light.position, light.position)
            }
            LightKind::Sun | LightKind::SunDisc | LightKind::Constant | LightKind::Image => NONE,
        };
    }
}

/// Sets the medium of the camera's lens.
pub fn stand_camera(out: &mut SceneTables) {
    let camera = &out.camera;
    let half = Vec3::splat(camera.aperture) + start_box(camera);
    out.camera.medium =
        medium_of_box(out, camera.position, camera.position - half, camera.position + half);
}

/// Half the bounding box of the points that rays start from, for a pinhole.
fn start_box(camera: &Camera) -> Vec3 {
    match ProjectionKind::of(camera.projection) {
        ProjectionKind::Orthographic => {
            // the filter reaches beyond the image
            let pixel = Vec3::splat(WIDEST_FILTER as Real * camera.pixel);
            camera.right.abs() + camera.up.abs() + pixel
        }
        ProjectionKind::Perspective | ProjectionKind::Panorama | ProjectionKind::Fisheye => {
            Vec3::ZERO
        }
    }
}

/// Medium of everything in a box around `position`: a material index, [`NONE`], or [`ASTRIDE`] if a
/// glass face crosses the box or several bodies contain it.
fn medium_of_box(out: &SceneTables, position: Vec3, low: Vec3, high: Vec3) -> u32 {
    if out.materials.iter().all(|m| !Bsdf::of(m.kind).is_body()) {
        return NONE;
    }
    let interior = enclosing(out, position);
    if low != high && glass_crosses(out, low, high) || interior.bodies[1] != NONE {
        return ASTRIDE;
    }
    medium_of(&interior)
}

/// Bounding box of a packed shape; conservative for surfaces of revolution.
fn lamp_box(out: &SceneTables, kind: u32, index: usize) -> (Vec3, Vec3) {
    let hull = |points: &[Vec3]| {
        let low = points.iter().fold(Vec3::splat(FAR), |a, p| a.min(*p));
        (low, points.iter().fold(Vec3::splat(-FAR), |a, p| a.max(*p)))
    };
    match kind {
        KIND_TRIANGLE => {
            let t = &out.triangles[index];
            hull(&[t.p0, t.p1, t.p2])
        }
        KIND_SPHERE => {
            let s = &out.spheres[index];
            let center = s.anchor - s.normal * s.radius;
            (center - Vec3::splat(s.radius), center + Vec3::splat(s.radius))
        }
        KIND_RECTANGLE => {
            let r = &out.rectangles[index];
            hull(&[r.origin, r.origin + r.u, r.origin + r.v, r.origin + r.u + r.v])
        }
        KIND_DISC => {
            let d = &out.discs[index];
            (d.center - Vec3::splat(d.radius), d.center + Vec3::splat(d.radius))
        }
        KIND_CUBOID => (out.cuboids[index].lower, out.cuboids[index].upper),
        _ => {
            let reach = |p: &Patch| p.r_max.max(p.y_min.abs()).max(p.y_max.abs());
            let own = out.patches.iter().filter(|p| p.revolution as usize == index);
            let r = &out.revolutions[index];
            let half = Vec3::splat(2.0 * own.map(reach).fold(0.0, Real::max) * r.scale);
            (r.center - half, r.center + half)
        }
    }
}

/// Bounding box of an instance.
fn instance_box(instance: &Instance, group: &Group) -> (Vec3, Vec3) {
    let middle = (group.bounds_min + group.bounds_max) * 0.5;
    let half = (group.bounds_max - group.bounds_min) * 0.5;
    let center = placed_point(instance, middle);
    let around = instance.column_x.abs() * half.x
        + instance.column_y.abs() * half.y
        + instance.column_z.abs() * half.z;
    let around = around + Vec3::splat(instance.rounding);
    (center - around, center + around)
}

/// Returns whether a glass face may cross a box.
fn glass_crosses(out: &SceneTables, low: Vec3, high: Vec3) -> bool {
    let slack = Vec3::splat(64.0 * EPS * low.abs().max(high.abs()).max_element());
    let (low, high) = (low - slack, high + slack);
    let crosses = |reference: &u32| reference_crosses(out, *reference, low, high);
    if out.unbounded.iter().any(crosses) {
        return true;
    }
    let mut waiting = if out.nodes.is_empty() { Vec::new() } else { vec![0] };
    while let Some(at) = waiting.pop() {
        let node = out.nodes[at as usize];
        if node.is_leaf() {
            if out.refs[node.range()].iter().any(crosses) {
                return true;
            }
            continue;
        }
        let (axis, position, children) = node.plane();
        if low[axis] <= position {
            waiting.push(children);
        }
        if high[axis] >= position {
            waiting.push(children + 1);
        }
    }
    false
}

/// Returns whether `reference` is a glass shape whose surface may cross a box.
fn reference_crosses(out: &SceneTables, reference: u32, low: Vec3, high: Vec3) -> bool {
    let index = index_of(reference) as usize;
    let glass = |material: u32| Bsdf::of(out.materials[material as usize].kind).is_body();
    let meets = |(a, b): (Vec3, Vec3)| a.cmple(high).all() && b.cmpge(low).all();
    let box_of = |kind| lamp_box(out, kind, index);
    match kind_of(reference) {
        KIND_TRIANGLE => glass(out.triangles[index].material) && meets(box_of(KIND_TRIANGLE)),
        KIND_RECTANGLE => glass(out.rectangles[index].material) && meets(box_of(KIND_RECTANGLE)),
        KIND_DISC => glass(out.discs[index].material) && meets(box_of(KIND_DISC)),
        KIND_SPHERE => {
            let s = &out.spheres[index];
            let center = s.anchor - s.normal * s.radius;
            let farthest = (low - center).abs().max((high - center).abs()).length();
            glass(s.material) && meets(box_of(KIND_SPHERE)) && farthest >= s.radius * (1.0 - 1e-4)
        }
        KIND_CUBOID => {
            let c = &out.cuboids[index];
            let inside = low.cmpgt(c.lower).all() && high.cmplt(c.upper).all();
            glass(c.material) && !inside && meets((c.lower, c.upper))
        }
        KIND_REVOLUTION => {
            let revolution = out.patches[index].revolution as usize;
            let own = lamp_box(out, KIND_REVOLUTION, revolution);
            glass(out.revolutions[revolution].material) && meets(own)
        }
        KIND_INSTANCE => {
            let instance = &out.instances[index];
            let group = &out.groups[instance.group as usize];
            // the material of glass, which is the only shape of its group
            let own = instance.material != NONE && glass(instance.material);
            own && meets(instance_box(instance, group))
        }
        _ => {
            let plane = &out.planes[index];
            let middle = plane.normal.dot((low + high) * 0.5 - plane.point);
            let half = plane.normal.abs().dot((high - low) * 0.5);
            glass(plane.material) && middle.abs() <= half
        }
    }
}
