//! Keys of glasses and metals, of which a material has either one or another.

use super::document::Item;
use crate::scene::Rgb;
use crate::scene::builder::SceneBuilder;
use crate::scene::named::glasses::{glass, glass_names};
use crate::scene::named::metals::{metal, metal_names};
use crate::scene::numbers::LARGEST;
use crate::scene::parts::Part;

/// Index of refraction from the key `ior` or from the name of a material. Reports a name that is
/// not known, and none or both of the keys.
pub(super) fn glass_index(
    builder: &mut SceneBuilder,
    item: &Item,
    ior: Option<f64>,
    material: Option<&str>,
) -> f64 {
    let report = &mut builder.report;
    match (ior, material) {
        (Some(ior), None) => return ior,
        (None, Some(name)) => match glass(name) {
            Some(glass) => return glass.ior,
            None => {
                let message = format!("there is no glass called `{name}`");
                let label = report.did_you_mean(name, glass_names(), "expected a known glass");
                let names: Vec<_> = glass_names().collect();
                let help = format!("known: {}; or give the index as `ior`", names.join(", "));
                report.error(item.span_of("material"), message, label, Some(help));
            }
        },
        (Some(_), Some(_)) => {
            let message = format!("{} has both an index and the name of a glass", item.place());
            let label = "expected either `ior` or `material`";
            report.error(item.span_of("material"), message, label, None);
        }
        (None, None) => {
            let message = format!("{} lacks `ior`", item.place());
            let help = Some("for example ior = 1.5, or material = \"bk7\"".to_owned());
            let label = "expected `ior` or `material`".to_owned();
            report.missing(item.span(), message, label, help);
        }
    }
    1.0
}

/// Absorption coefficient per scene unit, from itself or from the color that is left at a distance
/// (glTF 2.0, KHR_materials_volume): `-ln(color) / distance`.
pub(super) fn glass_absorption(
    builder: &mut SceneBuilder,
    item: &Item,
    absorption: Option<Rgb>,
    color: Option<Rgb>,
    distance: Option<f64>,
) -> Rgb {
    let report = &mut builder.report;
    if absorption.is_some() && (color.is_some() || distance.is_some()) {
        let message = format!("{} has two kinds of absorption", item.place());
        let key = if color.is_some() { "attenuation_color" } else { "attenuation_distance" };
        let label = "expected either `absorption` or `attenuation_color`";
        report.error(item.span_of(key), message, label, None);
    }
    match (color, distance) {
        (Some(color), distance) => {
            let distance = distance.unwrap_or(1.0);
            // a channel of zero leaves nothing at any distance that matters
            color.map(|left| (-left.max(f64::MIN_POSITIVE).ln() / distance).min(LARGEST))
        }
        (None, Some(_)) if absorption.is_none() => {
            let message = format!("{} has a distance without a color", item.place());
            let label = "expected `attenuation_color` too";
            report.error(item.span_of("attenuation_distance"), message, label, None);
            [0.0; 3]
        }
        (None, _) => absorption.unwrap_or_default(),
    }
}

/// Reports keys that have no meaning for a thin sheet, or only for one.
pub(super) fn thin_glass_keys(builder: &mut SceneBuilder, item: &Item, thin: bool) {
    let (wrong, message, label): (&[&str], _, _) = if thin {
        let keys = &["absorption", "attenuation_color", "attenuation_distance", "priority"];
        (keys, "is thin: it has no inside", "expected `transmittance`, or thin = false")
    } else {
        (&["transmittance"], "is not thin", "expected `attenuation_color`, or thin = true")
    };
    for key in wrong.iter().filter(|key| item.node.get(key).is_some()) {
        let message = format!("`{key}` has no meaning: {} {message}", item.place());
        builder.report.error(item.span_of(key), message, label, None);
    }
}

/// Complex index of refraction from the keys `eta` and `k` or from the name of a metal; `None` if
/// the metal is given by its reflectance. Reports a name that is not known, and none or several of
/// the three ways.
pub(super) fn metal_index(
    builder: &mut SceneBuilder,
    item: &Item,
    reflectance: bool,
    [eta, k]: [Option<Rgb>; 2],
    material: Option<&str>,
) -> Option<[Rgb; 2]> {
    let report = &mut builder.report;
    let ways = [reflectance, eta.is_some() || k.is_some(), material.is_some()];
    if ways.iter().filter(|given| **given).count() > 1 {
        let message = format!("{} has a color given in several ways", item.place());
        let label = "expected one of `reflectance`, `eta` with `k`, and `material`";
        let key = if material.is_some() { "material" } else { "eta" };
        report.error(item.span_of(key), message, label, None);
        return None;
    }
    if let Some(name) = material {
        let Some(metal) = metal(name) else {
            let message = format!("there is no metal called `{name}`");
            let label = report.did_you_mean(name, metal_names(), "expected a known metal");
            let names: Vec<_> = metal_names().collect();
            let help = format!("known: {}; or give `eta` and `k`", names.join(", "));
            report.error(item.span_of("material"), message, label, Some(help));
            return None;
        };
        return Some([metal.eta, metal.k]);
    }
    match (eta, k) {
        (Some(eta), Some(k)) => Some([eta, k]),
        (None, None) if reflectance => None,
        (None, None) => {
            let message = format!("{} lacks `reflectance`", item.place());
            let help = Some("for example reflectance = 0.9, or material = \"gold\"".to_owned());
            let label = "expected `reflectance`, `eta` and `k`, or `material`".to_owned();
            report.missing(item.span(), message, label, help);
            None
        }
        (Some(_), None) | (None, Some(_)) => {
            let (key, other) = if eta.is_some() { ("eta", "k") } else { ("k", "eta") };
            let message = format!("{} has `{key}` without `{other}`", item.place());
            let label = format!("expected `{other}` too");
            report.error(item.span_of(key), message, label, None);
            None
        }
    }
}
