//! A few capitals and digits, five by seven dots each: what a number plate needs.

use glam::DVec2;

/// The rows of a character from the top, five bits each, the left dot in the highest.
fn glyph(c: char) -> [u8; 7] {
    match c {
        'S' => [0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e],
        'P' => [0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10],
        'M' => [0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11],
        '0' => [0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e],
        '9' => [0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c],
        _ => [0; 7],
    }
}

/// 1 where `p` in [0, 1]^2 (y upward) lies on the strokes of `text` stretched over that square,
/// else 0.
pub fn ink(text: &str, p: DVec2) -> f64 {
    let column = p.x * (text.chars().count() as f64 * 6.0 - 1.0);
    let row = (1.0 - p.y) * 7.0;
    if column < 0.0 || !(0.0..7.0).contains(&row) {
        return 0.0;
    }
    let (at, dot) = (column as usize / 6, column as usize % 6);
    let bits = text.chars().nth(at).map_or(0, |c| glyph(c)[row as usize]);
    if dot < 5 && bits >> (4 - dot) & 1 == 1 { 1.0 } else { 0.0 }
}
