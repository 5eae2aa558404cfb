//! Checks of shapes.

use glam::DVec3;

use crate::scene::diagnostics::Report;
use crate::scene::numbers::{LARGEST, SMALLEST};
use crate::scene::parts::Part;
use crate::scene::{Shape, ShapeKind, extent as bounds};

/// Smallest sine of the angle between the edges of a rectangle.
const LEAST_SINE: f64 = 1e-12;

/// Reports shapes without an extent, shapes that emit infinite power, and shapes whose transform
/// enlarges them beyond the range of renderers. `shapes` come from one part.
pub(crate) fn shapes(report: &mut Report, part: &dyn Part, shapes: &[Shape]) {
    for shape in shapes {
        extent(report, part, &shape.kind);
        if matches!(shape.kind, ShapeKind::Plane { .. }) && shape.emission != [0.0; 3] {
            let message = "an infinite plane cannot emit: its power would be infinite";
            let help = Some("use a rectangle or an [environment]".to_owned());
            let label = "expected no emission here";
            report.error(part.span_of("emission"), message, label, help);
        }
    }
    let reach = shapes.iter().map(|shape| reach(&shape.kind)).fold(0.0, f64::max);
    if reach > LARGEST {
        too_far(report, part, reach);
    }
}

/// Reports shapes that a map moved out of the range of renderers.
pub(crate) fn moved(report: &mut Report, part: &dyn Part, shapes: &[Shape]) {
    let reach = shapes.iter().map(|shape| far(&shape.kind)).fold(0.0, f64::max);
    if !reach.is_finite() || reach > LARGEST {
        too_far(report, part, reach);
    }
}

fn too_far(report: &mut Report, part: &dyn Part, reach: f64) {
    let message =
        format!("{} reaches to {reach:.1e}, too large for single precision", part.place());
    let label = format!("expected coordinates of at most {LARGEST:e} after the transform");
    report.error(part.span_of("transform"), message, label, None);
}

/// Largest coordinate of a shape in magnitude.
fn far(kind: &ShapeKind) -> f64 {
    let largest = |v: DVec3| v.abs().max_element();
    match (kind, bounds(kind)) {
        (ShapeKind::Plane { point, .. }, _) => largest(*point),
        (_, found) => found.map_or(0.0, |(low, high)| largest(low).max(largest(high))),
    }
}

/// Reports a rectangle without area and a box without volume.
fn extent(report: &mut Report, part: &dyn Part, kind: &ShapeKind) {
    match kind {
        ShapeKind::Rectangle { u, v, .. } => {
            let least = (LEAST_SINE * u.length() * v.length()).max(SMALLEST * SMALLEST);
            if u.cross(*v).length() <= least {
                let message =
                    format!("{} has no area: `u` and `v` are parallel or 0", part.place());
                let label = "expected an edge in another direction than `u`";
                report.error(part.span_of("v"), message, label, None);
            }
        }
        ShapeKind::Cuboid { min, max } => {
            if let Some(axis) = (0..3).find(|&axis| max[axis] - min[axis] < SMALLEST) {
                let name = ["x", "y", "z"][axis];
                let message = format!(
                    "{} is empty: min.{name} = {}, max.{name} = {}",
                    part.place(),
                    min[axis],
                    max[axis]
                );
                let label = format!("expected {name} greater than {}", min[axis]);
                report.error(part.span_of("max"), message, label, None);
            }
        }
        ShapeKind::Sphere { .. }
        | ShapeKind::Disc { .. }
        | ShapeKind::Plane { .. }
        | ShapeKind::Mesh(_)
        | ShapeKind::Revolution { .. }
        | ShapeKind::Instance { .. } => {}
    }
}

/// Largest coordinate of a transformed shape in magnitude, without its translation where the
/// transform is part of the description; 0 for shapes without a transform.
fn reach(kind: &ShapeKind) -> f64 {
    match kind {
        ShapeKind::Mesh(mesh) => {
            mesh.positions.iter().map(|position| position.abs().max_element()).fold(0.0, f64::max)
        }
        ShapeKind::Revolution { segments, transform, .. } => {
            let points = segments.iter().flatten();
            let reach = points.map(|point| point.abs().max_element()).fold(0.0, f64::max);
            reach * transform.scale
        }
        ShapeKind::Sphere { .. }
        | ShapeKind::Rectangle { .. }
        | ShapeKind::Disc { .. }
        | ShapeKind::Plane { .. }
        | ShapeKind::Cuboid { .. }
        | ShapeKind::Instance { .. } => 0.0,
    }
}
