//! ꟻLIP: perceived difference of two images when a viewer alternates between them on a screen.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild, "FLIP: A Difference Evaluator
//! for Alternating Images" (2020), for display values; Andersson, Nilsson, Shirley &
//! Akenine-Möller, "Visualizing Errors in Rendered High Dynamic Range Images" (2021), for radiance.
//! Both give a value in [0, 1] for each pixel.

mod color;
mod eye;
mod hdr;

use super::Picture;
use super::metrics::{MetricsError, check_comparable};
use super::plane::Plane;
use eye::Seen;

pub use hdr::{Exposures, HdrFlip, hdr_flip};

/// Viewing distance of the papers, in pixels per degree of visual angle: a screen 0.7 m and 3840
/// pixels wide at a distance of 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 / 0.7 * 0.7 * (std::f64::consts::PI / 180.0);

/// Computes LDR-FLIP of linear values, which are clamped to [0, 1]. Symmetric.
///
/// # Errors
/// If the images cannot be compared.
pub fn ldr_flip(a: &Picture, b: &Picture) -> Result<Plane, MetricsError> {
    check_comparable(a, b)?;
    let seen = |picture| Seen::of(picture, |value| value.clamp(0.0, 1.0));
    Ok(seen(a).difference(&seen(b)))
}
