//! Conversion of a film to an image, an error estimate and rejection counts, in world units.

use super::super::kernels::records::*;
use crate::film::estimate::{LEAST_PASSES, PixelError, early_passes, partition};
use crate::film::{ErrorMap, Picture, Rejections, luminance_of};

/// Converter for films of one size and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readout {
    /// Pixels per row.
    pub width: u32,
    /// Factor from scene radiance to world radiance.
    pub unit: f64,
    /// Luminance of the brightest emitter that eye paths may hit via mirrors or glass, in world
    /// units.
    pub glint: f64,
}

impl Readout {
    /// Radiance image, in world units.
    pub fn picture(&self, film: &[FilmPixel]) -> Picture {
        // values beyond f32 are clamped, and counted as rejections
        let held = |x: f64| (x * self.unit).clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
        let rgb = film.iter().map(|p| mean(p).map(held)).collect();
        Picture { width: self.width, height: film.len() as u32 / self.width.max(1), rgb }
    }

    /// Error estimate of a film after `passes` passes of a single render, in world units.
    pub fn errors(&self, film: &[FilmPixel], passes: u32) -> ErrorMap {
        let pixels = film.iter().map(|p| {
            let n = counted(p, passes);
            self.error(p, n, early_parts(n))
        });
        let glint = self.glint / f64::from(passes.max(1));
        ErrorMap { width: self.width, pixels: pixels.collect(), glint }
    }

    /// Error estimate of a film whose `mean_at_pow2` and `mean_at_half_pow2` average the first
    /// `parts` passes of each pixel.
    pub fn errors_by_parts(&self, film: &[FilmPixel], passes: u32, parts: &[[u32; 2]]) -> ErrorMap {
        let pixels =
            film.iter().zip(parts).map(|(p, parts)| self.error(p, counted(p, passes), *parts));
        let glint = self.glint / f64::from(passes.max(1));
        ErrorMap { width: self.width, pixels: pixels.collect(), glint }
    }

    fn error(&self, p: &FilmPixel, n: u32, parts: [u32; 2]) -> PixelError {
        let unit = self.unit;
        if n < LEAST_PASSES {
            return PixelError::UNKNOWN;
        }
        let luminance = unit * luminance_of(mean(p));
        let [early, earlier] = [p.mean_at_pow2, p.mean_at_half_pow2].map(|x| unit * f64::from(x));
        let variance = unit * unit * f64::from(p.spread.max(0.0)) / f64::from(n - 1);
        PixelError {
            luminance,
            variance,
            deviations: [
                partition(luminance, early, parts[0], n),
                partition(luminance, earlier, parts[1], n),
            ],
            halves: unit * f64::from(p.halves),
            bias_probe: unit * f64::from(p.bias_probe),
            bias_probe_alternating: unit * f64::from(p.bias_probe_alternating),
        }
    }

    /// Rejection counts.
    pub fn rejections(&self, film: &[FilmPixel]) -> Rejections {
        let count = |cause: u32| film.iter().map(|p| u64::from(p.rejected[cause as usize])).sum();
        let too_bright =
            |p: &&FilmPixel| mean(p).iter().any(|x| x * self.unit > f64::from(f32::MAX));
        Rejections {
            eye_path: count(REJECTED_EYE),
            direct_light: count(REJECTED_DIRECT),
            photons: count(REJECTED_PHOTONS),
            estimate: count(REJECTED_ESTIMATE),
            too_bright: film.iter().filter(too_bright).count() as u64,
        }
    }
}

/// Number of accepted passes of a pixel, out of `passes`.
pub fn counted(pixel: &FilmPixel, passes: u32) -> u32 {
    pixel.rejected.iter().fold(passes, |left, rejected| left.saturating_sub(*rejected))
}

/// Numbers of passes in `mean_at_pow2` and `mean_at_half_pow2` after `n` passes of a single render.
pub fn early_parts(n: u32) -> [u32; 2] {
    let part = early_passes(n);
    [part, part / 2]
}

/// Mean of a pixel over the passes, in scene units.
pub fn mean(pixel: &FilmPixel) -> [f64; 3] {
    [0, 1, 2].map(|c| pixel.mean[c] as f64 + pixel.carry[c] as f64)
}
