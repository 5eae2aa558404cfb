//! HDR-FLIP: maximum of LDR-FLIP over a series of exposures, at each pixel.

use super::eye::Seen;
use crate::film::metrics::{MetricsError, check_comparable};
use crate::film::plane::Plane;
use crate::film::{Picture, luminance};

/// The ACES curve of Narkowicz (2015) without its factor on the exposure:
/// `(k0 x^2 + k1 x + k2) / (k3 x^2 + k4 x + k5)`.
const ACES: [f64; 6] = [0.36 * 2.51, 0.6 * 0.03, 0.0, 0.36 * 2.43, 0.6 * 0.59, 0.14];
/// Display value of the brightest pixel at the first exposure, and of the median at the last.
const BRIGHT: f64 = 0.85;
/// Lower bound of the median, as in the authors' program, since half of an image may be black.
const DARKEST: f64 = f32::EPSILON as f64;

/// Evenly spaced exposures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// First exposure in stops (powers of two): maps the reference's largest luminance to 0.85.
    pub start: f64,
    /// Last exposure in stops: maps the reference's median luminance to 0.85.
    pub stop: f64,
    /// Number of exposures: one per stop, at least two.
    pub count: u32,
}

impl Exposures {
    /// Exposures that cover the luminance range of an image. A black image gets exposure 0 twice.
    pub fn of(truth: &Picture) -> Self {
        let light = |rgb: &[f32; 3]| luminance(rgb.map(|value| value.max(0.0)));
        let mut luminances: Vec<f64> = truth.rgb.iter().map(light).collect();
        luminances.sort_by(f64::total_cmp);
        let largest = luminances.last().copied().unwrap_or(0.0);
        if largest <= 0.0 {
            return Self { start: 0.0, stop: 0.0, count: 2 };
        }
        // upper median, as in the authors' program
        let median = luminances[luminances.len() / 2].max(DARKEST);
        let (start, stop) =
            ((unmapped(BRIGHT) / largest).log2(), (unmapped(BRIGHT) / median).log2());
        // a maximum below DARKEST would reverse the order
        let stop = stop.max(start);
        Self { start, stop, count: ((stop - start).ceil() as u32).max(2) }
    }

    /// The exposures in stops.
    pub fn stops(self) -> impl Iterator<Item = f64> {
        let step = (self.stop - self.start) / f64::from(self.count - 1);
        (0..self.count).map(move |i| self.start + f64::from(i) * step)
    }
}

/// HDR-FLIP map and its exposures.
#[derive(Clone, Debug, PartialEq)]
pub struct HdrFlip {
    /// HDR-FLIP of each pixel, in [0, 1].
    pub map: Plane,
    /// Exposures derived from the reference.
    pub exposures: Exposures,
}

/// Computes HDR-FLIP of `a` against the reference `b` with the ACES tone mapper. Negative values
/// are clamped to zero. Not symmetric, because the reference determines the exposures.
///
/// # Errors
/// If the images cannot be compared.
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

/// Tone-maps exposed radiance to a linear display value in [0, 1].
fn aces(x: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES;
    let y = (k0 * x * x + k1 * x + k2) / (k3 * x * x + k4 * x + k5);
    y.clamp(0.0, 1.0)
}

/// Inverse of the tone map for `y` below one: positive root of a quadratic equation.
fn unmapped(y: f64) -> f64 {
    let [k0, k1, k2, k3, k4, k5] = ACES;
    let (a, b, c) = (k0 - k3 * y, k1 - k4 * y, k2 - k5 * y);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}
