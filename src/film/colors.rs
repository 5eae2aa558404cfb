//! Colors for numbers.

/// The color map magma (Smith & van der Walt 2015, in the public domain) at every seventeenth of
/// its 256 entries; what lies between is within 3 / 255 of the whole table.
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

/// Magma's color of `x`, clipped to [0, 1]: black by violet and orange to a light yellow.
pub fn magma(x: f64) -> [u8; 3] {
    gradient(&MAGMA, x)
}

/// The color at `x`, clipped to [0, 1], between evenly spaced stops, of which there are two at
/// least.
pub fn gradient(stops: &[[u8; 3]], x: f64) -> [u8; 3] {
    let at = x.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let left = (at as usize).min(stops.len() - 2);
    let share = at - left as f64;
    let between =
        |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a))).round() as u8;
    [0, 1, 2].map(|i| between(stops[left][i], stops[left + 1][i]))
}
