//! An sRGB canvas, row 0 on top, saved as PNG.

use glam::{DVec2, DVec3};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// An sRGB colour with components in [0, 1].
pub type Color = DVec3;

/// A colour from its hexadecimal sRGB notation, as in a style sheet.
pub fn hex(rgb: u32) -> Color {
    let part = |shift: u32| f64::from((rgb >> shift) & 255) / 255.0;
    DVec3::new(part(16), part(8), part(0))
}

/// `size` pixels, row 0 on top.
pub struct Canvas {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    pixels: Vec<Color>,
}

impl Canvas {
    /// A picture whose pixel at (x, y) in [0, 1]^2, y = 0 at the bottom, is `color(x, y)`.
    pub fn paint(width: u32, height: u32, mut color: impl FnMut(DVec2) -> Color) -> Canvas {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let mut pixels = Vec::with_capacity((width * height) as usize);
        for row in 0..height {
            for col in 0..width {
                let p = DVec2::new(f64::from(col) + 0.5, size.y - f64::from(row) - 0.5) / size;
                pixels.push(color(p));
            }
        }
        Canvas { width, height, pixels }
    }

    /// The 8-bit RGB bytes, row by row.
    pub fn to_rgb8(&self) -> Vec<u8> {
        let byte = |x: f64| (x.clamp(0.0, 1.0) * 255.0 + 0.5).floor() as u8;
        self.pixels.iter().flat_map(|c| c.to_array().map(byte)).collect()
    }

    /// The picture as the bytes of a PNG file.
    pub fn to_png(&self) -> Result<Vec<u8>, image::ImageError> {
        let mut bytes = Vec::new();
        PngEncoder::new_with_quality(&mut bytes, CompressionType::Best, FilterType::Adaptive)
            .write_image(&self.to_rgb8(), self.width, self.height, ExtendedColorType::Rgb8)?;
        Ok(bytes)
    }
}

/// How far `p` is inside (negative) or outside a rectangle with rounded corners, in the units of
/// `p`.
pub fn rounded_rectangle(p: DVec2, center: DVec2, half: DVec2, corner: f64) -> f64 {
    let q = (p - center).abs() - half + DVec2::splat(corner);
    q.max(DVec2::ZERO).length() + q.x.max(q.y).min(0.0) - corner
}

/// How far `p` is inside (negative) or outside a polygon with corners rounded by `corner`.
pub fn rounded_polygon(p: DVec2, corners: &[DVec2], corner: f64) -> f64 {
    let (mut distance, mut inside) = (f64::MAX, false);
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let (e, w) = (b - a, p - a);
        let nearest = w - e * (w.dot(e) / e.length_squared()).clamp(0.0, 1.0);
        distance = distance.min(nearest.length());
        if (a.y > p.y) != (b.y > p.y) && w.x < e.x * w.y / e.y {
            inside = !inside;
        }
    }
    (if inside { -distance } else { distance }) - corner
}
