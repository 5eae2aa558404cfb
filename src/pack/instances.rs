//! Groups of shapes, each packed once in object space, and their instances.

use super::accel::kdtree;
use super::math::EPS;
use super::order::triangles_as_met;
use super::real::{Real, ToDouble, ToReal};
use super::shape::{Input, pack_shapes};
use super::shapes::aabb::Aabb;
use super::tables::*;
use super::{PackError, accel};
use crate::prepare::normalize::Normalization;
use crate::scene::{self, ShapeKind};
use glam::{DAffine3, DVec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Bound on the error of a nearby ray in a group's space, relative to the sums of the magnitudes of
/// the products that make its coordinates: about 17 roundings of origin, matrix and direction.
const RAY_ERROR: f64 = 32.0;
/// Bound on the error of a position, relative to its coordinates: about 6 roundings.
const POSITION_ERROR: f64 = 16.0;
/// Distance of the origin of a transformed ray from the center plus that of the hit, relative to
/// the radius of the bounding sphere (`object_ray` moves it that near).
const NEAR: f64 = 3.5;

/// A group in separate tables.
pub struct PackedGroup {
    tables: SceneTables,
    tree: accel::kdtree::KdTree,
    normalization: Normalization,
}

/// All groups of a scene.
#[derive(Default)]
pub struct PackedGroups {
    all: Vec<PackedGroup>,
    /// Index of each group by its address.
    numbers: HashMap<*const scene::Group, usize>,
}

/// Packs each group that a shape of the scene places.
///
/// # Errors
/// [`PackError`] if a group contains a plane or an instance, or has too many shapes.
pub fn pack_groups(
    scene: &scene::Scene,
    kinds: &[Cow<ShapeKind>],
) -> Result<PackedGroups, PackError> {
    let mut groups = PackedGroups::default();
    for (i, kind) in kinds.iter().enumerate() {
        let ShapeKind::Instance { group, .. } = &**kind else { continue };
        if groups.numbers.contains_key(&Arc::as_ptr(group)) {
            continue;
        }
        groups.numbers.insert(Arc::as_ptr(group), groups.all.len());
        groups.all.push(packed(scene, group).map_err(|error| match error {
            PackError::Profile { cause, .. } => PackError::Profile { shape: i, cause },
            PackError::Group { .. } => PackError::Group { shape: i },
            other @ PackError::TooMany { .. } => other,
        })?);
    }
    Ok(groups)
}

fn packed(scene: &scene::Scene, group: &scene::Group) -> Result<PackedGroup, PackError> {
    let foreign = |shape: &scene::Shape| {
        matches!(shape.kind, ShapeKind::Plane { .. } | ShapeKind::Instance { .. })
    };
    if group.shapes().iter().any(foreign) {
        return Err(PackError::Group { shape: 0 });
    }
    let (low, high) = group.bounds().unwrap_or_default();
    let radius = (0.5 * low.distance(high)).max(f64::MIN_POSITIVE.sqrt());
    let n = Normalization::about(0.5 * (low + high), radius);
    let mut tables = SceneTables::empty();
    let kinds: Vec<Cow<ShapeKind>> =
        group.shapes().iter().map(|shape| Cow::Borrowed(&shape.kind)).collect();
    let materials: Vec<Vec<u32>> =
        group.shapes().iter().map(|shape| vec![shape.material as u32]).collect();
    let input =
        Input { shapes: group.shapes(), kinds: &kinds, materials: &materials, groups: None };
    let (primitives, references, _) = pack_shapes(scene, input, &n, &mut tables, None)?;
    let tree = kdtree::build(&primitives);
    tables.nodes = tree.nodes.clone();
    tables.refs = tree.refs.iter().map(|&i| references[i as usize]).collect();
    triangles_as_met(&mut tables, &mut []);
    Ok(PackedGroup { tables, tree, normalization: n })
}

impl PackedGroup {
    /// The instance number `index` of this group at `map` in a scene with normalization `n`, and a
    /// box in scene space that contains all of its computed hits.
    pub fn placed(&self, index: usize, map: &DAffine3, n: &Normalization) -> (Instance, Aabb) {
        let own = &self.normalization;
        // to scene space from the group's, whose origin becomes the middle of its box
        let linear = map.matrix3 * (own.unit / n.unit);
        let inverse = map.matrix3.inverse() * (n.unit / own.unit);
        let (low, high) = (self.tree.bounds.min.to_double(), self.tree.bounds.max.to_double());
        let half = low.abs().max(high.abs());
        let center = n.point(map.transform_point3(own.center));
        let reach = linear.abs() * half;
        let corner = |k: usize| {
            let side = |axis: usize| if k >> axis & 1 == 1 { high[axis] } else { low[axis] };
            linear * DVec3::new(side(0), side(1), side(2))
        };
        let radius = (0..8).map(|k| corner(k).length()).fold(0.0, f64::max);
        let eps = f64::from(EPS);
        let slack = inverse.abs() * reach * (RAY_ERROR * eps);
        let size = center.abs().max_element() + reach.max_element();
        // errors of the ray near the instance, moved back to scene space
        let ray = linear.abs() * (inverse.abs() * DVec3::splat(NEAR * radius));
        let pad = ray * (RAY_ERROR * eps) + DVec3::splat(2.0 * POSITION_ERROR * eps * size);
        let middle = center + linear * (0.5 * (low + high));
        let around = linear.abs() * (0.5 * (high - low)) + pad;
        let rows = inverse.transpose();
        let instance = Instance {
            row_x: rows.x_axis.to_real(),
            group: index as u32,
            row_y: rows.y_axis.to_real(),
            material: NONE,
            row_z: rows.z_axis.to_real(),
            uv: UV_NATURAL,
            center: center.to_real(),
            reach: (2.0 * radius * (1.0 + 1e-5)) as Real,
            column_x: linear.x_axis.to_real(),
            rounding: (POSITION_ERROR * eps * size) as Real,
            column_y: linear.y_axis.to_real(),
            pad0: 0,
            column_z: linear.z_axis.to_real(),
            pad1: 0,
            slack: slack.to_real(),
            pad2: 0,
        };
        (instance, Aabb { min: (middle - around).to_real(), max: (middle + around).to_real() })
    }
}

impl PackedGroups {
    /// Index of a group, and its tables.
    pub fn of(&self, group: &Arc<scene::Group>) -> Option<(usize, &PackedGroup)> {
        let index = *self.numbers.get(&Arc::as_ptr(group))?;
        Some((index, self.all.get(index)?))
    }

    /// Appends the tables of all groups to those of the scene.
    ///
    /// # Errors
    /// [`PackError`] if there are more shapes than references can name.
    pub fn append(self, out: &mut SceneTables) -> Result<(), PackError> {
        for group in self.all {
            append(out, group)?;
        }
        Ok(())
    }
}

fn append(
    out: &mut SceneTables,
    PackedGroup { tables, tree, .. }: PackedGroup,
) -> Result<(), PackError> {
    // nodes of the scene, which has at least the tree of the instances, end at an even number
    let group = Group {
        bounds_min: tree.bounds.min,
        root: out.nodes.len() as u32,
        bounds_max: tree.bounds.max,
        first_ref: out.refs.len() as u32,
        primitive_size: tree.primitive_size,
        pad: [0; 3],
    };
    out.groups.push(group);
    let first = |kind| match kind {
        KIND_TRIANGLE => out.triangles.len(),
        KIND_SPHERE => out.spheres.len(),
        KIND_RECTANGLE => out.rectangles.len(),
        KIND_DISC => out.discs.len(),
        KIND_CUBOID => out.cuboids.len(),
        _ => out.patches.len(),
    } as u32;
    out.nodes.extend(tree.nodes);
    let refs: Vec<u32> = tables.refs.iter().map(|r| r + first(kind_of(*r))).collect();
    out.refs.extend(refs);
    let attributes = out.attributes.len() as u32;
    let moved = |t: Triangle| Triangle {
        attributes: if t.attributes == NONE { NONE } else { t.attributes + attributes },
        ..t
    };
    out.triangles.extend(tables.triangles.into_iter().map(moved));
    out.attributes.extend(tables.attributes);
    out.spheres.extend(tables.spheres);
    // outlines are in scene space, so instances have none
    out.rectangles.extend(tables.rectangles.into_iter().map(|r| Rectangle { outline: NONE, ..r }));
    out.discs.extend(tables.discs.into_iter().map(|d| Disc { outline: NONE, ..d }));
    out.cuboids.extend(tables.cuboids.into_iter().map(|c| Cuboid { outline: 0, ..c }));
    let (revolutions, points) = (out.revolutions.len() as u32, out.profile_points.len() as u32);
    out.patches.extend(tables.patches.into_iter().map(|p| Patch {
        revolution: p.revolution + revolutions,
        first_point: p.first_point + points,
        ..p
    }));
    out.revolutions.extend(tables.revolutions);
    out.profile_points.extend(tables.profile_points);
    let (count, limit) = (out.triangles.len().max(out.refs.len()), 1 << REFERENCE_BITS);
    if count >= limit {
        return Err(PackError::TooMany { what: "primitives", count, limit });
    }
    Ok(())
}
