//! Rectangles of pixels.

use std::fmt;

use super::Picture;

/// Columns `x0` to `x1` and rows `y0` to `y1` of a picture, row 0 on top; the last of each are left
/// out.
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
    /// All pixels of a picture.
    pub fn whole(picture: &Picture) -> Self {
        Self { x0: 0, y0: 0, x1: picture.width, y1: picture.height }
    }

    /// Whether it holds no pixel.
    pub fn is_empty(&self) -> bool {
        self.x0 >= self.x1 || self.y0 >= self.y1
    }

    /// Whether it has pixels, and all of them lie in a picture of this size.
    pub fn fits(&self, width: u32, height: u32) -> bool {
        !self.is_empty() && self.x1 <= width && self.y1 <= height
    }

    /// Its pixels that are at least `margin` pixels away from the border of a picture of this size.
    pub fn inside(&self, margin: u32, width: u32, height: u32) -> Self {
        Self {
            x0: self.x0.max(margin),
            y0: self.y0.max(margin),
            x1: self.x1.min(width.saturating_sub(margin)),
            y1: self.y1.min(height.saturating_sub(margin)),
        }
    }

    /// Its part of a picture that it fits into.
    pub fn crop(&self, picture: &Picture) -> Picture {
        let at = |x, y| picture.rgb[(y * picture.width + x) as usize];
        Picture::from_fn(self.x1 - self.x0, self.y1 - self.y0, |x, y| at(self.x0 + x, self.y0 + y))
    }
}

/// In words, with the last column and row that are in it.
impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { x0, y0, x1, y1 } = *self;
        write!(f, "columns {x0} to {}, rows {y0} to {}", x1.saturating_sub(1), y1.saturating_sub(1))
    }
}
