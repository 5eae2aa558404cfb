//! The car's atlas: every texel of the body knows its place in space, so that doors, windows and
//! trim are drawn where they are, in metres, and no seam shows.

use crate::assets::canvas::{Canvas, Color, hex, rounded_polygon, rounded_rectangle};
use crate::assets::car::{BODY_V, HEADLIGHT, PLATE, TAILLIGHT, WHEEL};
use crate::assets::car_shape::{Unwrapping, body_normal};
use crate::assets::lettering;
use crate::assets::numbers::{lerp, sin_cos, smoothstep};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

const PAINT: u32 = 0xb3_3a2a;
const CREAM: u32 = 0xef_e3c8;
const CHROME: u32 = 0xc4_c8cc;
const RUBBER: u32 = 0x1c_1b1d;
const SEAM: u32 = 0x4a_150f;

/// The whole atlas.
pub fn atlas(unwrapping: &Unwrapping) -> Canvas {
    Canvas::paint(1024, 1024, |p| {
        if p.y >= BODY_V.0 {
            let v = (p.y - BODY_V.0) / (BODY_V.1 - BODY_V.0);
            let at = unwrapping.point(p.x, v);
            return body(at, body_normal(at));
        }
        let inside = |r: [f64; 4]| {
            let q = (p - DVec2::new(r[0], r[1])) / DVec2::new(r[2] - r[0], r[3] - r[1]);
            // a margin, so that no black bleeds in from the neighbours
            let near = q.clamp(DVec2::splat(-0.04), DVec2::splat(1.04)) == q;
            near.then(|| q.clamp(DVec2::ZERO, DVec2::ONE))
        };
        None.or(inside(WHEEL).map(wheel))
            .or(inside(HEADLIGHT).map(headlight))
            .or(inside(TAILLIGHT).map(taillight))
            .or(inside(PLATE).map(plate))
            .unwrap_or(hex(0x0a_0a0b))
    })
}

/// Lays `top` over `color` where the distance `d` (metres) is negative, with a soft edge of 3 mm.
fn over(color: Color, top: Color, d: f64) -> Color {
    color.lerp(top, 1.0 - smoothstep(-0.0015, 0.0015, d))
}

/// The colour of the body at `p` with normal `n`; p.z is not negative.
fn body(p: DVec3, n: DVec3) -> Color {
    let side = DVec2::new(p.x, p.y);
    let front = DVec2::new(p.z, p.y);
    let mut color = hex(PAINT);
    // two tones: the roof in cream, parted by the rain gutter
    let gutter = p.y - 1.252;
    color = over(color, hex(CREAM), -gutter);
    color = over(color, hex(CHROME) * 0.8, gutter.abs() - 0.008);

    let corners =
        |list: &[(f64, f64)]| list.iter().map(|&(x, y)| DVec2::new(x, y)).collect::<Vec<_>>();
    if n.z > 0.35 {
        let door =
            corners(&[(0.50, 0.32), (0.50, 0.95), (0.26, 1.22), (-0.29, 1.25), (-0.29, 0.32)]);
        let d = rounded_polygon(side, &door, 0.03);
        color = over(color, hex(SEAM), d.abs() - 0.005);
        let fore = corners(&[(0.34, 0.93), (0.15, 1.15), (-0.20, 1.17), (-0.20, 0.93)]);
        let aft =
            corners(&[(-0.38, 0.93), (-0.38, 1.18), (-0.72, 1.15), (-1.0, 0.97), (-0.98, 0.93)]);
        for outline in [fore, aft] {
            color = window(color, side, rounded_polygon(side, &outline, 0.035));
        }
        // fuel cap and rocker panel
        let cap = side.distance(DVec2::new(-0.92, 0.815)) - 0.055;
        color = over(color, hex(SEAM), cap.abs() - 0.004);
        color = over(color, hex(0x2a_2624), p.y - 0.245);
    }
    if p.x > 0.1 && n.x > 0.35 && p.y > 0.86 {
        let pane = corners(&[(-0.47, 0.955), (0.47, 0.955), (0.40, 1.215), (-0.40, 1.215)]);
        color = window(color, front, rounded_polygon(front, &pane, 0.035));
    }
    if p.x < -0.8 && n.x < -0.3 && p.y > 0.9 {
        let pane = corners(&[(-0.34, 1.01), (0.34, 1.01), (0.28, 1.20), (-0.28, 1.20)]);
        color = window(color, front, rounded_polygon(front, &pane, 0.04));
    }
    if n.y < -0.6 && p.y < 0.4 { hex(0x2a_2624) } else { lids(front, p, n, color) }
}

/// Bonnet, boot lid, and the grille between the lamps.
fn lids(front: DVec2, p: DVec3, n: DVec3, mut color: Color) -> Color {
    let bonnet = if p.x > 0.72 { p.z - lerp(0.44, 0.30, smoothstep(0.7, 1.8, p.x)) } else { 1.0 };
    if n.y > 0.15 && p.y > 0.60 {
        color = over(color, hex(SEAM), bonnet.abs() - 0.005);
        if bonnet < 0.0 {
            color = over(color, hex(SEAM), (p.x - 0.80).abs() - 0.005);
        }
    }
    if p.x < -1.0 && n.x < -0.1 {
        let lid = rounded_rectangle(front, DVec2::new(0.0, 0.70), DVec2::new(0.40, 0.22), 0.12);
        color = over(color, hex(SEAM), lid.abs() - 0.005);
        let latch = rounded_rectangle(front, DVec2::new(0.0, 0.55), DVec2::new(0.05, 0.013), 0.012);
        color = over(color, hex(CHROME), latch);
    }
    if p.x > 1.4 && n.x > 0.3 {
        let mouth = rounded_rectangle(front, DVec2::new(0.0, 0.56), DVec2::new(0.30, 0.085), 0.08);
        color = over(color, hex(CHROME), mouth - 0.016);
        let bar = (front.x / 0.032 + 0.5).rem_euclid(1.0) - 0.5;
        let slats = hex(0x14_1416).lerp(hex(CHROME), smoothstep(0.26, 0.14, bar.abs()));
        color = over(color, slats, mouth);
        let badge = front.distance(DVec2::new(0.0, 0.755)) - 0.035;
        color = over(color, hex(CHROME), badge);
        color = over(color, hex(CREAM), badge + 0.008);
    }
    color
}

/// A pane: rubber seal and chrome bead round it, glass that shows the sky above and the dark
/// within.
fn window(color: Color, q: DVec2, d: f64) -> Color {
    let glass = hex(0x1d_2a33).lerp(hex(0x8f_a9b8), smoothstep(0.98, 1.26, q.y));
    let streak = ((q.x * 0.8 + q.y) / 0.30).rem_euclid(1.0);
    let streak = smoothstep(0.30, 0.34, streak) * (1.0 - smoothstep(0.52, 0.56, streak));
    let glass = glass.lerp(hex(0xb9_cbd4), 0.22 * streak);
    let color = over(color, hex(CHROME), d - 0.026);
    let color = over(color, hex(RUBBER), d - 0.014);
    over(color, glass, d)
}

/// A wheel: u round it, v from the tread's inner edge (0) to the hub (1).
fn wheel(q: DVec2) -> Color {
    let row = q.y * 13.0;
    if row < 9.0 {
        let groove = ((q.x * 48.0 + 0.5 * row) % 1.0 - 0.5).abs();
        let tread = hex(0x20_1f20)
            .lerp(hex(0x0d_0d0d), if row < 6.0 { smoothstep(0.36, 0.44, groove) } else { 0.0 });
        return tread.lerp(hex(0xe9_e3d6), smoothstep(6.55, 6.7, row) - smoothstep(8.3, 8.45, row));
    }
    if row < 10.0 {
        return hex(CHROME);
    }
    // the painted rim, with slots
    let slot = ((q.x * 12.0) % 1.0 - 0.5).abs() < 0.22 && (10.2..10.6).contains(&row);
    if slot { hex(0x1a_1010) } else { hex(CREAM) }
}

/// A lamp's glass: u round it, v from the rim to the middle; fluted, brighter where the reflector
/// shows.
fn headlight(q: DVec2) -> Color {
    let r = 1.0 - q.y;
    let x = r * sin_cos(TAU * q.x).1;
    let flute = (x * 7.0).rem_euclid(1.0);
    hex(0xf4_f2e6)
        .lerp(hex(0xb8_bcb8), 0.75 * smoothstep(0.35, 0.5, (flute - 0.5).abs()) + 0.2 * r * r)
}

fn taillight(q: DVec2) -> Color {
    let ring = ((1.0 - q.y) * 6.0_f64).rem_euclid(1.0);
    hex(0xc4_1a12).lerp(hex(0x6e_0a08), smoothstep(0.3, 0.5, (ring - 0.5).abs()))
}

/// The number plate: dark letters on cream.
fn plate(q: DVec2) -> Color {
    let p = q * DVec2::new(0.48, 0.11);
    let d = rounded_rectangle(p, DVec2::new(0.24, 0.055), DVec2::new(0.232, 0.047), 0.01);
    let ink = lettering::ink("SPPM 09", (q - DVec2::new(0.08, 0.2)) / DVec2::new(0.84, 0.6));
    let color = over(hex(0x1c_1b1d), hex(0xf0_ead2), d);
    color.lerp(hex(0x18_1820), if d < -0.008 { ink } else { 0.0 })
}
