//! Checks of the scene as a whole.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::scene::diagnostics::Report;
use crate::scene::limits::{Allowance, within};
use crate::scene::{Light, MaterialKind, Reflectance, Scene};

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
    let used: BTreeSet<_> = scene.shapes.iter().map(|shape| shape.material).collect();
    for (index, span) in named.materials.iter().filter(|(index, _)| !used.contains(index)) {
        warn(format!("material `{}` is not used", scene.materials[*index].name), span);
    }
    let texture = |material: &MaterialKind| match material.reflectance() {
        Some(Reflectance::Texture(index)) => Some(*index),
        Some(Reflectance::Color(_)) | None => None,
    };
    let glows = scene.shapes.iter().filter_map(|shape| shape.glow.texture);
    let used = scene.materials.iter().filter_map(|material| texture(&material.kind));
    let projected = scene.lights.iter().filter_map(|light| match light {
        Light::Projector { texture, .. } => *texture,
        Light::Point { .. }
        | Light::Spot { .. }
        | Light::Profile { .. }
        | Light::Beam { .. }
        | Light::Sun { .. } => None,
    });
    let used: BTreeSet<_> = used.chain(glows).chain(projected).collect();
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
