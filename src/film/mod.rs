//! Images: files, tone mapping and error metrics.

pub mod any_file;
pub mod blocks;
pub mod colors;
pub mod denoise;
pub mod difference;
pub mod error;
pub mod estimate;
pub mod exr_file;
pub mod file;
pub mod flip;
pub mod heat;
pub mod metrics;
pub mod pfm;
pub mod plane;
pub mod provenance;
pub mod region;
pub mod rejections;
pub mod ssim;
pub mod tev;
pub mod tonemap;

pub use any_file::{Coding, read_any};
pub use difference::{Difference, Measures};
pub use error::FileError;
pub use estimate::{ErrorMap, RelativeError};
pub use file::{check_outputs, read, write};
pub use plane::Plane;
pub use provenance::Provenance;
pub use region::Region;
pub use rejections::Rejections;
pub use tonemap::Development;

/// An image of linear Rec. 709 radiance, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels, row by row, in W sr^-1 m^-2.
    pub rgb: Vec<[f32; 3]>,
}

impl Picture {
    /// Creates an image whose pixel in column `x` and row `y` is `radiance(x, y)`.
    pub fn from_fn(
        width: u32,
        height: u32,
        mut radiance: impl FnMut(u32, u32) -> [f32; 3],
    ) -> Self {
        let mut rgb = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                rgb.push(radiance(x, y));
            }
        }
        Self { width, height, rgb }
    }

    /// Column and row of the pixel at `index`.
    pub fn position(&self, index: usize) -> (u32, u32) {
        let width = self.width as usize;
        ((index % width) as u32, (index / width) as u32)
    }

    /// Number of channel values that are NaN or infinite. A correct renderer produces none.
    pub fn not_finite(&self) -> usize {
        self.rgb.as_flattened().iter().filter(|value| !value.is_finite()).count()
    }
}

/// Rec. 709 luminance of linear Rec. 709 values, in the unit of the values.
pub fn luminance(rgb: [f32; 3]) -> f64 {
    luminance_of(rgb.map(f64::from))
}

/// [`luminance`] of `f64` values.
pub fn luminance_of([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
