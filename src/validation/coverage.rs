//! Coverage of error estimates: how often the stated error bounds the true error.

use super::reference::BlockTruth;
use crate::engine::{Engine, EngineError};
use crate::film::{Picture, RelativeError, luminance};

/// A reference with known noise.
#[derive(Clone, Debug)]
pub enum NoisyTruth {
    /// Two independent renders with the same limit: the product of the differences from both is an
    /// unbiased estimate of the squared error.
    Halves([Picture; 2]),
    /// Block means, one per pixel, with standard errors.
    Blocks(BlockTruth),
}

impl NoisyTruth {
    /// relMSE (see docs/measures.md) of an image of the same size, corrected for the noise of the
    /// reference. May be negative if the error is small compared to that noise.
    pub fn rel_mse(&self, picture: &Picture) -> f64 {
        let mut errors: Vec<[f64; 2]> =
            picture.rgb.iter().enumerate().map(|(i, rgb)| self.pixel(i, luminance(*rgb))).collect();
        errors.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let kept = (errors.len() - errors.len().div_ceil(1000)).max(1);
        errors[..kept].iter().map(|[_, error]| error).sum::<f64>() / kept as f64
    }

    /// Relative squared error of a pixel, without and with correction for the reference's noise.
    fn pixel(&self, i: usize, seen: f64) -> [f64; 2] {
        let (a, b, noise) = match self {
            Self::Halves(halves) => {
                let [a, b] = halves.each_ref().map(|half| luminance(half.rgb[i]));
                (a, b, 0.0)
            }
            Self::Blocks(truth) => {
                let [mean, error] = [&truth.mean, &truth.standard_error]
                    .map(|blocks| blocks.rgb[i].map(|x| x as f32));
                let weights = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(luminance);
                let noise = (0..3).map(|c| (weights[c] * f64::from(error[c])).powi(2)).sum();
                (luminance(mean), luminance(mean), noise)
            }
        };
        let middle = 0.5 * (a + b);
        let share = 1.0 / (middle * middle + 0.01);
        [(seen - middle).powi(2) * share, ((seen - a) * (seen - b) - noise) * share]
    }
}

/// Estimated and true error of a render.
#[derive(Clone, Copy, Debug)]
pub struct Promise {
    /// Error estimate of the render.
    pub said: RelativeError,
    /// True error: square root of the relMSE against the reference.
    pub truth: f64,
}

impl Promise {
    /// Returns true if the stated error bounds the true error.
    pub fn kept(&self) -> bool {
        self.truth <= self.said.stated
    }

    /// Ratio of the estimated to the true error.
    pub fn estimate_ratio(&self) -> f64 {
        self.said.noise.hypot(self.said.bias) / self.truth
    }
}

/// Renders up to each of the pass counts in `passes`, in ascending order, and compares the
/// estimated with the true error there.
///
/// # Errors
/// If the engine fails.
pub fn promises(
    engine: &mut dyn Engine,
    truth: &NoisyTruth,
    passes: &[u32],
) -> Result<Vec<Promise>, EngineError> {
    let mut done = 0;
    let mut promise = |until: &u32| {
        while done < *until {
            engine.pass()?;
            done += 1;
        }
        let said = engine.errors()?.relative();
        Ok(Promise { said, truth: truth.rel_mse(&engine.picture()?).max(0.0).sqrt() })
    };
    passes.iter().map(&mut promise).collect()
}
