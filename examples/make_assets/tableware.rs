//! A plastic spoon and an ice cube, in centimetres.

use crate::assets::mesh::Mesh;
use crate::assets::numbers::{lerp, sin_cos, smoothstep};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Length of the spoon.
const LENGTH: f64 = 14.6;

/// A spoon that lies on y = 0, its tip at the origin and its handle along +x.
pub fn spoon() -> Mesh {
    const ROWS: usize = 72;
    const COLS: usize = 25;
    let point = |row: f64, col: f64| {
        let x = LENGTH * (1.0 - sin_cos(PI * row / (ROWS - 1) as f64).1) / 2.0;
        spoon_section(x, -TAU * col / (COLS - 1) as f64)
    };
    let mut mesh = Mesh::default();
    mesh.grid(ROWS, COLS, |row, col| {
        let uv = DVec2::new(row as f64 / (ROWS - 1) as f64, col as f64 / (COLS - 1) as f64);
        let (r, c) = (row as f64, (col % (COLS - 1)) as f64);
        let normal = if row == 0 {
            -DVec3::X
        } else if row == ROWS - 1 {
            DVec3::X
        } else {
            (point(r, c + 0.1) - point(r, c - 0.1)).cross(point(r + 0.1, c) - point(r - 0.1, c))
        };
        (point(r, c), normal, uv)
    });
    mesh
}

/// The point of the spoon's section at `x` in the direction `angle`: 0 at the side of +z, a quarter
/// of a turn on top.
fn spoon_section(x: f64, angle: f64) -> DVec3 {
    let (up, side) = sin_cos(angle);
    let arch = |middle: f64, half: f64| {
        let d = (x - middle) / half;
        (1.0 - d * d).max(0.0)
    };
    let bowl = 1.62 * arch(2.5, 2.5).sqrt() * (1.0 - 0.04 * (x - 2.5));
    let end = if x > 13.9 { arch(13.9, LENGTH - 13.9).sqrt() } else { 1.0 };
    let handle = lerp(0.36, 0.58, smoothstep(5.0, 13.2, x)) * smoothstep(3.9, 5.0, x) * end;
    // a fourth root of fourth powers joins both without a corner
    let half_width = (bowl.powi(4) + handle.powi(4)).sqrt().sqrt();
    let rim = 0.95 + 0.75 * smoothstep(3.2, 7.5, x) - 1.25 * smoothstep(6.5, LENGTH, x);
    let thickness = lerp(0.09, 0.14, smoothstep(4.0, 6.0, x));
    let depth = 0.85 * arch(2.4, 2.45) * (1.0 - side * side);
    DVec3::new(x, rim - depth + thickness * up, half_width * side)
}

/// A cube of about two by two by two about the origin, with round edges and uneven sides.
pub fn ice() -> Mesh {
    const SIDE: usize = 15;
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let at = |row: f64, col: f64| {
                let place = |k: f64| {
                    let (s, c) = sin_cos(PI / 4.0 * (2.0 * k / (SIDE - 1) as f64 - 1.0));
                    s / c
                };
                let mut direction = DVec3::ZERO;
                direction[axis] = sign;
                direction[(axis + 1) % 3] = place(col) * sign;
                direction[(axis + 2) % 3] = place(row);
                ice_point(direction.normalize())
            };
            mesh.grid(SIDE, SIDE, |row, col| {
                let (row, col) = (row as f64, col as f64);
                let normal = (at(row, col + 0.01) - at(row, col - 0.01))
                    .cross(at(row + 0.01, col) - at(row - 0.01, col));
                (at(row, col), normal, DVec2::new(row, col) / (SIDE - 1) as f64)
            });
        }
    }
    mesh
}

/// The point of the ice in a unit direction: a superellipsoid whose radius wavers by a tenth.
fn ice_point(d: DVec3) -> DVec3 {
    let squares = d * d;
    let fourths = squares * squares;
    let radius = 1.0 / (fourths * fourths).element_sum().sqrt().sqrt().sqrt();
    let sine = |x: f64| sin_cos(x).0;
    let waver =
        sine(2.1 * d.x + 1.3) * sine(1.7 * d.y + 0.4) + sine(2.3 * d.z + 2.2) * sine(1.9 * d.x);
    d * radius * (1.0 + 0.05 * waver)
}
