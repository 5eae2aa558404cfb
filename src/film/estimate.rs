//! Error estimates: variance and bias of each pixel, and the relative error of the whole image.
//! docs/error-estimate.md describes the method and its accuracy.

use super::Plane;
use super::exr_file::Channel;
use super::plane::{gaussian, normalized};

/// Minimum number of passes for an estimate. With three, the early part would be a single pass.
pub const LEAST_PASSES: u32 = 4;

/// Ratio of the bias of the estimate in a disc to its difference from the estimate in the inner
/// half of the disc's area. If bias scales with the p-th power of the radius, the ratio is
/// `1 / (1 - 2^(-p/2))`: 2 where radiance is smooth (p = 2), about 3.7 at straight edges.
/// Measurements over whole images gave 1.7 to 2.3.
pub const BIAS_OVER_RING: f64 = 2.25;

/// Number of standard errors by which the stated error exceeds the estimate.
pub const CONFIDENCE: f64 = 2.0;

/// Edge, in pixels, of blocks whose errors are treated as independent of each other.
const BLOCK: usize = 16;

/// Constant added to the squared luminance in the denominator of a relative error, as in relMSE.
const DARK: f64 = 0.01;

/// Maximum number of pixels without an event that a pixel with one represents.
const UNSEEN_MOST: f64 = 2.0;

/// Standard deviation, in pixels, of the Gaussian that smooths the bias map.
const SMOOTHING: f64 = 2.0;

/// Error statistics of one pixel: luminance, in W sr^-1 m^-2 or its square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelError {
    /// The estimate.
    pub luminance: f64,
    /// Variance of the mean over the passes, computed as if passes were independent.
    pub variance: f64,
    /// Deviations of the mean, from two partitions of the passes into earlier and later ones. Each
    /// has mean zero and the variance of the mean over all passes, even if the passes are
    /// anticorrelated.
    pub deviations: [f64; 2],
    /// Deviation of the mean over fixed eye samples, from two halves of the samples; 0 if each pass
    /// draws new ones.
    pub halves: f64,
    /// Estimate in the disc minus that in the inner half of its area, averaged over the passes.
    pub bias_probe: f64,
    /// The same average with the sign of odd passes flipped: same noise, zero mean.
    pub bias_probe_alternating: f64,
}

impl PixelError {
    /// Value for a pixel with too few passes.
    pub const UNKNOWN: Self = Self {
        luminance: 0.0,
        variance: f64::INFINITY,
        deviations: [f64::INFINITY; 2],
        halves: 0.0,
        bias_probe: 0.0,
        bias_probe_alternating: 0.0,
    };

    /// Unbiased estimate of the squared bias: product of the means over even and odd passes. May be
    /// negative.
    pub fn bias_sq(&self) -> f64 {
        BIAS_OVER_RING.powi(2)
            * (self.bias_probe + self.bias_probe_alternating)
            * (self.bias_probe - self.bias_probe_alternating)
    }
}

/// Number of passes in the early part of `passes` (at least two): the greatest power of two below
/// `passes`.
pub fn early_passes(passes: u32) -> u32 {
    1 << (passes.max(2) - 1).ilog2()
}

/// Deviation of `mean` over `all` passes, of which the first `part` have the mean `part_mean`.
///
/// The difference of the means over the first `a` and the remaining `b` passes, times
/// `sqrt(a b) / (a + b)`, has the variance of the mean over all passes: exactly if passes are
/// independent, approximately if partial and total sums have similar statistics.
pub fn partition(mean: f64, part_mean: f64, part: u32, all: u32) -> f64 {
    let (n, a) = (f64::from(all), f64::from(part));
    let b = n - a;
    let rest = (n * mean - a * part_mean) / b;
    (part_mean - rest) * (a * b).sqrt() / n
}

/// Error statistics of all pixels of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorMap {
    /// Pixels per row.
    pub width: u32,
    /// Row by row, row 0 on top.
    pub pixels: Vec<PixelError>,
    /// Luminance that one glint, hit by one eye path of one pass, adds to a pixel; 0 if the scene
    /// has none.
    pub glint: f64,
}

/// Relative error of a whole image: square root of the relMSE defined in docs/measures.md.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelativeError {
    /// Noise component of the estimate.
    pub noise: f64,
    /// Bias component of the estimate. The estimate is the hypotenuse of `noise` and `bias`.
    pub bias: f64,
    /// Upper bound that the true error stays below in nine of ten renders.
    pub stated: f64,
}

impl ErrorMap {
    /// Variance of each pixel's luminance, in (W sr^-1 m^-2)^2.
    pub fn variance(&self) -> Plane {
        self.plane(|p| p.variance + p.halves * p.halves)
    }

    /// Bias of each pixel's luminance, in W sr^-1 m^-2, smoothed by a Gaussian of two pixels,
    /// because the bias estimate of a single pixel is more than twice as noisy as the pixel.
    pub fn bias(&self) -> Plane {
        let weights = normalized(&gaussian(SMOOTHING, 3 * SMOOTHING as usize));
        self.plane(|p| BIAS_OVER_RING * p.bias_probe).along_x(&weights).along_y(&weights)
    }

    /// Both maps as EXR layers.
    pub fn layers(&self) -> Vec<Channel> {
        vec![Channel::float("Variance.Y", self.variance()), Channel::float("Bias.Y", self.bias())]
    }

    fn plane(&self, value: impl Fn(&PixelError) -> f64) -> Plane {
        Plane { width: self.width as usize, values: self.pixels.iter().map(value).collect() }
    }

    /// Relative error of the whole image.
    pub fn relative(&self) -> RelativeError {
        let third = [1.0 / 3.0; 3];
        let around = self.plane(|p| p.luminance).along_x(&third).along_y(&third);
        let terms: Vec<Term> = self
            .pixels
            .iter()
            .zip(&around.values)
            .map(|(p, around)| Term::of(p, *around))
            .collect();
        let kept = kept(&terms);
        let count = kept.iter().filter(|kept| **kept).count().max(1) as f64;
        let sum = |part: fn(&Term) -> f64| {
            let all = terms.iter().zip(&kept).filter(|(_, kept)| **kept);
            all.map(|(term, _)| part(term)).sum::<f64>()
        };
        let (noise, bias) = (sum(|t| t.noise) / count, sum(|t| t.bias) / count);
        let blocks = self.block_sums(&terms, &kept).iter().map(|sum| sum * sum).sum::<f64>();
        // Assume one glint more than was seen (rule of succession): as long as no pixel has hit
        // one, nothing else accounts for those still missing.
        let mean =
            self.pixels.iter().map(|p| p.luminance).sum::<f64>() / self.pixels.len().max(1) as f64;
        let mut unseen = lacking(self.glint, mean);
        let mut unseen_sq = unseen * unseen;
        for (term, _) in terms.iter().zip(&kept).filter(|(_, kept)| !**kept) {
            unseen += term.unseen;
            unseen_sq += term.unseen * term.unseen;
        }
        let off = (blocks + sum(|t| t.alone_sq) + unseen_sq).sqrt() / count;
        let stated = ((noise + bias).max(0.0) + unseen / count + CONFIDENCE * off).sqrt();
        // an overflow bounds nothing
        let stated = if stated.is_nan() { f64::INFINITY } else { stated };
        RelativeError { noise: noise.max(0.0).sqrt(), bias: bias.max(0.0).sqrt(), stated }
    }

    /// Sums, per block, of the correlated part of each kept pixel's error in its squared error.
    fn block_sums(&self, terms: &[Term], kept: &[bool]) -> Vec<f64> {
        let width = (self.width as usize).max(1);
        let columns = width.div_ceil(BLOCK);
        let rows = (terms.len() / width).div_ceil(BLOCK);
        let mut sums = vec![0.0; columns * rows];
        for (i, term) in terms.iter().enumerate().filter(|(i, _)| kept[*i]) {
            sums[i / width / BLOCK * columns + i % width / BLOCK] += term.off;
        }
        sums
    }
}

/// Contribution of a pixel to the relative error. All values are squared and relative.
struct Term {
    /// Sort key: pixels with the largest are dropped.
    rank: f64,
    noise: f64,
    bias: f64,
    /// Zero-mean value that scatters as `noise` and `bias` do, and as the true error does.
    off: f64,
    /// Variance of the part that is independent of neighboring pixels.
    alone_sq: f64,
    /// Expected squared error in other pixels that have not yet received light like this pixel's.
    unseen: f64,
}

impl Term {
    /// Normalizes the noise of the passes and the bias by the estimate minus its standard
    /// deviation. If a single pass was bright, this is the estimate of the other passes, so a rare
    /// bright sample does not hide its own error. The noise of a few fixed eye samples is
    /// normalized by the mean of the surrounding pixels instead: if all samples agree by chance,
    /// the pixel's own estimate is far off.
    fn of(p: &PixelError, around: f64) -> Self {
        let share_of = |reference: f64| 1.0 / (reference * reference + DARK);
        let share = share_of((p.luminance - p.variance.sqrt()).max(0.0));
        let [first, second] = p.deviations.map(|deviation| deviation * deviation);
        let halves = p.halves * p.halves * share_of(around);
        let bias_off = BIAS_OVER_RING.powi(2) * 2.0 * p.bias_probe * p.bias_probe_alternating;
        Self {
            rank: p.variance * share,
            noise: 0.5 * (first + second) * share + halves,
            bias: p.bias_sq() * share,
            off: (first - second + bias_off) * share,
            // one for the estimate, one for the true error: the square of each has this variance
            alone_sq: 2.0 * halves * halves,
            unseen: unseen(p),
        }
    }
}

/// Expected squared relative error in pixels that missed an event, given a pixel `p` that had one.
///
/// A glint that is hit in one pass out of hundreds contributes to the mean of some pixels and is
/// missing from others, and no variance accounts for the missing light. The event rates of all
/// pixels without an event sum to the expected number of pixels with exactly one (Good 1953), so
/// the light v of a single event represents the same amount of missing light. Missing light x next
/// to steady light b has the squared relative error
/// `x^2 / ((b + x)^2 + DARK) <= x / (2 (b + sqrt(b^2 + DARK)))`, here with x = v. The number of
/// events is estimated as the squared ratio of mean to standard deviation: n events of v each have
/// the mean n v and the variance n v^2. Steady light raises the mean, so an estimate of two events
/// still counts half.
///
/// Regardless of its brightness, an event counts for at most [`UNSEEN_MOST`] pixels. Pixels with a
/// smaller chance of an event than one in that many are covered by the 0.1 % that relMSE drops.
fn unseen(p: &PixelError) -> f64 {
    let single = 0.5 * (3.0 - p.luminance * p.luminance / p.variance);
    let event = p.variance.sqrt();
    let seen = (p.luminance - event).max(0.0);
    if single > 0.0 { single.min(1.0) * lacking(event, seen) } else { 0.0 }
}

/// Squared relative error of pixels that miss the light `event` next to steady light `seen`.
fn lacking(event: f64, seen: f64) -> f64 {
    (event / (2.0 * (seen + seen.hypot(DARK.sqrt())))).min(UNSEEN_MOST)
}

/// Mask of all pixels except the 0.1 % (rounded up) with the largest relative variance; a single
/// pixel is always kept. Ranking by deviations would favor those that are small by chance.
fn kept(terms: &[Term]) -> Vec<bool> {
    let dropped = terms.len().div_ceil(1000).min(terms.len().saturating_sub(1));
    let mut kept = vec![true; terms.len()];
    if dropped > 0 {
        let mut order: Vec<usize> = (0..terms.len()).collect();
        order.select_nth_unstable_by(dropped - 1, |&a, &b| terms[b].rank.total_cmp(&terms[a].rank));
        order[..dropped].iter().for_each(|&i| kept[i] = false);
    }
    kept
}
