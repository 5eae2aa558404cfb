//! What a film says: the picture, its errors and what was left out, in world units.

use super::super::kernels::records::*;
use crate::film::estimate::{LEAST_PASSES, PixelError, early_passes, partition};
use crate::film::{ErrorMap, Picture, Rejections, luminance_of};

/// Reads films of one size and unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Readout {
    /// Pixels per row.
    pub width: u32,
    /// Scene radiance times this is world radiance.
    pub unit: f64,
    /// Luminance of the brightest thing that eye paths may meet by mirrors or through glass, world
    /// units.
    pub glint: f64,
}

impl Readout {
    /// The picture, in world units.
    pub fn picture(&self, film: &[FilmPixel]) -> Picture {
        // numbers beyond f32 become its largest, and are counted as rejections
        let held = |x: f64| (x * self.unit).clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
        let rgb = film.iter().map(|p| mean(p).map(held)).collect();
        Picture { width: self.width, height: film.len() as u32 / self.width.max(1), rgb }
    }

    /// What a film after `passes` passes of one render says of its error, in world units.
    pub fn errors(&self, film: &[FilmPixel], passes: u32) -> ErrorMap {
        let pixels = film.iter().map(|p| {
            let n = counted(p, passes);
            self.error(p, n, early_parts(n))
        });
        let glint = self.glint / f64::from(passes.max(1));
        ErrorMap { width: self.width, pixels: pixels.collect(), glint }
    }

    /// The same where `mean_at_pow2` and `mean_at_half_pow2` are the means over the first `parts` passes.
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

    /// What was left out of the picture.
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

/// Passes of `passes` that count in a pixel.
pub fn counted(pixel: &FilmPixel, passes: u32) -> u32 {
    pixel.rejected.iter().fold(passes, |left, rejected| left.saturating_sub(*rejected))
}

/// Passes in `mean_at_pow2` and `mean_at_half_pow2` after `n` passes of one render.
pub fn early_parts(n: u32) -> [u32; 2] {
    let part = early_passes(n);
    [part, part / 2]
}

/// A pixel's mean over the passes, scene units.
pub fn mean(pixel: &FilmPixel) -> [f64; 3] {
    [0, 1, 2].map(|c| pixel.mean[c] as f64 + pixel.carry[c] as f64)
}
