//! Heat map of the difference of two images, with a labeled logarithmic scale below it.

use super::colors::gradient;
use super::metrics::{MetricsError, check_comparable, difference, same_bits};
use super::{Picture, file};

/// Decades of difference that the color map spans.
const DECADES: i32 = 6;
/// Space in pixels around the parts of the scale.
const MARGIN: usize = 4;
/// Height of the color bar in pixels.
const BAR: usize = 10;
/// Columns and rows of a glyph before it is doubled.
const DIGIT: (usize, usize) = (3, 5);
/// Width of one decade in pixels: a label as wide as `1e-45` and a gap.
const DECADE_WIDTH: usize = 44;
const SCALE_HEIGHT: usize = 4 * MARGIN + BAR + 2 * DIGIT.1;
const SCALE_WIDTH: usize = 2 * MARGIN + (DECADES as usize + 1) * DECADE_WIDTH;

/// A heat map as display values.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// Pixels per row.
    pub width: u32,
    /// Rows of the compared images plus those of the scale.
    pub height: u32,
    /// 8-bit display values, row by row.
    pub rgb: Vec<[u8; 3]>,
    /// Difference at the bright end of the color map, a power of ten.
    pub top: f64,
}

/// Draws the largest absolute channel difference of each pixel on a logarithmic scale of six
/// decades that ends at the smallest power of ten not below the largest difference. Bit-identical
/// pixels are black; differences below the scale have its first color. The scale is drawn below the
/// image, with a label at each decade.
pub fn heat_map(a: &Picture, b: &Picture) -> Result<HeatMap, MetricsError> {
    check_comparable(a, b)?;
    let largest =
        a.rgb.iter().zip(&b.rgb).fold(0.0, |largest: f64, (a, b)| largest.max(difference(*a, *b)));
    let top = if largest > 0.0 { largest.log10().ceil() as i32 } else { 0 };
    let width = (a.width as usize).max(SCALE_WIDTH);
    let height = a.height as usize + SCALE_HEIGHT;
    let mut canvas = Canvas { width, rgb: vec![BACKGROUND; width * height] };
    for (index, (&a_pixel, &b_pixel)) in a.rgb.iter().zip(&b.rgb).enumerate() {
        let (x, y) = a.position(index);
        let color = if same_bits(a_pixel, b_pixel) {
            [0; 3]
        } else {
            let decade = difference(a_pixel, b_pixel).log10() - f64::from(top);
            heat(1.0 + decade / f64::from(DECADES))
        };
        canvas.set(x as usize, y as usize, color);
    }
    draw_scale(&mut canvas, a.height as usize, top);
    Ok(HeatMap {
        width: width as u32,
        height: height as u32,
        rgb: canvas.rgb,
        top: 10f64.powi(top),
    })
}

/// Writes a heat map as PNG.
pub fn write(path: &std::path::Path, map: &HeatMap) -> Result<(), super::FileError> {
    file::write_rgb8(path, map.width, map.height, map.rgb.as_flattened())
}

const BACKGROUND: [u8; 3] = [40; 3];
const INK: [u8; 3] = [230; 3];

struct Canvas {
    width: usize,
    rgb: Vec<[u8; 3]>,
}

impl Canvas {
    fn set(&mut self, x: usize, y: usize, color: [u8; 3]) {
        self.rgb[y * self.width + x] = color;
    }

    /// Draws text at double size; characters without a glyph are blank.
    fn text(&mut self, x: usize, y: usize, text: &str) {
        for (place, character) in text.chars().enumerate() {
            let left = x + place * 2 * (DIGIT.0 + 1);
            for (row, bits) in glyph(character).iter().enumerate() {
                for column in 0..DIGIT.0 {
                    if bits >> (DIGIT.0 - 1 - column) & 1 == 1 {
                        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                            self.set(left + 2 * column + dx, y + 2 * row + dy, INK);
                        }
                    }
                }
            }
        }
    }
}

fn draw_scale(canvas: &mut Canvas, top_row: usize, top: i32) {
    let bar = DECADES as usize * DECADE_WIDTH;
    for x in 0..bar {
        for y in 0..BAR {
            canvas.set(MARGIN + x, top_row + MARGIN + y, heat(x as f64 / (bar - 1) as f64));
        }
    }
    for decade in 0..=DECADES {
        let x = MARGIN + decade as usize * DECADE_WIDTH;
        for y in 0..MARGIN {
            canvas.set(x, top_row + MARGIN + BAR + y, INK);
        }
        canvas.text(x, top_row + 3 * MARGIN + BAR, &format!("1e{}", top - DECADES + decade));
    }
}

/// Color map for `x` in [0, 1] with increasing luminance: dark violet, red, yellow, white.
pub fn heat(x: f64) -> [u8; 3] {
    const STOPS: [[u8; 3]; 6] = [
        [40, 11, 84],
        [101, 21, 110],
        [188, 55, 84],
        [237, 105, 37],
        [251, 180, 26],
        [252, 255, 214],
    ];
    gradient(&STOPS, x)
}

/// Rows of a 3 x 5 glyph, three bits each, leftmost pixel in the highest bit.
fn glyph(character: char) -> [u8; 5] {
    match character {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        'e' => [0b010, 0b101, 0b111, 0b100, 0b011],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        _ => [0; 5],
    }
}
