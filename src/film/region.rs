//! Rectangles of pixels.

use std::fmt;

use super::Picture;

/// Columns `x0..x1` and rows `y0..y1` of an image, row 0 on top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Region {
    /// Region of all pixels of an image.
    pub fn whole(picture: &Picture) -> Self {
        Self { x0: 0, y0: 0, x1: picture.width, y1: picture.height }
    }

    /// Returns true if the region contains no pixels.
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// Returns true if the region is not empty and lies in an image of this size.
    pub fn fits(&self, width: u32, height: u32) -> bool {
        !self.is_empty() && self.x1 <= width && self.y1 <= height
    }

    /// Pixels of the region at least `margin` pixels away from the border of an image of this size.
    pub fn inside(&self, margin: u32, width: u32, height: u32) -> Self {
        Self {
            x0: self.x0.max(margin),
            y0: self.y0.max(margin),
            x1: self.x1.min(width.saturating_sub(margin)),
            y1: self.y1.min(height.saturating_sub(margin)),
        }
    }

    /// Crops an image to the region, which must lie in it.
    pub fn crop(&self, picture: &Picture) -> Picture {
        let at = |x, y| picture.rgb[(y * picture.width + x) as usize];
        Picture::from_fn(self.x1 - self.x0, self.y1 - self.y0, |x, y| at(self.x0 + x, self.y0 + y))
    }
}

/// Formats the region in words, with inclusive bounds.
impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { x0, y0, x1, y1 } = *self;
        write!(f, "columns {x0} to {}, rows {y0} to {}", x1.saturating_sub(1), y1.saturating_sub(1))
    }
}
