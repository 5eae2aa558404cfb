//! All methods on one scene with everything in it.

use caustica::settings::{Direct, Method, RadiusRule, RenderSettings};
use glam::DVec3;

use super::invariance::everything;
use super::lab::*;

/// Theory: PPM and SPPM with every radius rule, direct light sampled and by photons, and path tracing estimate one
/// integral; their pictures agree pairwise, region by region, up to the photons' bias: discs of a start radius of 0.04
/// that reach over edges and corners lose or blur light there, which the tile's slack covers.
#[test]
fn all_methods_agree_pairwise() {
    let text = everything(1.0, DVec3::ZERO, 24);
    let cases = [
        (Method::Path, Direct::Sampled, RadiusRule::Fixed),
        (Method::Sppm, Direct::Sampled, RadiusRule::Global),
        (Method::Sppm, Direct::Photons, RadiusRule::Fixed),
        (Method::Ppm, Direct::Sampled, RadiusRule::Local),
        (Method::Sppm, Direct::Photons, RadiusRule::Local),
        (Method::Ppm, Direct::Photons, RadiusRule::Global),
        (Method::Path, Direct::Photons, RadiusRule::Fixed),
    ];
    let found: Vec<(String, Runs)> = cases
        .into_iter()
        .map(|(method, direct, radius_rule)| {
            let settings = RenderSettings {
                method,
                direct,
                radius_rule,
                passes: if method == Method::Path { 64 } else { 16 },
                photons: 1 << 14,
                max_bounces: 24,
                // methods must not share random numbers, or they would agree too well
                seed: 100 * (method as u64 * 9 + direct as u64 * 3 + radius_rule as u64),
                ..settings(0.02)
            };
            (format!("{method:?} {direct:?} {radius_rule:?}"), runs(&text, &settings))
        })
        .collect();
    for (i, (name, a)) in found.iter().enumerate() {
        for (other, b) in &found[..i] {
            assert_regions(&format!("{name} and {other}"), a, b, 0.03);
        }
    }
}
