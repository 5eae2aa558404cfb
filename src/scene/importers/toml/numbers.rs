//! Numbers with a range, and colors made of them. The ranges are part of the JSON Schema, which the
//! checks read.

use schemars::JsonSchema;
use serde::Deserialize;

use crate::scene::Rgb;
use crate::scene::numbers::BRIGHTEST;

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

/// A number from 0 to 1, or the name of a texture, of which the mean of the channels counts.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Amount {
    /// A constant number.
    Number(Share),
    /// Name of a texture.
    Texture(String),
}

impl Default for Amount {
    fn default() -> Self {
        Self::Number(Share::default())
    }
}

/// A number from 0 to 1, two numbers along u and v, or the name of a texture, of which the mean of
/// the channels counts.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum GrainedAmount {
    /// The same number in all directions.
    Number(Share),
    /// Numbers along u and v.
    Grain([Share; 2]),
    /// Name of a texture.
    Texture(String),
}

impl Default for GrainedAmount {
    fn default() -> Self {
        Self::Number(Share::default())
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
