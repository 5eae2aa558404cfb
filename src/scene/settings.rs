//! Render settings: what a pass does and how many there are. Each field names its unit and the
//! paper's symbol.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How light is carried to the film.
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

/// How the gather radius shrinks from pass to pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RadiusRule {
    /// `r_{i+1}^2 = r_i^2 (i + alpha) / (i + 1)` for all pixels (Knaus & Zwicker 2011, eq. 15).
    #[default]
    Global,
    /// Per visible point, from its own photon count (Hachisuka et al. 2008, eqs. 3-5).
    Local,
    /// Constant; the bias stays.
    Fixed,
}

/// How light that arrives straight from a light is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direct {
    /// Shadow rays to sampled lights; photons straight from a light are not stored.
    #[default]
    Sampled,
    /// All photons are stored and none but they light a surface.
    Photons,
}

/// The start radius of the gather disc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Radius {
    /// Chosen by a look at the scene, from how many photons fall on a pixel and whether they are
    /// caustics.
    #[default]
    Auto,
    /// In widths of a pixel's footprint at the visible point.
    Pixels(f64),
    /// In scene units.
    Units(f64),
}

/// Everything except the scene and the device that decides the bits of a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RenderSettings {
    /// Light transport method.
    pub method: Method,
    /// Number of passes, `P`.
    pub passes: u32,
    /// Photons emitted per pass, `M`.
    pub photons: u32,
    /// Photons of a pass that are traced and gathered at once, at the most; where it is not given,
    /// as many as four million records hold. Sums are rounded batch by batch.
    #[schemars(range(min = 1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub batch: Option<u32>,
    /// Start radius, `r_1`.
    pub radius: Radius,
    /// Start radius of photons that a diffuse surface has scattered before, over `radius`. Their
    /// light changes more slowly from place to place than that of the others. Under the local rule
    /// one count shrinks both. If it is not given, it is 1 with a number for `radius`, and
    /// chosen automatically with "auto".
    #[schemars(range(min = 1.0, max = 16.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub indirect_radius: Option<f64>,
    /// How the radius shrinks.
    pub radius_rule: RadiusRule,
    /// Share of the photons kept when the radius shrinks, `alpha` in (0, 1].
    pub alpha: f64,
    /// Where direct light comes from.
    pub direct: Direct,
    /// Most scattering events on a photon path and on an eye path. With 0 only light seen directly
    /// and, but for path tracing, light straight from lights is left.
    #[schemars(range(max = 65535))]
    pub max_bounces: u32,
    /// PPM: fixed visible points per pixel, stratified over pixel and lens.
    #[schemars(range(min = 1, max = 65536))]
    pub eye_samples: u32,
    /// Seed of the random numbers.
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
    /// Start radius of photons that a diffuse surface has scattered over that of the others, but
    /// for one that is still to be chosen.
    pub fn wider(&self) -> f64 {
        self.indirect_radius.unwrap_or(1.0)
    }

    /// Whether they have a radius of their own.
    pub fn has_wider(&self) -> bool {
        self.indirect_radius.map_or(self.radius == Radius::Auto, |wider| wider != 1.0)
    }
}
