//! Counts of samples rejected to keep NaN and infinity out of the image.

use serde::Serialize;

/// Number of rejected pixel samples (one pass at one pixel), by the first component that was not
/// finite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rejections {
    /// Emission, environment or throughput along an eye path was not finite.
    pub eye_path: u64,
    /// Sampled direct light was not finite.
    pub direct_light: u64,
    /// The sum of the photons was not finite.
    pub photons: u64,
    /// Each component was finite, but the resulting estimate was not.
    pub estimate: u64,
    /// Number of image pixels, not samples, that exceed the range of f32 and are clamped to its
    /// largest value.
    pub too_bright: u64,
}

impl Rejections {
    /// Count and description of each cause that occurred.
    pub fn causes(&self) -> Vec<(u64, &'static str)> {
        let all = [
            (self.eye_path, "eye paths with radiance that was not finite"),
            (self.direct_light, "samples of direct light that were not finite"),
            (self.photons, "sums of photons that were not finite"),
            (self.estimate, "estimates that overflow although their parts are finite"),
            (self.too_bright, "pixels too bright for 32-bit floats"),
        ];
        all.into_iter().filter(|(count, _)| *count > 0).collect()
    }

    /// Sum over all causes.
    pub fn total(&self) -> u64 {
        self.causes().iter().map(|(count, _)| count).sum()
    }

    /// Returns true if nothing was rejected.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
