//! Range of texels: values that exceed it by rounding are clamped, others are errors.

use crate::scene::appearance::{ImageData, Texels};

/// Largest excess of a texel over its range that counts as rounding: one step of 16-bit floats
/// above 1.
const ROUNDING: f32 = 1.0 / 1024.0;

/// Texels of an image that were clamped into their range.
#[derive(Clone, Debug, Default)]
pub(super) struct Clamped {
    count: usize,
    worst: f32,
    /// The worst value and its position.
    what: String,
}

impl Clamped {
    pub fn message(&self) -> Option<String> {
        let Self { count, what, .. } = self;
        let noun = if *count == 1 { "value" } else { "values" };
        (*count > 0)
            .then(|| format!("{count} {noun} out of range by rounding, the worst is {what}"))
    }
}

/// Clamps texels that are below 0 or above `most` by a rounding error.
///
/// # Errors
/// A texel that is further out of range, or not finite.
pub(super) fn clamp(image: &mut ImageData, most: f32, moved: &mut Clamped) -> Result<(), String> {
    let Texels::Float(texels) = &mut image.texels else { return Ok(()) };
    for (index, texel) in texels.iter_mut().enumerate() {
        if texel.iter().all(|value| (0.0..=most).contains(value)) {
            continue;
        }
        let (x, y) = (index % image.width as usize, index / image.width as usize);
        for value in texel {
            let inside = value.clamp(0.0, most);
            let excess = (*value - inside).abs();
            if !value.is_finite() {
                return Err(format!("texel ({x}, {y}) is {value}, not finite"));
            } else if excess > ROUNDING {
                let why = if *value < 0.0 {
                    "negative"
                } else {
                    "above 1; a surface cannot reflect more than it receives"
                };
                return Err(format!("texel ({x}, {y}) is {value}, {why}"));
            } else if excess > 0.0 {
                moved.count += 1;
                if excess > moved.worst {
                    (moved.worst, moved.what) = (excess, format!("{value:?} at texel ({x}, {y})"));
                }
                *value = inside;
            }
        }
    }
    Ok(())
}
