//! A summer sky over a line of trees, as an equirectangular picture in linear radiance.

use crate::assets::numbers::{fbm, lerp, sin_cos, smoothstep};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Width in pixels; the height is half of it.
pub const WIDTH: u32 = 640;

/// The radiance of every pixel, row 0 at the zenith; column 0 looks along -x, the middle along +x.
pub fn sky() -> Vec<[f32; 3]> {
    let height = WIDTH / 2;
    let mut pixels = Vec::with_capacity((WIDTH * height) as usize);
    for row in 0..height {
        for col in 0..WIDTH {
            let (up, level) = sin_cos(PI * (0.5 - (f64::from(row) + 0.5) / f64::from(height)));
            let (s, c) = sin_cos(TAU * (0.5 - (f64::from(col) + 0.5) / f64::from(WIDTH)));
            let direction = DVec3::new(level * c, up, level * s);
            let around = (f64::from(col) + 0.5) / f64::from(WIDTH);
            pixels.push(radiance(direction, around).as_vec3().to_array());
        }
    }
    pixels
}

/// Radiance from a unit `direction`; `around` is its heading as a fraction of a turn.
fn radiance(direction: DVec3, around: f64) -> DVec3 {
    let up = direction.y;
    let clear = DVec3::new(0.62, 0.78, 0.96)
        .lerp(DVec3::new(0.11, 0.25, 0.60), smoothstep(0.0, 0.75, up.max(0.0).sqrt()));
    // clouds float on a layer above; near the horizon they thin out into haze
    let layer = direction / (up.max(0.0) + 0.18);
    let far = (1 << 20, 1 << 20);
    let billow = fbm(layer.x * 1.3 + 40.0, layer.z * 1.3 + 17.0, far, 201);
    let puff = fbm(layer.x * 5.0 + 4.0, layer.z * 5.0 + 9.0, far, 211);
    let cover = smoothstep(0.50, 0.72, billow * 0.8 + puff * 0.26) * smoothstep(0.02, 0.16, up);
    let cloud = DVec3::new(1.05, 1.02, 0.98) * lerp(0.72, 1.15, smoothstep(0.35, 0.75, puff));
    let sky = clear.lerp(cloud, 0.92 * cover);
    // trees, then fields
    let crowns = 0.045 * fbm(around * 24.0, 0.5, (24, 8), 221)
        + 0.022 * fbm(around * 150.0, 0.5, (150, 8), 223);
    let leaf = fbm(around * 220.0, up * 40.0, (220, 1 << 20), 227);
    let trees =
        DVec3::new(0.045, 0.075, 0.040).lerp(DVec3::new(0.11, 0.15, 0.07), leaf).lerp(clear, 0.08);
    let field = DVec3::new(0.08, 0.12, 0.035);
    field.lerp(
        trees.lerp(sky, smoothstep(-0.003, 0.003, up - crowns)),
        smoothstep(-0.012, -0.004, up),
    )
}
