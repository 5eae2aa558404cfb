//! Quality presets, and prediction of their error from the first passes.
//!
//! The constants come from docs/speed-accuracy.md, which `scenes/studies/run` regenerates.

use serde::{Deserialize, Serialize};

use crate::film::Picture;
use crate::film::metrics::{MetricsError, compare};
use crate::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};

/// A quality preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// To check the composition.
    Draft,
    /// To judge light and materials.
    Preview,
    /// For publication.
    Final,
    /// As a reference for other renders.
    Reference,
}

/// Photons per pass and pixel.
const PHOTONS_PER_PIXEL: f64 = 1.0;

impl Quality {
    /// All presets in order of cost.
    pub const ALL: [Self; 4] = [Self::Draft, Self::Preview, Self::Final, Self::Reference];

    /// Name of the preset on the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Preview => "preview",
            Self::Final => "final",
            Self::Reference => "reference",
        }
    }

    /// Number of passes.
    pub fn passes(self) -> u32 {
        match self {
            Self::Draft => 4,
            Self::Preview => 16,
            Self::Final => 256,
            Self::Reference => 4096,
        }
    }

    /// Applies the preset to the settings of an image with `pixels` pixels. Keeps bounces, eye
    /// samples and seed.
    pub fn apply(self, pixels: u64, settings: &mut RenderSettings) {
        *settings = RenderSettings {
            method: Method::Sppm,
            passes: self.passes(),
            photons: (pixels as f64 * PHOTONS_PER_PIXEL).clamp(1.0, f64::from(u32::MAX)) as u32,
            radius: Radius::Auto,
            radius_rule: RadiusRule::Global,
            alpha: 2.0 / 3.0,
            direct: Direct::Sampled,
            ..settings.clone()
        };
    }
}

/// Estimates the relMSE of an image of one pass from images after one and after two passes. The
/// mean of two passes lies halfway between them, so its distance from the first is half of their
/// difference.
///
/// # Errors
/// If the images cannot be compared.
pub fn one_pass_error(first: &Picture, both: &Picture) -> Result<f64, MetricsError> {
    Ok(2.0 * compare(first, both)?.rel_mse)
}

/// Number of passes, and the exponent with which relMSE decreases from one pass to that number:
/// median, minimum and maximum over the shipped scenes.
const DECAY: [(u32, [f64; 3]); 4] = [
    (4, [1.17, 0.99, 2.29]),
    (16, [1.10, 0.89, 1.68]),
    (256, [0.93, 0.79, 1.02]),
    (4096, [0.77, 0.67, 0.93]),
];
/// Exponent of path tracing, whose passes are independent and unbiased.
const DECAY_OF_PATHS: [f64; 3] = [1.0; 3];

/// Expected error of a render.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Expected {
    /// relMSE for the median exponent.
    pub rel_mse: f64,
    /// relMSE for the maximum exponent (fastest convergence).
    pub low: f64,
    /// relMSE for the minimum exponent (slowest convergence).
    pub high: f64,
}

/// Predicts the error after `passes` passes if one pass has the relMSE `one_pass`.
pub fn expected(one_pass: f64, passes: u32, method: Method) -> Expected {
    let decay = if method == Method::Path { DECAY_OF_PATHS } else { decay(passes) };
    let [rel_mse, high, low] = decay.map(|slope| one_pass * f64::from(passes).powf(-slope));
    Expected { rel_mse, low, high }
}

/// Exponents for a number of passes, interpolated from the table linearly in its logarithm.
fn decay(passes: u32) -> [f64; 3] {
    let (first, last) = (DECAY[0], DECAY[DECAY.len() - 1]);
    let between = DECAY.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&passes));
    let Some([(low, from), (high, to)]) = between else {
        return if passes < first.0 { first.1 } else { last.1 };
    };
    let part =
        (f64::from(passes) / f64::from(*low)).ln() / (f64::from(*high) / f64::from(*low)).ln();
    [0, 1, 2].map(|i| from[i] + part * (to[i] - from[i]))
}

/// Theory: images of two independent passes with variance V have the mean squared distance 2 V; the
/// distance of the first from their mean is half of their distance.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_passes_tell_the_error_of_one() {
        let mut state = 5u64;
        let mut noisy = || {
            Picture::from_fn(100, 80, |_, _| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                // uniform in [1, 1.2): variance 1/300
                [1.0 + 0.2 * (state >> 40) as f32 / (1u64 << 24) as f32; 3]
            })
        };
        let (first, second) = (noisy(), noisy());
        let mut pixels =
            first.rgb.iter().zip(&second.rgb).map(|(a, b)| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c])));
        let both = Picture::from_fn(100, 80, |_, _| pixels.next().unwrap());
        let estimated = one_pass_error(&first, &both).unwrap();
        let exact = 1.0 / 300.0 / (1.1f64.powi(2) + 0.01);
        assert!((estimated / exact - 1.0).abs() < 0.05, "{estimated} {exact}");
        // using the second pass alone instead of the mean would quadruple the estimate
        assert!(one_pass_error(&first, &second).unwrap() > 3.0 * exact);
    }

    #[test]
    fn more_passes_and_better_presets_promise_less_error() {
        let errors = Quality::ALL.map(|quality| expected(0.1, quality.passes(), Method::Sppm));
        assert!(
            errors.windows(2).all(|pair| pair[1].high < pair[0].high && pair[1].low < pair[0].low)
        );
        assert!(errors.iter().all(|e| e.low <= e.rel_mse && e.rel_mse <= e.high));
        assert_eq!(expected(0.1, 1, Method::Sppm).rel_mse, 0.1);
        // interpolation between table entries, and clamping beyond them
        let exponent = |passes: u32| {
            -(expected(1.0, passes, Method::Sppm).rel_mse).ln() / f64::from(passes).ln()
        };
        assert!((exponent(64) - 0.5 * (exponent(16) + exponent(256))).abs() < 1e-9);
        assert!(
            (exponent(2) - exponent(4)).abs() < 1e-9
                && (exponent(1 << 20) - exponent(4096)).abs() < 1e-9
        );
        assert!((expected(0.1, 10, Method::Path).rel_mse - 0.01).abs() < 1e-12);
    }

    #[test]
    fn presets_leave_what_is_not_theirs() {
        let own = RenderSettings {
            seed: 7,
            max_bounces: 5,
            eye_samples: 9,
            method: Method::Ppm,
            ..Default::default()
        };
        for quality in Quality::ALL {
            let mut settings = own.clone();
            quality.apply(640 * 400, &mut settings);
            assert_eq!((settings.seed, settings.max_bounces, settings.eye_samples), (7, 5, 9));
            assert_eq!((settings.method, settings.radius), (Method::Sppm, Radius::Auto));
            assert_eq!(settings.photons, (640.0 * 400.0 * PHOTONS_PER_PIXEL) as u32);
            assert_eq!(serde_json::to_value(quality).unwrap(), quality.word());
        }
    }
}
