//! What a picture says of its own error: variance and bias of every pixel, and one number for the whole.
//! docs/error-estimate.md tells the method and how good it is.

use super::Plane;
use super::exr_file::NamedPlane;
use super::plane::{gaussian, normalized};

/// Least number of passes whose picture has an estimate: two even and two odd ones.
pub const LEAST_PASSES: u32 = 4;

/// Bias of the estimate in a disc over what it differs by from that in the inner half of the disc's area: where bias
/// falls as the p-th power of the radius, `1 / (1 - 2^(-p/2))`. This is p = 2, which holds where radiance is smooth.
pub const BIAS_OVER_RING: f64 = 2.0;

/// The stated error is so many of the estimate's standard errors above the estimate.
pub const CONFIDENCE: f64 = 2.0;

/// Edge of the blocks, in pixels, whose errors count as independent of one another.
const BLOCK: usize = 16;

/// Added to the squared luminance that an error is relative to, as in relMSE.
const DARK: f64 = 0.01;

/// Standard deviation, in pixels, of the Gaussian that smooths the map of the bias.
const SMOOTHING: f64 = 2.0;

/// What is known of one pixel's error: luminance, in W sr^-1 m^-2 or its square.
///
/// A mean over the passes is `x`; the same mean with odd passes turned over, `x_swing`, has the same noise and no
/// signal, so that `x^2 - x_swing^2`, the product of the means over even and over odd passes, has the expectation of the
/// signal's square, and `2 x x_swing` its noise alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelError {
    /// The estimate.
    pub luminance: f64,
    /// Variance of the mean over the passes, from their mean squared deviation.
    pub variance: f64,
    /// A deviation that is distributed as the mean's noise is.
    pub swing: f64,
    /// Estimate in the disc less that in the inner half of its area.
    pub ring: f64,
    /// The same with odd passes turned over.
    pub ring_swing: f64,
    /// Deviation of the mean over fixed eye samples, from two halves of them, and noise.
    pub halves: f64,
    /// The noise in `halves`.
    pub halves_swing: f64,
}

impl PixelError {
    /// Unbiased estimate of the variance: that over the passes, and that over eye samples which are the same in all.
    pub fn noise(&self) -> f64 {
        self.variance + squared_signal(self.halves, self.halves_swing)
    }

    /// Unbiased estimate of the squared bias; it may be negative.
    pub fn bias_sq(&self) -> f64 {
        BIAS_OVER_RING * BIAS_OVER_RING * squared_signal(self.ring, self.ring_swing)
    }
}

fn squared_signal(mean: f64, swing: f64) -> f64 {
    mean * mean - swing * swing
}

/// The errors of all pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    /// Pixels per row.
    pub width: u32,
    /// Row by row, row 0 on top.
    pub pixels: Vec<PixelError>,
}

/// Relative error of a whole picture: root of the relMSE of docs/measures.md.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelativeError {
    /// Part of the estimate that is noise.
    pub noise: f64,
    /// Part of the estimate that is bias; what both are the legs of is the estimate.
    pub bias: f64,
    /// The true error is within this one in nine of ten renders.
    pub stated: f64,
}

impl ErrorMap {
    /// Variance of each pixel's luminance, in squares of W sr^-1 m^-2.
    pub fn variance(&self) -> Plane {
        self.plane(|p| p.noise().max(0.0))
    }

    /// Bias of each pixel's luminance, in W sr^-1 m^-2, smoothed by a Gaussian of two pixels: a single pixel's estimate
    /// has twice the noise of the pixel itself.
    pub fn bias(&self) -> Plane {
        let weights = normalized(&gaussian(SMOOTHING, 3 * SMOOTHING as usize));
        self.plane(|p| BIAS_OVER_RING * p.ring).along_x(&weights).along_y(&weights)
    }

    /// Both maps as layers of a picture file.
    pub fn layers(&self) -> Vec<NamedPlane> {
        vec![("Variance.Y", self.variance()), ("Bias.Y", self.bias())]
    }

    fn plane(&self, value: impl Fn(&PixelError) -> f64) -> Plane {
        Plane { width: self.width as usize, values: self.pixels.iter().map(value).collect() }
    }

    /// The whole picture's error.
    pub fn relative(&self) -> RelativeError {
        let reference = |p: &PixelError| (p.luminance * p.luminance - p.variance).max(0.0) + DARK;
        let terms: Vec<Term> = self.pixels.iter().map(|p| Term::of(p, reference(p))).collect();
        let kept = self.kept(&terms);
        let count = kept.iter().filter(|kept| **kept).count().max(1) as f64;
        let mean = |part: fn(&Term) -> f64| {
            let all = terms.iter().zip(&kept).filter(|(_, kept)| **kept);
            all.map(|(term, _)| part(term)).sum::<f64>() / count
        };
        let (noise, bias) = (mean(|t| t.noise), mean(|t| t.bias));
        let spread = self.block_sums(&terms, &kept).iter().map(|sum| sum * sum).sum::<f64>().sqrt() / count;
        let stated = ((noise + bias).max(0.0) + CONFIDENCE * spread).sqrt();
        let stated = if stated.is_nan() { f64::INFINITY } else { stated };
        RelativeError { noise: noise.max(0.0).sqrt(), bias: bias.max(0.0).sqrt(), stated }
    }

    /// All pixels but the 0.1 %, rounded up, of the largest noise; of a single pixel that one.
    fn kept(&self, terms: &[Term]) -> Vec<bool> {
        let dropped = terms.len().div_ceil(1000).min(terms.len().saturating_sub(1));
        let mut order: Vec<usize> = (0..terms.len()).collect();
        let mut kept = vec![true; terms.len()];
        if dropped > 0 {
            order.select_nth_unstable_by(dropped - 1, |&a, &b| terms[b].noise.total_cmp(&terms[a].noise));
            order[..dropped].iter().for_each(|&i| kept[i] = false);
        }
        kept
    }

    /// Sums over blocks of what each kept pixel's true squared error may be off from the estimate.
    fn block_sums(&self, terms: &[Term], kept: &[bool]) -> Vec<f64> {
        let width = self.width as usize;
        let columns = width.div_ceil(BLOCK);
        let rows = (terms.len() / width.max(1)).div_ceil(BLOCK);
        let mut sums = vec![0.0; columns * rows];
        for (i, term) in terms.iter().enumerate().filter(|(i, _)| kept[*i]) {
            sums[i / width / BLOCK * columns + i % width / BLOCK] += term.off;
        }
        sums
    }
}

/// A pixel's part in the relative error.
struct Term {
    noise: f64,
    bias: f64,
    off: f64,
}

impl Term {
    fn of(p: &PixelError, reference: f64) -> Self {
        let bias_noise = BIAS_OVER_RING * BIAS_OVER_RING * 2.0 * p.ring * p.ring_swing;
        let halves_noise = 2.0 * p.halves * p.halves_swing;
        Self {
            noise: p.noise() / reference,
            bias: p.bias_sq() / reference,
            off: (p.swing * p.swing - p.variance + bias_noise + halves_noise) / reference,
        }
    }
}
