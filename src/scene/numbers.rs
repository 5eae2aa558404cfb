//! Numbers with a range, and colors made of them. The ranges are part of the JSON Schema, which the
//! checks read.

use std::ops::Range;

use schemars::JsonSchema;
use serde::Deserialize;

use super::appearance::Rgb;

/// Largest magnitude of a length, a coordinate or any other number except the strength of a light,
/// in the units of the file. Renderers work in f32, in units of about the scene's size; squares of
/// lengths must stay below 1e30, which stands for infinity there.
pub const LARGEST: f64 = 1e15;
/// Smallest value of a number that must be positive: a radius, a size, a scale, an angle. Its
/// square is above the smallest normal f32.
pub const SMALLEST: f64 = 1e-15;
/// Largest strength of a light. Images store radiance in f32, up to 3e38, and light adds up.
pub const BRIGHTEST: f64 = 1e30;

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

/// A number greater than 0.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("exclusiveMinimum" = 0))]
pub struct Positive(pub f64);

/// A non-negative number.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = 0))]
pub struct NonNegative(pub f64);

/// Strength of a light, from 0 to 1e30.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = 0, "x-largest" = BRIGHTEST))]
pub struct Strength(pub f64);

/// A number from 0 to 1.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(transparent)]
#[schemars(inline, extend("minimum" = 0, "maximum" = 1))]
pub struct Share(pub f64);

impl From<Positive> for f64 {
    fn from(number: Positive) -> Self {
        number.0
    }
}

impl From<NonNegative> for f64 {
    fn from(number: NonNegative) -> Self {
        number.0
    }
}

impl From<Strength> for f64 {
    fn from(number: Strength) -> Self {
        number.0
    }
}

impl From<Share> for f64 {
    fn from(number: Share) -> Self {
        number.0
    }
}

/// One number for all channels, or linear [r, g, b].
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Spectrum<T> {
    /// The same value for red, green and blue.
    Gray(T),
    /// Linear Rec. 709 channels.
    Rgb([T; 3]),
}

impl<T: Default> Default for Spectrum<T> {
    fn default() -> Self {
        Self::Gray(T::default())
    }
}

impl<T: Copy + Into<f64>> Spectrum<T> {
    /// The three channels.
    pub fn rgb(&self) -> Rgb {
        match *self {
            Self::Gray(value) => [value.into(); 3],
            Self::Rgb(channels) => channels.map(Into::into),
        }
    }
}

/// A number from 0 to 1, linear [r, g, b], or the name of a texture.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Paint {
    /// A constant color.
    Color(Spectrum<Share>),
    /// Name of a texture.
    Texture(String),
}
