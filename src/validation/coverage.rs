//! Stated errors against true ones: how often a render keeps what it promises.

use super::reference::BlockTruth;
use crate::engine::{Engine, EngineError};
use crate::film::{Picture, RelativeError, luminance};

/// A picture of the truth that knows its own noise.
#[derive(Clone, Debug)]
pub enum NoisyTruth {
    /// Two renders that share nothing but what they converge to: the product of the differences
    /// from both has the expectation of the squared error.
    Halves([Picture; 2]),
    /// A pixel for each block, with standard errors.
    Blocks(BlockTruth),
}

impl NoisyTruth {
    /// relMSE of docs/measures.md of a picture of the same size, less what the truth's own noise
    /// adds to it; below zero by chance where the error is small against that noise.
    pub fn rel_mse(&self, picture: &Picture) -> f64 {
        let mut errors: Vec<[f64; 2]> =
            picture.rgb.iter().enumerate().map(|(i, rgb)| self.pixel(i, luminance(*rgb))).collect();
        errors.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let kept = (errors.len() - errors.len().div_ceil(1000)).max(1);
        errors[..kept].iter().map(|[_, error]| error).sum::<f64>() / kept as f64
    }

    /// Relative squared error of a pixel, with the truth's noise and less it.
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

/// What one render said, and what was true.
#[derive(Clone, Copy, Debug)]
pub struct Promise {
    /// What it said.
    pub said: RelativeError,
    /// Root of its relMSE against the truth.
    pub truth: f64,
}

impl Promise {
    /// Whether the true error is within the stated one.
    pub fn kept(&self) -> bool {
        self.truth <= self.said.stated
    }

    /// The estimate over the true error.
    pub fn estimate_ratio(&self) -> f64 {
        self.said.noise.hypot(self.said.bias) / self.truth
    }
}

/// Renders on until each of the numbers of passes, which rise, and hears what the picture says
/// there.
///
/// # Errors
/// When the engine fails.
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
