//! Structural similarity (SSIM).
//!
//! Wang, Bovik, Sheikh & Simoncelli, "Image Quality Assessment: From Error Visibility to Structural
//! Similarity" (2004), equation 13, with the paper's window (11 x 11 pixels of a Gaussian with
//! sigma = 1.5 pixels) and constants K1 = 0.01, K2 = 0.03. The input is the Rec. 709 luma
//! `Y' = 0.2126 R' + 0.7152 G' + 0.0722 B'` of the image, clipped to [0, 1] and sRGB-encoded.

use super::metrics::{MetricsError, check_comparable};
use super::plane::{Plane, gaussian, normalized};
use super::{Picture, Region};
use crate::math::srgb::srgb_from_linear;

/// Pixels from the center of a window to its edge.
pub const WINDOW_RADIUS: u32 = 5;
const WINDOW_SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// SSIM map: similarity of the windows around each pixel, in [-1, 1]; 1 if they are equal.
pub struct Similarity(Plane);

impl Similarity {
    /// Computes the SSIM map of two images.
    ///
    /// # Errors
    /// If the images cannot be compared.
    pub fn of(a: &Picture, b: &Picture) -> Result<Self, MetricsError> {
        check_comparable(a, b)?;
        let window = normalized(&gaussian(WINDOW_SIGMA, WINDOW_RADIUS as usize));
        let mean = |plane: &Plane| plane.along_x(&window).along_y(&window);
        let (a, b) = (Plane::of(a, luma), Plane::of(b, luma));
        let product = |p: &Plane, q: &Plane| p.zip(q, |p, q| p * q);
        let (mean_a, mean_b) = (mean(&a), mean(&b));
        // covariance = mean of the product minus product of the means
        let covariance = |p: &Plane, q: &Plane, mean_p: &Plane, mean_q: &Plane| {
            mean(&product(p, q)).zip(&product(mean_p, mean_q), |both, apart| both - apart)
        };
        let variances = covariance(&a, &a, &mean_a, &mean_a)
            .zip(&covariance(&b, &b, &mean_b, &mean_b), |variance_a, variance_b| {
                variance_a + variance_b
            });
        let structure = covariance(&a, &b, &mean_a, &mean_b)
            .zip(&variances, |covariance, variances| (2.0 * covariance + C2) / (variances + C2));
        let luminance = mean_a.zip(&mean_b, |a, b| (2.0 * (a * b) + C1) / (a * a + b * b + C1));
        Ok(Self(product(&luminance, &structure)))
    }

    /// Mean over all windows that lie in the image and are centered in the region, or `None` if
    /// there are none.
    pub fn mean(&self, region: &Region) -> Option<f64> {
        let (width, height) = (self.0.width, self.0.values.len() / self.0.width);
        let middles = region.inside(WINDOW_RADIUS, width as u32, height as u32);
        (!middles.is_empty()).then(|| self.0.mean(&middles))
    }
}

fn luma(radiance: [f32; 3]) -> f64 {
    let [r, g, b] = radiance.map(|value| srgb_from_linear(f64::from(value).clamp(0.0, 1.0)));
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
