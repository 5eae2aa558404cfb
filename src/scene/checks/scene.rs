//! Checks of the scene as a whole.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::sync::Arc;

use crate::scene::diagnostics::Report;
use crate::scene::limits::{Allowance, within};
use crate::scene::{Scene, ShapeKind};

/// Reports a number of shapes in the file, at `span`, that the limits do not allow; returns whether
/// they do. Importers call this before they convert the shapes.
pub(crate) fn shape_count(
    report: &mut Report,
    allowance: &Allowance,
    count: u64,
    span: Range<usize>,
) -> bool {
    let allowed = within("shapes", "shapes", count, allowance.shapes);
    if let Err(refusal) = &allowed {
        let message = format!("the scene is too large: {refusal}");
        report.error(span, message, "here", refusal.help());
    }
    allowed.is_ok()
}

/// Parts that the scene file defines by name: the index of each, and its position.
#[derive(Default)]
pub(crate) struct Named {
    pub textures: Vec<(usize, Range<usize>)>,
    pub materials: Vec<(usize, Range<usize>)>,
}

/// Warns about materials and textures of the scene file that no other part uses.
pub(crate) fn unused(report: &mut Report, scene: &Scene, named: &Named) {
    let mut warn = |message: String, span: &Range<usize>| {
        report.warn(span.clone(), message, "defined here");
    };
    let parts = scene.materials.iter().filter_map(|material| material.kind.parts()).flatten();
    let mut used: BTreeSet<_> =
        scene.shapes.iter().map(|shape| shape.material).chain(parts).collect();
    let groups = scene.shapes.iter().filter_map(|shape| match &shape.kind {
        ShapeKind::Instance { group, .. } => Some((Arc::as_ptr(group), group)),
        _ => None,
    });
    // each group once
    for group in groups.collect::<BTreeMap<_, _>>().values() {
        used.extend(group.shapes().iter().map(|shape| shape.material));
    }
    for (index, span) in named.materials.iter().filter(|(index, _)| !used.contains(index)) {
        warn(format!("material `{}` is not used", scene.materials[*index].name), span);
    }
    let used: BTreeSet<_> = scene.materials.iter().flat_map(|m| m.textures()).collect();
    for (index, span) in named.textures.iter().filter(|(index, _)| !used.contains(index)) {
        warn(format!("texture `{}` is not used", scene.textures[*index].name), span);
    }
}

/// Warns about a scene without light.
pub(crate) fn lit(report: &mut Report, scene: &Scene) {
    if !scene.is_lit() {
        let message = "the scene has no light; the image will be black";
        let label = "expected an emission above 0, [[lights]] or [environment]";
        report.warn(0..0, message, label);
    }
}
