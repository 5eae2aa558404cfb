//! Bodies of glass: which there are, which of them is the medium where they overlap, and in which of them
//! lamps and cameras lie.

use super::lights::shape::sample_shape;
use super::materials::enclosing::enclosing;
use super::materials::interior::medium_of;
use super::math::{EPS, FAR};
use super::real::{Real, ToReal, Vec2, Vec3};
use super::tables::*;
use crate::build::normalize::extent;
use crate::build::parts::{Part, TRIANGLES, parts};
use crate::scene::{self, MaterialKind, Mesh, ShapeKind};
use glam::DVec3;
use std::borrow::Cow;
use std::cmp::Reverse;

/// Parts of a mesh that are bodies of their own, at most.
const PARTS: usize = 256;
/// Length of a sheet's mean normal, over 1 for a flat one, below which it counts as closed.
const LEAST_FACING: f64 = 0.05;

type Box = (DVec3, DVec3);

/// A body of glass.
struct Body {
    material: usize,
    priority: i32,
    /// Nothing for a plane.
    extent: Option<Box>,
    /// Unit mean normal of an open one.
    facing: Option<DVec3>,
}

/// The bodies of a scene, in the order of the scene's shapes.
pub struct Bodies {
    bodies: Vec<Body>,
    /// For each shape its bodies' numbers: none, one, or one for each triangle.
    of: Vec<Vec<u32>>,
    /// Whether bodies may touch or hold one another.
    pub nested: bool,
}

impl Bodies {
    /// The bodies of `scene`, whose shapes are `kinds`.
    pub fn of(scene: &scene::Scene, kinds: &[Cow<ShapeKind>]) -> Self {
        let mut all = Self { bodies: Vec::new(), of: Vec::new(), nested: false };
        for (shape, kind) in scene.shapes.iter().zip(kinds) {
            let first = all.bodies.len() as u32;
            let MaterialKind::Glass { priority, .. } = scene.materials[shape.material].kind else {
                all.of.push(Vec::new());
                continue;
            };
            let body = |facing, extent| Body { material: shape.material, priority, extent, facing };
            if let ShapeKind::Mesh(mesh) = &**kind {
                let (found, numbers) = bodies_of_mesh(mesh);
                all.bodies.extend(found.into_iter().map(|part| body(part.0, Some(part.1))));
                all.of.push(numbers.into_iter().map(|number| first + number).collect());
                continue;
            }
            let facing = match &**kind {
                ShapeKind::Rectangle { u, v, .. } => Some(u.cross(*v).normalize_or_zero()),
                ShapeKind::Disc { normal, .. } | ShapeKind::Plane { normal, .. } => Some(*normal),
                ShapeKind::Revolution { segments, transform, .. } => {
                    let ends =
                        segments.first().and_then(|s| s.first()).zip(segments.last().and_then(|s| s.last()));
                    let open = ends.filter(|(a, b)| (a.x != 0.0 || b.x != 0.0) && a != b);
                    // of a profile from radius a to b the area vector is pi (b^2 - a^2) along -y
                    open.filter(|(a, b)| a.x != b.x)
                        .map(|(a, b)| transform.direction(DVec3::Y) * (a.x - b.x).signum())
                }
                ShapeKind::Sphere { .. } | ShapeKind::Cuboid { .. } | ShapeKind::Mesh(_) => None,
            };
            all.bodies.push(body(facing, extent(kind)));
            all.of.push(vec![first]);
        }
        let boxes = all.bodies.iter().map(|body| body.extent).collect();
        all.nested = any_meet(boxes, all.bodies.iter().filter(|body| body.extent.is_none()).count());
        all
    }

    /// Puts a material for each body into `out`, where one is needed: the least is that of the body that
    /// is the medium wherever it is. Returns for each shape the materials of its triangles, or one, and tells
    /// `sources` the scene's material of each of the tables'.
    pub fn pack(&self, scene: &scene::Scene, out: &mut Scene, sources: &mut Vec<u32>) -> Vec<Vec<u32>> {
        let own = |shape: &scene::Shape| vec![shape.material as u32];
        let mut materials: Vec<Vec<u32>> = scene.shapes.iter().map(own).collect();
        if !self.nested && self.bodies.iter().all(|body| body.facing.is_none()) {
            return materials;
        }
        let volume = |body: &Body| match body {
            Body { facing: None, extent: Some((low, high)), .. } => (*high - *low).element_product(),
            _ => f64::INFINITY,
        };
        let mut order: Vec<usize> = (0..self.bodies.len()).collect();
        order.sort_by(|a, b| {
            let [x, y] = [a, b].map(|k| &self.bodies[*k]);
            Reverse(x.priority).cmp(&Reverse(y.priority)).then(volume(x).total_cmp(&volume(y))).then(a.cmp(b))
        });
        out.world.body_first = out.materials.len() as u32;
        out.world.body_count = order.len() as u32;
        let mut place = vec![0; order.len()];
        sources.extend(0..out.materials.len() as u32);
        for k in order {
            let body = &self.bodies[k];
            place[k] = out.materials.len() as u32;
            sources.push(body.material as u32);
            let reflectance = body.facing.unwrap_or_default().to_real();
            out.materials.push(Material { reflectance, ..out.materials[body.material] });
        }
        for (numbers, materials) in self.of.iter().zip(&mut materials) {
            if !numbers.is_empty() {
                *materials = numbers.iter().map(|number| place[*number as usize]).collect();
            }
        }
        materials
    }
}

/// The bodies of a mesh, each with its mean normal, if it is open, and its box; and the body of each
/// triangle, or one for all.
fn bodies_of_mesh(mesh: &Mesh) -> (Vec<(Option<DVec3>, Box)>, Vec<u32>) {
    let whole = |facing: Option<DVec3>| {
        let hull = mesh
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        (vec![(facing, hull)], vec![0])
    };
    if mesh.triangles.len() > TRIANGLES {
        return whole(None);
    }
    let (parts, of) = parts(mesh);
    let open = |parts: &[Part]| {
        let facing: DVec3 = parts.iter().map(|part| part.facing).sum();
        let area: f64 = parts.iter().map(|part| part.area).sum();
        let closed = parts.iter().all(|part| part.closed) || facing.length() <= LEAST_FACING * area;
        (!closed).then(|| facing.normalize_or_zero())
    };
    let boxes = parts.iter().map(|part| Some((part.low, part.high))).collect();
    if parts.len() <= 1 || parts.len() > PARTS || !any_meet(boxes, 0) {
        return whole(open(&parts));
    }
    // the inner wall of a hollow body belongs to the body
    let body_of = |k: usize| {
        let part = &parts[k];
        let hollow = part.closed && part.volume < 0.0;
        let around = |other: &&usize| parts[**other].volume > 0.0 && parts[**other].holds(part);
        let size = |other: &usize| (parts[*other].high - parts[*other].low).element_product();
        let all: Vec<usize> = (0..parts.len()).collect();
        let outer = all.iter().filter(around).min_by(|a, b| size(a).total_cmp(&size(b)));
        if hollow { outer.copied().unwrap_or(k) } else { k }
    };
    let bodies: Vec<u32> = (0..parts.len()).map(|k| body_of(k) as u32).collect();
    if bodies.iter().all(|body| *body == bodies[0]) {
        return whole(open(&parts));
    }
    let found = parts.iter().map(|part| (open(std::slice::from_ref(part)), (part.low, part.high)));
    (found.collect(), of.iter().map(|part| bodies[*part as usize]).collect())
}

/// Whether two of some boxes meet, within a rounding; `unbounded` more meet everything.
fn any_meet(boxes: Vec<Option<Box>>, unbounded: usize) -> bool {
    if unbounded > 0 && boxes.len() > 1 {
        return true;
    }
    let mut boxes: Vec<Box> = boxes.into_iter().flatten().collect();
    boxes.sort_by(|a, b| a.0.x.total_cmp(&b.0.x));
    boxes.iter().enumerate().any(|(i, (low, high))| {
        let slack = DVec3::splat(1e-6 * low.abs().max(high.abs()).max_element());
        let (low, high) = (*low - slack, *high + slack);
        let mut near = boxes[i + 1..].iter().take_while(|b| b.0.x <= high.x);
        near.any(|b| b.0.cmple(high).all() && b.1.cmpge(low).all())
    })
}

/// Tells of each lamp whether all of it lies in one body of glass, in none, or astride.
pub fn stand_lights(out: &mut Scene) {
    for i in 0..out.lights.len() {
        let light = &out.lights[i];
        out.lights[i].medium = match light.kind {
            LIGHT_AREA => {
                let index = (light.reference & ((1 << REFERENCE_BITS) - 1)) as usize;
                let p = sample_shape(out, light, Vec2::splat(0.5), 0.5);
                let (low, high) = lamp_box(out, light.reference >> REFERENCE_BITS, index);
                medium_of_box(out, p.position + p.normal * p.error, low, high)
            }
            LIGHT_POINT | LIGHT_SPOT => medium_of_box(out, light.position, light.position, light.position),
            _ => NONE,
        };
    }
}

/// The same of the camera's lens.
pub fn stand_camera(out: &mut Scene) {
    let camera = &out.camera;
    let half = Vec3::splat(camera.aperture);
    out.camera.medium = medium_of_box(out, camera.position, camera.position - half, camera.position + half);
}

/// The medium of all of a box, as the surroundings of `position` in it tell.
fn medium_of_box(out: &Scene, position: Vec3, low: Vec3, high: Vec3) -> u32 {
    if out.materials.iter().all(|m| m.kind != MATERIAL_GLASS) {
        return NONE;
    }
    let interior = enclosing(out, position);
    if low != high && glass_crosses(out, low, high) || interior.bodies[1] != NONE {
        return ASTRIDE;
    }
    medium_of(&interior)
}

/// The box of a lamp in the tables, of a revolution with all that it may reach.
fn lamp_box(out: &Scene, kind: u32, index: usize) -> (Vec3, Vec3) {
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

/// Whether some surface of glass may cross a box.
fn glass_crosses(out: &Scene, low: Vec3, high: Vec3) -> bool {
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

/// Whether the shape that `reference` names is of glass and its surface may cross a box.
fn reference_crosses(out: &Scene, reference: u32, low: Vec3, high: Vec3) -> bool {
    let index = (reference & ((1 << REFERENCE_BITS) - 1)) as usize;
    let glass = |material: u32| out.materials[material as usize].kind == MATERIAL_GLASS;
    let meets = |(a, b): (Vec3, Vec3)| a.cmple(high).all() && b.cmpge(low).all();
    let box_of = |kind| lamp_box(out, kind, index);
    match reference >> REFERENCE_BITS {
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
        _ => {
            let plane = &out.planes[index];
            let middle = plane.normal.dot((low + high) * 0.5 - plane.point);
            let half = plane.normal.abs().dot((high - low) * 0.5);
            glass(plane.material) && middle.abs() <= half
        }
    }
}
