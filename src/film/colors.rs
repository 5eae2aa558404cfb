//! Color maps.

/// Every 17th of the 256 entries of the color map magma (Smith & van der Walt 2015, public domain).
/// Interpolated colors are within 3 / 255 of the full table.
const MAGMA: [[u8; 3]; 16] = [
    [0, 0, 4],
    [11, 9, 36],
    [32, 17, 75],
    [59, 15, 112],
    [87, 21, 126],
    [114, 31, 129],
    [140, 41, 129],
    [168, 50, 125],
    [196, 60, 117],
    [222, 73, 104],
    [241, 96, 93],
    [250, 127, 94],
    [254, 159, 109],
    [254, 191, 132],
    [253, 222, 160],
    [252, 253, 191],
];

/// Maps `x`, clamped to [0, 1], to the color map magma: black, violet, orange, light yellow.
pub fn magma(x: f64) -> [u8; 3] {
    gradient(&MAGMA, x)
}

/// Interpolates linearly between evenly spaced color stops at `x`, clamped to [0, 1]. At least two
/// stops are required.
pub fn gradient(stops: &[[u8; 3]], x: f64) -> [u8; 3] {
    let at = x.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let left = (at as usize).min(stops.len() - 2);
    let share = at - left as f64;
    let between =
        |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    [0, 1, 2].map(|i| between(stops[left][i], stops[left + 1][i]))
}
