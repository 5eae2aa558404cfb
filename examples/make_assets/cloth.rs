//! The normal map of a tablecloth in plain weave.

use crate::assets::canvas::Canvas;
use crate::assets::numbers::{lerp, noise, sin_cos};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Threads along each side of the picture; even, so that over and under repeat.
const THREADS: i64 = 20;
/// Pixels along each side.
const PIXELS: u32 = 320;

/// The normals of the cloth, as (n + 1) / 2; repeats in both directions.
pub fn normals() -> Canvas {
    let step = THREADS as f64 / f64::from(PIXELS);
    Canvas::paint(PIXELS, PIXELS, |p| {
        let p = p * THREADS as f64;
        let slope =
            |axis: DVec2| (height(p + axis * step) - height(p - axis * step)) / (2.0 * step);
        let normal = DVec3::new(-slope(DVec2::X), -slope(DVec2::Y), 1.0).normalize();
        (normal + DVec3::ONE) / 2.0
    })
}

/// Height of the cloth's surface; all lengths are in distances between threads.
fn height(p: DVec2) -> f64 {
    let (warp, weft) = (thread(p.x, p.y, 301), thread(p.y, p.x, 311));
    let (warp, weft) = (warp.0 + 0.13 * warp.1, weft.0 - 0.13 * weft.1);
    // the higher one, with a rounded valley between them
    let near = (0.06 - (warp - weft).abs()).max(0.0);
    (warp.max(weft) + near * near / 0.24).max(-0.25)
}

/// Relief of the thread at `across`, uneven in width and place along its length, and how far it
/// lies above (up to 1) or below (down to -1) the threads that it crosses.
fn thread(across: f64, along: f64, seed: u32) -> (f64, f64) {
    let number = across.floor();
    let half_width = lerp(0.42, 0.58, noise(along / 2.0, number, (THREADS / 2, THREADS), seed));
    let middle = 0.5 + 0.1 * (noise(along / 4.0, number, (THREADS / 4, THREADS), seed + 1) - 0.5);
    let side = (across - number - middle) / half_width;
    let round = 1.0 - side * side;
    // fibres twist around the thread
    let twist = (along * 4.0 + side * 3.0, number * 6.0 + (side + 1.0) * 2.5);
    let fibre = noise(twist.0, twist.1, (THREADS * 4, THREADS * 6), seed + 2) - 0.5;
    let over = if number.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
    (0.3 * round + 0.05 * fibre * round.max(0.0), over * sin_cos(PI * along).0)
}
