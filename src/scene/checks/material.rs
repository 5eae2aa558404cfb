//! Checks of materials that refer to others.

use std::ops::Range;

use super::Named;
use crate::scene::diagnostics::Report;
use crate::scene::numbers::LAYERS;
use crate::scene::{MaterialKind, Scene, Spans, Texels, TextureKind};

/// Reports materials of the scene file that contain themselves or too many others, glass in a mix,
/// and opacities of glass and of lights.
pub(crate) fn composition(report: &mut Report, scene: &Scene, named: &Named, spans: &Spans) {
    for (index, span) in &named.materials {
        let material = &scene.materials[*index];
        let name = &material.name;
        let mut error = |message: String, label: &str, help: &str| {
            report.error(span.clone(), message, label, Some(help.to_owned()));
        };
        if depth(scene, *index, LAYERS).is_none() {
            let message = format!("material `{name}` contains itself, or too many others");
            let label = format!("expected at most {LAYERS} levels of mixes, sides and opacities");
            error(message, &label, "remove a level, or the reference to itself");
            continue;
        }
        maps(report, scene, *index, span);
        let mut error = |message: String, label: &str, help: &str| {
            report.error(span.clone(), message, label, Some(help.to_owned()));
        };
        let glass =
            |index: &usize| matches!(scene.materials[*index].kind, MaterialKind::Glass { .. });
        if material.kind.parts().is_some_and(|parts| parts.iter().any(glass)) {
            let message = format!("material `{name}` contains glass, which has an inside");
            error(message, "expected surfaces without an inside", "use `thin = true` on the glass");
        }
        if material.opacity.is_some() && matches!(material.kind, MaterialKind::Glass { .. }) {
            let message = format!("material `{name}` is glass with an opacity");
            error(message, "expected glass without `opacity`", "use `thin = true` on the glass");
        }
        let emits = |shape: &crate::scene::Shape| shape.material == *index && shape.is_emitter();
        if material.opacity.is_some()
            && let Some(shape) = scene.shapes.iter().position(emits)
        {
            let place = spans.shapes.get(shape).map_or("a shape", String::as_str);
            let message = format!("material `{name}` has an opacity, but {place} emits light");
            error(message, "expected no `opacity` on a light", "give the light another material");
        }
    }
}

/// Reports maps whose values are not linear, and normal maps that are no images.
fn maps(report: &mut Report, scene: &Scene, index: usize, span: &Range<usize>) {
    let material = &scene.materials[index];
    let normal = material.normal_map.map(|map| ("normal map", map.texture));
    let bump = material.bump_map.map(|map| ("bump map", map.texture));
    for (what, texture) in [normal, bump].into_iter().flatten() {
        let texture = &scene.textures[texture];
        let (name, of) = (&material.name, &texture.name);
        let image = match &texture.kind {
            TextureKind::Image { image, .. } | TextureKind::Planks { image, .. } => *image,
            TextureKind::Checker { .. } if what == "normal map" => {
                let message = format!("material `{name}` has a checkerboard as its normal map");
                report.error(span.clone(), message, "expected an image", None);
                continue;
            }
            TextureKind::Checker { .. } => continue,
        };
        if matches!(scene.images[image].texels, Texels::Rgba8 { srgb: true, .. }) {
            let message = format!(
                "the {what} of material `{name}` is texture `{of}`, whose values are sRGB colors"
            );
            let help = format!("add color_space = \"linear\" to [textures.{of}]");
            report.error(span.clone(), message, "expected linear values", Some(help));
        }
    }
}

/// Number of layers below a material, itself included; `None` beyond `most`.
fn depth(scene: &Scene, index: usize, most: usize) -> Option<usize> {
    let material = scene.materials.get(index)?;
    let own =
        usize::from(material.opacity.is_some()) + usize::from(material.roughness_map.is_some());
    let Some(parts) = material.kind.parts() else {
        let layers = own
            + match material.kind {
                MaterialKind::Plastic { .. } => 1,
                // clear coat, metal, sheet, coat and its base
                MaterialKind::Principled(_) => 5,
                _ => 0,
            };
        return (layers <= most).then_some(layers);
    };
    let left = most.checked_sub(own + 1)?;
    let [first, second] = parts.map(|part| depth(scene, part, left));
    Some(first?.max(second?) + own + 1)
}
