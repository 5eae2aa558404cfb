//! Choice of the crop that a report shows.

use crate::film::{Development, Picture, Region};

/// Maximum side of the crop in pixels.
const SIDE: u32 = 96;
/// Edge in pixels of the blocks whose means are compared, so that noise does not count as contrast.
const BLOCK: u32 = 4;
/// Upper limit of the contrast of two blocks, in display values summed over three channels, so that
/// the edges of lamps do not dominate.
const ENOUGH: f64 = 0.3;

/// Chooses the square with the most contrast in display values, that is the largest sum of
/// differences of neighboring blocks.
pub fn choose(picture: &Picture, development: &Development) -> Region {
    let side = SIDE.min(picture.width).min(picture.height);
    let (columns, rows) = (picture.width / BLOCK, picture.height / BLOCK);
    let blocks = side / BLOCK;
    let shown: Vec<f64> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .map(|(column, row)| mean_shown(picture, development, column, row))
        .collect();
    let at = |x: u32, y: u32| shown[(y * columns + x) as usize];
    let contrast = |x: u32, y: u32| {
        let right = if x + 1 < columns { (at(x + 1, y) - at(x, y)).abs().min(ENOUGH) } else { 0.0 };
        let below = if y + 1 < rows { (at(x, y + 1) - at(x, y)).abs().min(ENOUGH) } else { 0.0 };
        right + below
    };
    let inside = |x0: u32, y0: u32| -> f64 {
        (y0..y0 + blocks)
            .flat_map(|y| (x0..x0 + blocks).map(move |x| (x, y)))
            .map(|(x, y)| contrast(x, y))
            .sum()
    };
    let mut best = (f64::NEG_INFINITY, 0, 0);
    for y in 0..=rows - blocks {
        for x in 0..=columns - blocks {
            let sum = inside(x, y);
            if sum > best.0 {
                best = (sum, x * BLOCK, y * BLOCK);
            }
        }
    }
    let (_, x0, y0) = best;
    Region { x0, y0, x1: x0 + side, y1: y0 + side }
}

/// Mean over a block of the sum of the display values of three channels.
fn mean_shown(picture: &Picture, development: &Development, column: u32, row: u32) -> f64 {
    let block = Region {
        x0: column * BLOCK,
        y0: row * BLOCK,
        x1: (column + 1) * BLOCK,
        y1: (row + 1) * BLOCK,
    };
    let pixels = block.crop(picture).rgb;
    pixels.iter().map(|rgb| development.display(*rgb).iter().sum::<f64>()).sum::<f64>()
        / pixels.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The crop covers a patch of large squares in a noisy image, and fits into small images.
    #[test]
    fn contrast_attracts() {
        let patch = |x: u32, y: u32| (200..260).contains(&x) && (40..100).contains(&y);
        let picture = Picture::from_fn(320, 200, |x, y| {
            match (patch(x, y), (x / 8 + y / 8) % 2, (x + y) % 2) {
                (true, 0, _) => [0.9; 3],
                (true, ..) => [0.2; 3],
                (false, _, 0) => [0.15; 3],
                (false, ..) => [0.9; 3],
            }
        });
        let region = choose(&picture, &Development::default());
        assert!(
            region.x0 <= 200 && region.x1 >= 260 && region.y0 <= 40 && region.y1 >= 100,
            "{region}"
        );
        assert!(region.fits(320, 200));
        for (width, height) in [(7, 5), (3, 2), (96, 96), (97, 400)] {
            let small = Picture::from_fn(width, height, |x, _| [x as f32; 3]);
            assert!(choose(&small, &Development::default()).fits(width, height));
        }
    }
}
