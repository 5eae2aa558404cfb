//! HDR-FLIP: at every pixel the largest LDR-FLIP over a series of exposures.

use super::eye::Seen;
use crate::film::metrics::{MetricsError, check_comparable};
use crate::film::plane::Plane;
use crate::film::{Picture, luminance};

/// The ACES curve of Narkowicz (2015) without its factor on the exposure:
/// `(k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5)`.
const ACES: [f64; 6] = [0.36 * 2.51, 0.6 * 0.03, 0.0, 0.36 * 2.43, 0.6 * 0.59, 0.14];
/// What the brightest pixel becomes at the first exposure, and the median at the last.
const BRIGHT: f64 = 0.85;
/// Medians below this count as it, as in the authors' program; half a picture may be black.
const DARKEST: f64 = f32::EPSILON as f64;

/// Exposures, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The first, in stops (powers of two): the truth's largest luminance becomes 0.85.
    pub start: f64,
    /// The last: the truth's median luminance becomes 0.85.
    pub stop: f64,
    /// How many: one a stop, and two at least.
    pub count: u32,
}

impl Exposures {
    /// The exposures that show all of a picture. A black one has nothing to show: twice exposure 0.
    pub fn of(truth: &Picture) -> Self {
        let light = |rgb: &[f32; 3]| luminance(rgb.map(|value| value.max(0.0)));
        let mut luminances: Vec<f64> = truth.rgb.iter().map(light).collect();
        luminances.sort_by(f64::total_cmp);
        let largest = luminances.last().copied().unwrap_or(0.0);
        if largest <= 0.0 {
            return Self { start: 0.0, stop: 0.0, count: 2 };
        }
        // the upper of two middle values, as in the authors' program
        let median = luminances[luminances.len() / 2].max(DARKEST);
        let (start, stop) =
            ((unmapped(BRIGHT) / largest).log2(), (unmapped(BRIGHT) / median).log2());
        // A largest one below DARKEST would turn the order round.
        let stop = stop.max(start);
        Self { start, stop, count: ((stop - start).ceil() as u32).max(2) }
    }

    /// Each, in stops.
    pub fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / f64::from(self.count - 1);
        (0..self.count).map(move |i| self.start + f64::from(i) * step)
    }
}

/// A map of HDR-FLIP and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct HdrFlip {
    /// The values.
    pub map: Plane,
    /// The exposures, which follow from the truth.
    pub exposures: Exposures,
}

/// HDR-FLIP of `a` against the truth `b`, with the ACES tone mapper; values below zero count as
/// zero. Not symmetric, since the exposures are the truth's.
///
/// # Errors
/// For pictures that cannot be compared.
pub fn hdr_flip(a: &Picture, b: &Picture) -> Result<HdrFlip, MetricsError> {
    check_comparable(a, b)?;
    let exposures = Exposures::of(b);
    let mut map = Plane { width: b.width as usize, values: vec![0.0; b.rgb.len()] };
    for stops in exposures.stops() {
        let exposure = stops.exp2();
        let seen = |picture| Seen::of(picture, |value| aces(value.max(0.0) * exposure));
        map = map.zip(&seen(a).difference(&seen(b)), f64::max);
    }
    Ok(HdrFlip { map, exposures })
}

/// Linear display values in [0, 1].
fn aces(x: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES;
    let y = (k0 * x * x + k1 * x + k2) / (k3 * x * x + k4 * x + k5);
    y.clamp(0.0, 1.0)
}

/// The exposed radiance that becomes `y`, for `y` below one: the positive root of a quadratic
/// equation.
fn unmapped(y: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES;
    let (a, b, c) = (k0 - k3 * y, k1 - k4 * y, k2 - k5 * y);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}
