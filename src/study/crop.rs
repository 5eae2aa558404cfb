//! The part of a picture that a report shows.

use crate::film::{Development, Picture, Region};

/// Sides of the part, at most, in pixels.
const SIDE: u32 = 96;

/// The square with the most contrast on the screen: the largest sum of differences of neighbouring pixels.
pub fn choose(picture: &Picture, development: &Development) -> Region {
    let side = SIDE.min(picture.width).min(picture.height);
    let grey = |rgb: [f32; 3]| development.display(rgb).iter().sum::<f64>();
    let shown: Vec<f64> = picture.rgb.iter().map(|rgb| grey(*rgb)).collect();
    let (width, height) = (picture.width as usize, picture.height as usize);
    let contrast = |x: usize, y: usize| {
        let here = shown[y * width + x];
        let right = if x + 1 < width { (shown[y * width + x + 1] - here).abs() } else { 0.0 };
        let below = if y + 1 < height { (shown[(y + 1) * width + x] - here).abs() } else { 0.0 };
        right + below
    };
    // Sums over all pixels above and to the left.
    let mut sums = vec![0.0; (width + 1) * (height + 1)];
    for y in 0..height {
        for x in 0..width {
            let around =
                sums[y * (width + 1) + x + 1] + sums[(y + 1) * (width + 1) + x] - sums[y * (width + 1) + x];
            sums[(y + 1) * (width + 1) + x + 1] = around + contrast(x, y);
        }
    }
    let inside = |x: usize, y: usize| {
        let (right, below) = (x + side as usize, y + side as usize);
        let at = |x: usize, y: usize| sums[y * (width + 1) + x];
        at(right, below) - at(x, below) - at(right, y) + at(x, y)
    };
    let mut best = (f64::NEG_INFINITY, 0, 0);
    for y in (0..=height - side as usize).step_by(4) {
        for x in (0..=width - side as usize).step_by(4) {
            if inside(x, y) > best.0 {
                best = (inside(x, y), x as u32, y as u32);
            }
        }
    }
    let (_, x0, y0) = best;
    Region { x0, y0, x1: x0 + side, y1: y0 + side }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A checkered patch in a grey picture is what is chosen, and a small picture is taken whole.
    #[test]
    fn contrast_attracts() {
        let patch = |x: u32, y: u32| (200..260).contains(&x) && (40..100).contains(&y);
        let picture = Picture::from_fn(320, 200, |x, y| match patch(x, y) && (x + y) % 2 == 0 {
            true => [0.9; 3],
            false => [0.2; 3],
        });
        let region = choose(&picture, &Development::default());
        assert!(region.x0 <= 200 && region.x1 >= 260 && region.y0 <= 40 && region.y1 >= 100, "{region}");
        assert!(region.fits(320, 200));
        let small = Picture::from_fn(7, 5, |x, _| [x as f32; 3]);
        assert!(choose(&small, &Development::default()).fits(7, 5));
    }
}
