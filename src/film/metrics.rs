//! Per-pixel error metrics of two images.

use thiserror::Error;

use super::{Picture, Region, luminance};

/// Metrics of an image `a` against a reference `b`.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of `a` divided by mean of `b` per channel; 1 if both are zero.
    pub mean_ratio: [f64; 3],
    /// Mean over pixels of `(La - Lb)^2 / (Lb^2 + 0.01)` without the largest 0.1 % (rounded up);
    /// `L` is luminance.
    pub rel_mse: f64,
    /// Mean squared difference over all channel values, in (W sr^-1 m^-2)^2.
    pub mse: f64,
    /// Median over pixels of `|La - Lb| / Lb`; 0 if both are zero, infinite if only `Lb` is zero.
    pub median: f64,
    /// Root mean squared difference over all channel values, in W sr^-1 m^-2.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in dB. The peak is the largest value of the whole reference.
    /// Infinite for equal images.
    pub psnr: f64,
    /// Pixel with the largest absolute channel difference; the first in reading order if several
    /// are equal.
    pub worst: WorstPixel,
    /// Number of pixels that differ in at least one bit.
    pub pixels_differing: usize,
    /// Number of pixels.
    pub pixels: usize,
}

/// Values of two images at one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstPixel {
    /// Column.
    pub x: u32,
    /// Row, 0 on top.
    pub y: u32,
    /// Value in the first image.
    pub a: [f32; 3],
    /// Value in the second image.
    pub b: [f32; 3],
}

/// Reason why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MetricsError {
    /// Their sizes differ.
    #[error("the image sizes differ: {}x{} and {}x{}", .a.0, .a.1, .b.0, .b.1)]
    Size {
        /// Width and height of the first.
        a: (u32, u32),
        /// Width and height of the second.
        b: (u32, u32),
    },
    /// An image contains NaN or infinity.
    #[error(
        "{count} values of the {which} image are NaN or infinite, the first in column {}, row {}",
        .at.0, .at.1
    )]
    NotFinite {
        /// "first" or "second".
        which: &'static str,
        /// Number of such channel values.
        count: usize,
        /// Column and row of the first in reading order.
        at: (u32, u32),
    },
    /// The images are empty.
    #[error("the images have no pixels")]
    Empty,
    /// A region is empty or extends beyond the images.
    #[error(
        "the region ({region}) is empty, or extends beyond the images' {width} columns and \
         {height} rows"
    )]
    Region {
        /// The region.
        region: Region,
        /// Columns of the images.
        width: u32,
        /// Rows of the images.
        height: u32,
    },
}

/// Compares `a` with the reference `b`.
pub fn compare(a: &Picture, b: &Picture) -> Result<Comparison, MetricsError> {
    check_comparable(a, b)?;
    Ok(figures(a, b, peak(b)))
}

/// Compares the pixels of a region.
pub fn compare_in(a: &Picture, b: &Picture, region: &Region) -> Result<Comparison, MetricsError> {
    check_comparable(a, b)?;
    if !region.fits(b.width, b.height) {
        return Err(MetricsError::Region { region: *region, width: b.width, height: b.height });
    }
    let mut comparison = figures(&region.crop(a), &region.crop(b), peak(b));
    comparison.worst.x += region.x0;
    comparison.worst.y += region.y0;
    Ok(comparison)
}

fn peak(truth: &Picture) -> f32 {
    truth.rgb.as_flattened().iter().fold(0.0, |peak: f32, &value| peak.max(value))
}

fn figures(a: &Picture, b: &Picture, peak: f32) -> Comparison {
    let mse =
        mean(a.rgb.as_flattened().iter().zip(b.rgb.as_flattened()).map(|(&a, &b)| squared(a, b)));
    Comparison {
        mean_ratio: mean_ratio(a, b),
        rel_mse: rel_mse(a, b),
        mse,
        median: median(a, b),
        rmse: mse.sqrt(),
        psnr: if mse == 0.0 {
            f64::INFINITY
        } else {
            10.0 * (f64::from(peak).powi(2) / mse).log10()
        },
        worst: worst_pixel(a, b),
        pixels_differing: a.rgb.iter().zip(&b.rgb).filter(|(a, b)| !same_bits(**a, **b)).count(),
        pixels: a.rgb.len(),
    }
}

fn median(a: &Picture, b: &Picture) -> f64 {
    let share = |(&a, &b): (&[f32; 3], &[f32; 3])| {
        let (a, b) = (luminance(a), luminance(b));
        if a == b { 0.0 } else { (a - b).abs() / b.abs() }
    };
    let mut shares: Vec<f64> = a.rgb.iter().zip(&b.rgb).map(share).collect();
    let middle = shares.len() / 2;
    *shares.select_nth_unstable_by(middle, f64::total_cmp).1
}

impl Comparison {
    /// Largest deviation of a channel's mean ratio from one.
    pub fn mean_error(&self) -> f64 {
        self.mean_ratio.iter().fold(0.0, |largest: f64, ratio| largest.max((ratio - 1.0).abs()))
    }
}

/// Fails if the sizes differ, the images are empty, or a value is not finite.
pub(super) fn check_comparable(a: &Picture, b: &Picture) -> Result<(), MetricsError> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(MetricsError::Size { a: (a.width, a.height), b: (b.width, b.height) });
    }
    if a.rgb.is_empty() {
        return Err(MetricsError::Empty);
    }
    for (which, picture) in [("first", a), ("second", b)] {
        let first = picture.rgb.iter().position(|rgb| !rgb.iter().all(|value| value.is_finite()));
        if let Some(first) = first {
            let (count, at) = (picture.not_finite(), picture.position(first));
            return Err(MetricsError::NotFinite { which, count, at });
        }
    }
    Ok(())
}

/// Largest absolute difference of a channel.
pub(super) fn difference(a: [f32; 3], b: [f32; 3]) -> f64 {
    (0..3).fold(0.0, |largest: f64, i| largest.max((f64::from(a[i]) - f64::from(b[i])).abs()))
}

/// Returns true if two pixels are bit-identical; 0 and -0 are not.
pub(super) fn same_bits(a: [f32; 3], b: [f32; 3]) -> bool {
    a.map(f32::to_bits) == b.map(f32::to_bits)
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len();
    values.sum::<f64>() / count as f64
}

fn squared(a: f32, b: f32) -> f64 {
    (f64::from(a) - f64::from(b)).powi(2)
}

fn mean_ratio(a: &Picture, b: &Picture) -> [f64; 3] {
    [0, 1, 2].map(|channel| {
        let mean = |picture: &Picture| mean(picture.rgb.iter().map(|rgb| f64::from(rgb[channel])));
        let (a, b) = (mean(a), mean(b));
        if a == b { 1.0 } else { a / b }
    })
}

fn rel_mse(a: &Picture, b: &Picture) -> f64 {
    let error = |(a, b): (&[f32; 3], &[f32; 3])| {
        let (a, b) = (luminance(*a), luminance(*b));
        (a - b).powi(2) / (b.powi(2) + 0.01)
    };
    let mut errors: Vec<f64> = a.rgb.iter().zip(&b.rgb).map(error).collect();
    errors.sort_by(f64::total_cmp);
    let dropped = errors.len().div_ceil(1000);
    // keep at least one pixel
    let kept = (errors.len() - dropped).max(1);
    mean(errors[..kept].iter().copied())
}

fn worst_pixel(a: &Picture, b: &Picture) -> WorstPixel {
    let mut worst = (0, 0.0);
    for (index, (pixel_a, pixel_b)) in a.rgb.iter().zip(&b.rgb).enumerate() {
        let difference = difference(*pixel_a, *pixel_b);
        if difference > worst.1 {
            worst = (index, difference);
        }
    }
    let (x, y) = a.position(worst.0);
    WorstPixel { x, y, a: a.rgb[worst.0], b: b.rgb[worst.0] }
}
