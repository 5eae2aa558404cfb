//! Error metrics of two images, over the whole image and over regions.

use super::flip::{HdrFlip, hdr_flip, ldr_flip};
use super::metrics::{Comparison, MetricsError, compare_in};
use super::plane::Plane;
use super::ssim::Similarity;
use super::{Coding, Picture, Region, colors};

/// Comparison of an image with a reference. Metrics with a spatial filter are computed once over
/// the whole images; regions average the resulting maps.
pub struct Difference<'a> {
    a: &'a Picture,
    truth: &'a Picture,
    similarity: Similarity,
    /// LDR-FLIP of each pixel.
    pub ldr_flip: Plane,
    /// HDR-FLIP of each pixel; `None` for display values.
    pub hdr_flip: Option<HdrFlip>,
}

/// Metrics of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Per-pixel metrics of linear light.
    pub pixels: Comparison,
    /// Mean structural similarity; `None` if no 11 x 11 pixel window centered in the region fits
    /// into the image.
    pub ssim: Option<f64>,
    /// Mean LDR-FLIP.
    pub ldr_flip: f64,
    /// Mean HDR-FLIP; `None` for display values.
    pub hdr_flip: Option<f64>,
}

impl<'a> Difference<'a> {
    /// Compares `a` with `truth`. `coding` is the coding of the files that both were read from.
    ///
    /// # Errors
    /// If the sizes differ, an image is empty, or a value is not finite.
    pub fn new(a: &'a Picture, truth: &'a Picture, coding: Coding) -> Result<Self, MetricsError> {
        let hdr_flip = match coding {
            Coding::Radiance => Some(hdr_flip(a, truth)?),
            Coding::Display => None,
        };
        let (similarity, ldr_flip) = (Similarity::of(a, truth)?, ldr_flip(a, truth)?);
        Ok(Self { a, truth, similarity, ldr_flip, hdr_flip })
    }

    /// Metrics of a region, or of the whole image for `None`.
    ///
    /// # Errors
    /// If the region is empty or extends beyond the image.
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

/// Display values of a FLIP map, row by row, in FLIP's color map: black for 0, light yellow for 1.
pub fn flip_colors(map: &Plane) -> Vec<[u8; 3]> {
    map.values.iter().map(|value| colors::magma(*value)).collect()
}
