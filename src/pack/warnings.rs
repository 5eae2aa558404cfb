//! Warnings about light that an image may lack without showing it.

use super::PackedScene;
use super::lights::LightKind;
use super::materials::Bsdf;
use crate::scene;
use crate::scene::settings::{Method, RenderSettings};

/// Photons of a light per pass below which its caustics may be missed.
const FEW_PHOTONS: f64 = 64.0;
/// Fraction of the light seen by the camera above which a light can cause a warning.
const LEAST_SHARE: f64 = 0.002;

impl PackedScene {
    /// Warnings about light that may be missing from an image with these settings and from its
    /// error estimate. Each one describes the light in terms of the scene file, and gives a remedy.
    pub fn warnings(&self, scene: &scene::Scene, settings: &RenderSettings) -> Vec<String> {
        let bsdfs = || self.tables.materials.iter().map(|m| Bsdf::of(m.kind));
        let path = settings.method == Method::Path;
        let focusing = bsdfs().any(|b| b.is_specular() || (!path && !b.is_wide()));
        let warning = |i: usize| {
            let (light, name) = (&self.tables.lights[i], self.sources[i].describe(scene));
            let photons = f64::from(settings.photons) * f64::from(light.selection);
            let contribution = self.contributions.get(i).copied().unwrap_or(0.0);
            let sized = match LightKind::of(light.kind) {
                LightKind::Point | LightKind::Spot | LightKind::Sun => false,
                LightKind::Area | LightKind::SunDisc | LightKind::Constant | LightKind::Image => {
                    true
                }
            };
            if path && !sized {
                return Some(format!(
                    "path tracing cannot meet {name}, which has no size: the light that it casts \
                     by mirrors or through glass is missing from the picture and from its stated \
                     error; use --method sppm"
                ));
            }
            (!path && photons < FEW_PHOTONS && contribution > LEAST_SHARE).then(|| {
                format!(
                    "{name} sends {photons:.0} photons a pass but brings {:.1} % of the light: \
                     what it casts by mirrors or through glass may be missing from the picture and \
                     from its stated error; raise --photons",
                    100.0 * contribution
                )
            })
        };
        if focusing { (0..self.sources.len()).filter_map(warning).collect() } else { Vec::new() }
    }
}
