//! Shapes with a transform, groups of shapes, and their instances.

use std::mem::discriminant;
use std::sync::Arc;

use glam::DAffine3;

use super::SceneBuilder;
use crate::scene::limits::within;
use crate::scene::numbers::LAYERS;
use crate::scene::parts::Part;
use crate::scene::placement::placed;
use crate::scene::{Group, MaterialKind, Shape, ShapeKind, checks};

/// A group in the making.
#[derive(Debug, Default)]
pub(crate) struct GroupParts {
    /// Shapes that instances share.
    shared: Option<Arc<Group>>,
    /// Shapes that each instance writes out: lamps, bodies of glass, planes, surfaces with world
    /// coordinates as texture coordinates, and instances of other groups.
    apart: Vec<Shape>,
}

impl SceneBuilder<'_> {
    /// Checks the shapes of one part, and moves them by an invertible map.
    pub fn checked(
        &mut self,
        part: &dyn Part,
        shapes: Vec<Shape>,
        map: Option<&DAffine3>,
    ) -> Vec<Shape> {
        checks::shapes(&mut self.report, part, &shapes);
        match map {
            None => shapes,
            Some(map) => self.moved(part, shapes, map),
        }
    }

    fn moved(&mut self, part: &dyn Part, shapes: Vec<Shape>, map: &DAffine3) -> Vec<Shape> {
        let moved: Vec<Shape> =
            shapes.into_iter().filter_map(|shape| self.placed(part, shape, map)).collect();
        checks::moved(&mut self.report, part, &moved);
        moved
    }

    /// Moves a shape. It becomes an instance if the result is none of the shapes; such an instance
    /// cannot emit, which is reported.
    fn placed(&mut self, part: &dyn Part, shape: Shape, map: &DAffine3) -> Option<Shape> {
        let textured = !shape.planar_uv && self.is_textured(shape.material, LAYERS);
        if let Some(kind) = placed(&shape.kind, map, textured) {
            return Some(Shape { kind, ..shape });
        }
        if shape.is_emitter() {
            let message = format!("{} cannot emit with this transform", part.place());
            let label = "expected a transform that keeps the shape's proportions";
            let help = "scale a lamp alike along all axes (a revolution also along its own axis), \
                        do not turn one with a texture, or use a mesh";
            self.report.error(part.span_of("transform"), message, label, Some(help.to_owned()));
            return None;
        }
        let own = Shape { kind: shape.kind, planar_uv: false, ..shape };
        let planar_uv = shape.planar_uv;
        let material = shape.material;
        let group = Arc::new(Group::new(vec![own]));
        let kind = ShapeKind::Instance { group, map: *map };
        Some(Shape { planar_uv, ..Shape::new(kind, material) })
    }

    /// Returns whether texture coordinates matter on surfaces of this material: it or one of the
    /// materials that it contains, down to `depth` levels, has a texture.
    fn is_textured(&self, material: usize, depth: usize) -> bool {
        let Some(material) = self.materials.get(material) else { return false };
        let parts = material.kind.parts().filter(|_| depth > 0);
        let below = |parts: [usize; 2]| parts.iter().any(|at| self.is_textured(*at, depth - 1));
        material.textures().next().is_some() || parts.is_some_and(below)
    }

    /// Makes a group of shapes that were checked.
    pub fn group(&self, shapes: Vec<Shape>) -> GroupParts {
        let alone = |shape: &Shape| {
            let material = self.materials.get(shape.material).map(|material| &material.kind);
            let special =
                matches!(shape.kind, ShapeKind::Plane { .. } | ShapeKind::Instance { .. });
            let glass = matches!(material, Some(MaterialKind::Glass { .. }));
            special || glass || shape.is_emitter() || shape.planar_uv
        };
        let (mut apart, shared): (Vec<_>, Vec<_>) = shapes.into_iter().partition(alone);
        // a single small shape needs no separate tree
        let mesh = discriminant(&ShapeKind::Mesh(Default::default()));
        if let [only] = &shared[..]
            && discriminant(&only.kind) != mesh
        {
            apart.extend(shared);
            return GroupParts { shared: None, apart };
        }
        let shared = (!shared.is_empty()).then(|| Arc::new(Group::new(shared)));
        GroupParts { shared, apart }
    }

    /// The shapes of an instance of `group` at `map`. Reports instances that exceed the limits, and
    /// returns `None`.
    pub fn instance(
        &mut self,
        part: &dyn Part,
        group: &GroupParts,
        map: &DAffine3,
    ) -> Option<Vec<Shape>> {
        // one error says that the scene is too large
        if self.instanced == u64::MAX {
            return None;
        }
        // the profile of a surface of revolution is copied, too
        let weight = |shape: &Shape| match &shape.kind {
            ShapeKind::Revolution { segments, .. } => segments.len() as u64,
            _ => 1,
        };
        let count = group.apart.iter().map(weight).sum::<u64>() + 1;
        let copied = |shape: &Shape| match &shape.kind {
            ShapeKind::Mesh(mesh) => mesh.triangles.len() as u64,
            _ => 0,
        };
        let triangles = group.apart.iter().map(copied).sum();
        let left = self.allowance.shapes.saturating_sub(self.instanced);
        let allowed = within("shapes", "shapes of instances", count, left)
            .and_then(|()| self.charge_copies(triangles));
        if let Err(refusal) = allowed {
            let message = format!("the scene is too large: {refusal}");
            let label = "expected fewer instances";
            self.report.error(part.span(), message, label, refusal.help());
            self.instanced = u64::MAX;
            return None;
        }
        self.instanced += count;
        let shared = group.shared.iter().map(|group| {
            let material = group.shapes().first().map_or(0, |shape| shape.material);
            Shape::new(
                ShapeKind::Instance { group: group.clone(), map: DAffine3::IDENTITY },
                material,
            )
        });
        let shapes = shared.chain(group.apart.iter().cloned()).collect();
        Some(self.moved(part, shapes, map))
    }
}
