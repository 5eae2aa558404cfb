//! All measures of the difference of two pictures, over the whole and over regions.

use super::flip::{HdrFlip, hdr_flip, ldr_flip};
use super::metrics::{Comparison, MetricsError, compare_in};
use super::plane::Plane;
use super::ssim::Similarity;
use super::{Coding, Picture, Region, colors};

/// A picture against a truth. What looks at a pixel's neighbours is computed once, over the whole
/// pictures; the regions then take its means.
pub struct Difference<'a> {
    a: &'a Picture,
    truth: &'a Picture,
    similarity: Similarity,
    /// LDR-FLIP of each pixel.
    pub ldr_flip: Plane,
    /// HDR-FLIP of each pixel; none for pictures for a display.
    pub hdr_flip: Option<HdrFlip>,
}

/// Figures of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Those of pixels by themselves, of linear light.
    pub pixels: Comparison,
    /// Mean structural similarity; none where no window of 11 x 11 pixels about one of the region's
    /// lies in the picture.
    pub ssim: Option<f64>,
    /// Mean LDR-FLIP.
    pub ldr_flip: f64,
    /// Mean HDR-FLIP; none for pictures for a display.
    pub hdr_flip: Option<f64>,
}

impl<'a> Difference<'a> {
    /// Measures `a` against `truth`, both coded as `coding` says.
    ///
    /// # Errors
    /// For pictures of different sizes, without pixels, or with values that are not finite.
    pub fn new(a: &'a Picture, truth: &'a Picture, coding: Coding) -> Result<Self, MetricsError> {
        let hdr_flip = match coding {
            Coding::Radiance => Some(hdr_flip(a, truth)?),
            Coding::Display => None,
        };
        let (similarity, ldr_flip) = (Similarity::of(a, truth)?, ldr_flip(a, truth)?);
        Ok(Self { a, truth, similarity, ldr_flip, hdr_flip })
    }

    /// The figures of a region, or of the whole picture.
    ///
    /// # Errors
    /// For a region without pixels or with some that the pictures do not have.
    pub fn measures(&self, region: Option<Region>) -> Result<Measures, MetricsError> {
        let region = region.unwrap_or_else(|| Region::whole(self.truth));
        Ok(Measures {
            pixels: compare_in(self.a, self.truth, &region)?,
            ssim: self.similarity.mean(&region),
            ldr_flip: self.ldr_flip.mean(&region),
            hdr_flip: self.hdr_flip.as_ref().map(|flip| flip.map.mean(&region)),
        })
    }
}

/// A map of FLIP as display values, row by row, in FLIP's colors: black for 0, light yellow for 1.
pub fn flip_colors(map: &Plane) -> Vec<[u8; 3]> {
    map.values.iter().map(|value| colors::magma(*value)).collect()
}
