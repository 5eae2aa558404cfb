//! Ranges of the numbers in a scene, whatever its format, and rounding at their limits.

use std::ops::Range;

/// Largest magnitude of a length, a coordinate or any other number except the strength of a light,
/// in the units of the file. Renderers work in f32, in units of about the scene's size; squares of
/// lengths must stay below 1e30, which stands for infinity there.
pub const LARGEST: f64 = 1e15;
/// Smallest value of a number that must be positive: a radius, a size, a scale, an angle. Its
/// square is above the smallest normal f32.
pub const SMALLEST: f64 = 1e-15;
/// Largest strength of a light. Images store radiance in f32, up to 3e38, and light adds up.
pub const BRIGHTEST: f64 = 1e30;

/// Smallest radius or standard deviation of a pixel filter, in pixels.
pub const NARROWEST_FILTER: f64 = 0.05;
/// Largest radius of a pixel filter, in pixels.
pub const WIDEST_FILTER: f64 = 16.0;
/// Largest shift of a lens, in image widths and heights.
pub const LARGEST_SHIFT: f64 = 16.0;

/// Largest excess of a number over its range that counts as rounding; programs write at least four
/// digits.
const ROUNDING: f64 = 1e-4;

/// The nearest number in a range, if `number` is inside or out of it by a rounding error.
pub(super) fn rounded_into(number: f64, least: f64, most: f64) -> Option<f64> {
    let inside = number.clamp(least, most);
    ((number - inside).abs() <= ROUNDING).then_some(inside)
}

/// Numbers of a file that were clamped into their range.
#[derive(Debug, Default)]
pub(super) struct Rounded {
    count: usize,
    worst: f64,
    at: Range<usize>,
    word: String,
}

impl Rounded {
    /// Records a word that was read as `number`.
    pub fn add(&mut self, at: Range<usize>, word: &str, number: f64) {
        self.count += 1;
        let excess = word.parse().map_or(0.0, |written: f64| (written - number).abs());
        if excess > self.worst {
            (self.worst, self.at, self.word) = (excess, at, word.to_owned());
        }
    }

    /// Position of the worst number, and a message about all.
    pub fn take(self) -> Option<(Range<usize>, String)> {
        let message = match self.count {
            0 => return None,
            1 => format!("`{}` is out of range by rounding", self.word),
            count => format!(
                "{count} numbers are out of range by rounding, the worst is `{}`",
                self.word
            ),
        };
        Some((self.at, message))
    }
}

/// Greatest depth of materials that contain others; an opacity counts as one level.
pub const LAYERS: usize = 12;
