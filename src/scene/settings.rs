//! Render settings, with the units and the symbols of the papers.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Light transport method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Stochastic progressive photon mapping: fresh eye paths each pass (Hachisuka & Jensen 2009).
    #[default]
    Sppm,
    /// Progressive photon mapping: eye paths traced once (Hachisuka, Ogaki & Jensen 2008).
    Ppm,
    /// Path tracing with next-event estimation and multiple importance sampling; CPU engine only.
    Path,
}

/// Rule that shrinks the gather radius from pass to pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RadiusRule {
    /// `r_{i+1}^2 = r_i^2 (i + alpha) / (i + 1)` for all pixels (Knaus & Zwicker 2011, eq. 15).
    #[default]
    Global,
    /// Per visible point, from its own photon count (Hachisuka et al. 2008, eqs. 3-5).
    Local,
    /// Constant radius; the bias remains.
    Fixed,
}

/// Computation of direct light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direct {
    /// Shadow rays to sampled lights; photons straight from a light are not stored.
    #[default]
    Sampled,
    /// All photons are stored, and surfaces receive light only from photons.
    Photons,
}

/// Start radius of the gather disc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Radius {
    /// Chosen automatically from the number of photons per pixel and the fraction of caustics.
    #[default]
    Auto,
    /// In widths of a pixel's footprint at the visible point.
    Pixels(f64),
    /// In scene units.
    Units(f64),
}

/// All parameters, except the scene and the device, that determine the bits of an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RenderSettings {
    /// Light transport method.
    pub method: Method,
    /// Number of passes, `P`.
    pub passes: u32,
    /// Photons emitted per pass, `M`.
    pub photons: u32,
    /// Maximum number of photons that are traced and gathered at once; by default, as many as fit
    /// in four million records. Sums are rounded per batch.
    #[schemars(range(min = 1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub batch: Option<u32>,
    /// Start radius, `r_1`.
    pub radius: Radius,
    /// Start radius of diffusely scattered photons relative to `radius`. Their light varies more
    /// slowly across surfaces than that of the other photons. Under the local rule, one count
    /// shrinks both radii. Default: 1 if `radius` is a number, automatic if it is "auto".
    #[schemars(range(min = 1.0, max = 16.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub indirect_radius: Option<f64>,
    /// Rule that shrinks the radius.
    pub radius_rule: RadiusRule,
    /// Fraction of photons kept when the radius shrinks, `alpha` in (0, 1].
    pub alpha: f64,
    /// Computation of direct light.
    pub direct: Direct,
    /// Maximum number of scattering events on a photon path and on an eye path. With 0, only
    /// visible emitters and, except with path tracing, direct light remain.
    #[schemars(range(max = 65535))]
    pub max_bounces: u32,
    /// PPM: fixed visible points per pixel, stratified over pixel and lens.
    #[schemars(range(min = 1, max = 65536))]
    pub eye_samples: u32,
    /// Random seed.
    pub seed: u64,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            method: Method::default(),
            passes: 64,
            photons: 262_144,
            batch: None,
            radius: Radius::default(),
            indirect_radius: None,
            radius_rule: RadiusRule::default(),
            alpha: 2.0 / 3.0,
            direct: Direct::default(),
            max_bounces: 32,
            eye_samples: 4,
            seed: 0,
        }
    }
}

impl RenderSettings {
    /// Ratio of the start radius of diffusely scattered photons to that of the others; 1 if it is
    /// to be chosen automatically.
    pub fn wider(&self) -> f64 {
        self.indirect_radius.unwrap_or(1.0)
    }

    /// Returns true if diffusely scattered photons have a separate radius.
    pub fn has_wider(&self) -> bool {
        self.indirect_radius.map_or(self.radius == Radius::Auto, |wider| wider != 1.0)
    }
}
