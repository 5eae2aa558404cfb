//! What was left out of a picture, so that no NaN and no infinity gets into it.

use serde::Serialize;

/// How many of a pixel's passes did not count, over all pixels, by the first cause that their parts
/// show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rejections {
    /// Emission, environment or throughput along an eye path was not finite.
    pub eye_path: u64,
    /// Sampled direct light was not finite.
    pub direct_light: u64,
    /// The sum of the photons was not finite.
    pub photons: u64,
    /// Each part was finite, the estimate made of them not.
    pub estimate: u64,
    /// No pass, but pixels of the picture with a radiance beyond f32, which hold f32's largest
    /// number instead.
    pub too_bright: u64,
}

impl Rejections {
    /// Number and description of each cause that there was.
    pub fn causes(&self) -> Vec<(u64, &'static str)> {
        let all = [
            (self.eye_path, "eye paths that met no finite light"),
            (self.direct_light, "samples of direct light that were not finite"),
            (self.photons, "sums of photons that were not finite"),
            (self.estimate, "estimates that overflow, though their parts are finite"),
            (self.too_bright, "pixels brighter than a picture can hold"),
        ];
        all.into_iter().filter(|(count, _)| *count > 0).collect()
    }

    /// All of them together.
    pub fn total(&self) -> u64 {
        self.causes().iter().map(|(count, _)| count).sum()
    }

    /// Whether nothing was left out.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}
