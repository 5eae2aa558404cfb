//! What a picture says of its own error: variance and bias of every pixel, and one number for the
//! whole. docs/error-estimate.md tells the method and how good it is.

use super::Plane;
use super::exr_file::Channel;
use super::plane::{gaussian, normalized};

/// Least number of passes whose picture has an estimate: with three the earlier part is a single
/// pass.
pub const LEAST_PASSES: u32 = 4;

/// Bias of the estimate in a disc over what it differs by from that in the inner half of the disc's
/// area. Where bias falls as the p-th power of the radius this is `1 / (1 - 2^(-p/2))`: 2 where
/// radiance is smooth (p = 2), some 3.7 over straight edges; over whole pictures 1.7 to 2.3 were
/// measured.
pub const BIAS_OVER_RING: f64 = 2.25;

/// The stated error is so many of the estimate's standard errors above the estimate.
pub const CONFIDENCE: f64 = 2.0;

/// Edge of the blocks, in pixels, whose errors count as independent of one another.
const BLOCK: usize = 16;

/// Added to the squared luminance that an error is relative to, as in relMSE.
const DARK: f64 = 0.01;

/// Pixels without an event that a pixel with one stands for, at the most.
const UNSEEN_MOST: f64 = 2.0;

/// Standard deviation, in pixels, of the Gaussian that smooths the map of the bias.
const SMOOTHING: f64 = 2.0;

/// What is known of one pixel's error: luminance, in W sr^-1 m^-2 or its square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelError {
    /// The estimate.
    pub luminance: f64,
    /// Variance of the mean over the passes from their mean squared deviation, as if they were
    /// independent.
    pub variance: f64,
    /// Deviations of the mean, from two partitions of the passes into earlier and later ones. Each
    /// has mean zero and the variance of the mean over all, also where passes even one another out.
    pub deviations: [f64; 2],
    /// Deviation of the mean over fixed eye samples, from two halves of them; 0 where each pass has
    /// its own.
    pub halves: f64,
    /// Estimate in the disc less that in the inner half of its area, mean over the passes.
    pub bias_probe: f64,
    /// The same mean with odd passes turned over: the same noise and no signal.
    pub bias_probe_alternating: f64,
}

impl PixelError {
    /// Of a pixel with too few passes.
    pub const UNKNOWN: Self = Self {
        luminance: 0.0,
        variance: f64::INFINITY,
        deviations: [f64::INFINITY; 2],
        halves: 0.0,
        bias_probe: 0.0,
        bias_probe_alternating: 0.0,
    };

    /// Unbiased estimate of the squared bias, from the product of the means over even and over odd
    /// passes; it may be negative.
    pub fn bias_sq(&self) -> f64 {
        BIAS_OVER_RING.powi(2)
            * (self.bias_probe + self.bias_probe_alternating)
            * (self.bias_probe - self.bias_probe_alternating)
    }
}

/// Passes in the early part of `passes`, at least two: the greatest power of two below.
pub fn early_passes(passes: u32) -> u32 {
    1 << (passes.max(2) - 1).ilog2()
}

/// Deviation of `mean` over `all` passes, of which the first `part` have `part_mean`.
///
/// The difference of the means over the first and over the other passes times `sqrt(a b) / (a +
/// b)`, a and b passes in them, has the variance of the mean over all: exactly for independent
/// passes, and for others as far as their sums over a part and over all behave alike.
pub fn partition(mean: f64, part_mean: f64, part: u32, all: u32) -> f64 {
    let (n, a) = (f64::from(all), f64::from(part));
    let b = n - a;
    let rest = (n * mean - a * part_mean) / b;
    (part_mean - rest) * (a * b).sqrt() / n
}

/// The errors of all pixels of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorMap {
    /// Pixels per row.
    pub width: u32,
    /// Row by row, row 0 on top.
    pub pixels: Vec<PixelError>,
    /// What one glint, met by one eye path of one pass, adds to a pixel's luminance; 0 where none
    /// can be.
    pub glint: f64,
}

/// Relative error of a whole picture: root of the relMSE of docs/measures.md.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelativeError {
    /// Part of the estimate that is noise.
    pub noise: f64,
    /// Part of the estimate that is bias; both are the legs of which the estimate is the
    /// hypotenuse.
    pub bias: f64,
    /// The true error is within this one in nine of ten renders.
    pub stated: f64,
}

impl ErrorMap {
    /// Variance of each pixel's luminance, in squares of W sr^-1 m^-2.
    pub fn variance(&self) -> Plane {
        self.plane(|p| p.variance + p.halves * p.halves)
    }

    /// Bias of each pixel's luminance, in W sr^-1 m^-2, smoothed by a Gaussian of two pixels: a
    /// single pixel's estimate has more than twice the noise of the pixel itself.
    pub fn bias(&self) -> Plane {
        let weights = normalized(&gaussian(SMOOTHING, 3 * SMOOTHING as usize));
        self.plane(|p| BIAS_OVER_RING * p.bias_probe).along_x(&weights).along_y(&weights)
    }

    /// Both maps as layers of a picture file.
    pub fn layers(&self) -> Vec<Channel> {
        vec![Channel::float("Variance.Y", self.variance()), Channel::float("Bias.Y", self.bias())]
    }

    fn plane(&self, value: impl Fn(&PixelError) -> f64) -> Plane {
        Plane { width: self.width as usize, values: self.pixels.iter().map(value).collect() }
    }

    /// The whole picture's error.
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
        // one glint more than were seen (the rule of succession): where no pixel has met one yet,
        // nothing else speaks for those that some pixel lacks
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
        // what overflows is no promise
        let stated = if stated.is_nan() { f64::INFINITY } else { stated };
        RelativeError { noise: noise.max(0.0).sqrt(), bias: bias.max(0.0).sqrt(), stated }
    }

    /// Sums over blocks of what each kept pixel's squared error may be off by together with its
    /// neighbours'.
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

/// A pixel's part in the relative error, all squared and relative.
struct Term {
    /// Rank among the pixels whose largest are dropped.
    rank: f64,
    noise: f64,
    bias: f64,
    /// A number of mean zero that scatters as `noise` and `bias` do, and as the true error does.
    off: f64,
    /// Variance of that which shares nothing with neighbours.
    alone_sq: f64,
    /// What light that came here once may cost in pixels that it has not come to yet.
    unseen: f64,
}

impl Term {
    /// Noise of the passes and bias are relative to the estimate less its standard deviation: where
    /// a single pass was bright this is what the others found, so that a rare bright sample does
    /// not dwarf its own error. That of some few eye samples is relative to the mean of the pixels
    /// around, for where all of them agree by chance the estimate is far off.
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
            // of the estimate and of the true error, each of which has a square of this size
            alone_sq: 2.0 * halves * halves,
            unseen: unseen(p),
        }
    }
}

/// Squared relative error that pixels without an event owe to those with one, where `p` had one.
///
/// A glint that one pass in hundreds sees is in the mean of some pixels and of others not; what it
/// leaves the others short of is in no variance. The rates of events in all pixels without one sum
/// up to the expected number of pixels with one (Good 1953), so the light v of a single event
/// stands for as much light unseen. Of unseen light x beside b that is always seen the squared
/// relative error is `x^2 / ((b + x)^2 + DARK) <= x / (2 (b + sqrt(b^2 + DARK)))`, hence v over
/// that. The number of events is told by the mean over its deviation, squared: n events of v each
/// have the mean n v and the variance n v^2. What is always seen adds to the mean, so two events'
/// worth still count half.
///
/// However bright, an event counts for [`UNSEEN_MOST`] pixels: those that have less than one chance
/// in that many to meet theirs are what the largest 0.1 % are left out for.
fn unseen(p: &PixelError) -> f64 {
    let single = 0.5 * (3.0 - p.luminance * p.luminance / p.variance);
    let event = p.variance.sqrt();
    let seen = (p.luminance - event).max(0.0);
    if single > 0.0 { single.min(1.0) * lacking(event, seen) } else { 0.0 }
}

/// Squared relative error of the pixels that lack an event beside light `seen`.
fn lacking(event: f64, seen: f64) -> f64 {
    (event / (2.0 * (seen + seen.hypot(DARK.sqrt())))).min(UNSEEN_MOST)
}

/// All pixels but the 0.1 %, rounded up, of the largest variance; of a single pixel that one. The
/// rank does not look at deviations, which would favour those that happen to be small.
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
