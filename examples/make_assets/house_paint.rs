//! The house's textures. Those that tile repeat without a seam.

use crate::assets::canvas::{Canvas, Color, hex, rounded_rectangle};
use crate::assets::numbers::{fbm, hash, lerp, noise, smoothstep};
use glam::DVec2;

/// Bricks in running bond: one picture is 4 by 16 bricks, 1.0 by 1.2 metres with their joints.
pub fn brick() -> Canvas {
    Canvas::paint(512, 512, |p| {
        let (columns, courses) = (4.0, 16.0);
        let row = (p.y * courses).floor();
        let x = p.x * columns + 0.5 * row.rem_euclid(2.0);
        let column = x.floor();
        let d =
            brick_edge(DVec2::new(x - column, p.y * courses - row), DVec2::new(0.25, 0.075), 0.005);
        let column = (column as i64).rem_euclid(columns as i64);
        let grain = fbm(p.x * 64.0, p.y * 64.0, (64, 64), 3);
        let stain = fbm(p.x * 4.0, p.y * 4.0, (4, 4), 21);
        let tone = hash(column, row as i64, 4);
        let clay = hex(0x9c_4a36)
            .lerp(hex(0xb8_6a48), tone)
            .lerp(hex(0x70_342c), 0.8 * hash(column, row as i64, 9).powi(3));
        let face = clay * lerp(0.78, 1.14, grain) * lerp(0.94, 1.06, stain);
        let mortar = hex(0xb5_aa9a) * lerp(0.8, 1.0, grain);
        mortar.lerp(
            face * lerp(0.75, 1.0, smoothstep(0.0, -0.006, d)),
            smoothstep(0.0015, -0.0015, d + 0.002 * (grain - 0.5)),
        )
    })
}

/// The distance (metres, negative inside) to a brick of `size` with joints of twice `joint`; q in
/// [0, 1]^2.
fn brick_edge(q: DVec2, size: DVec2, joint: f64) -> f64 {
    rounded_rectangle(q * size, size * 0.5, size * 0.5 - DVec2::splat(joint), 0.006)
}

/// Plain clay tiles in courses: one picture is 6 by 8 tiles; v runs up the slope.
pub fn roof() -> Canvas {
    Canvas::paint(512, 512, |p| {
        let (columns, courses) = (6.0, 8.0);
        let row = (p.y * courses).floor();
        let y = p.y * courses - row;
        let x = p.x * columns + 0.5 * row.rem_euclid(2.0);
        let column = x.floor();
        let x = x - column;
        let column = (column as i64).rem_euclid(columns as i64);
        let tone = hash(column, row as i64, 31);
        let grain = fbm(p.x * 24.0, p.y * 24.0, (24, 24), 33);
        let moss = smoothstep(0.62, 0.85, fbm(p.x * 3.0, p.y * 3.0, (3, 3), 35));
        let clay = hex(0x8d_4a38)
            .lerp(hex(0xad_6546), tone)
            .lerp(hex(0x5e_3a34), 0.7 * hash(column, row as i64, 37).powi(2));
        let clay = clay.lerp(hex(0x6d_6a44), 0.35 * moss) * lerp(0.8, 1.12, grain);
        // each tile is rounded across, its lower end stands proud and throws a shadow on the next
        // below
        let round = 1.0 - 1.1 * (x - 0.5) * (x - 0.5);
        let tail = 0.10 * (1.0 - 4.0 * (x - 0.5) * (x - 0.5)) * 0.6;
        let lip = smoothstep(0.0, 0.06, y + tail - 0.04);
        let shadow = lerp(0.45, 1.0, smoothstep(1.02, 0.80, y + tail * 0.3));
        let joint = smoothstep(0.010, 0.035, x.min(1.0 - x));
        clay * round * lerp(0.30, 1.0, lip) * shadow * lerp(0.40, 1.0, joint)
    })
}

/// Rough ashlar for plinth, steps and chimney cap: 3 by 3 stones.
pub fn stone() -> Canvas {
    Canvas::paint(256, 256, |p| {
        let row = (p.y * 3.0).floor();
        let x = p.x * 3.0 + [0.0, 0.4, 0.75][(row as usize).min(2)];
        let column = x.floor();
        let d = brick_edge(DVec2::new(x - column, p.y * 3.0 - row), DVec2::new(0.40, 0.30), 0.007);
        let column = (column as i64).rem_euclid(3);
        let grain = fbm(p.x * 16.0, p.y * 16.0, (16, 16), 51);
        let face = hex(0x9a_948a).lerp(hex(0xb7_ad9c), hash(column, row as i64, 53))
            * lerp(0.80, 1.10, grain);
        (hex(0x74_6c62) * lerp(0.8, 1.0, grain)).lerp(face, smoothstep(0.003, -0.003, d))
    })
}

/// A front door of four panels with a glazed fanlight, letter box and brass knob; fills its
/// picture.
pub fn door() -> Canvas {
    Canvas::paint(256, 512, |p| {
        let q = p * DVec2::new(1.0, 2.1);
        let grain = fbm(q.x * 40.0, q.y * 2.0, (1 << 16, 1 << 16), 61);
        let green = hex(0x1f_4a3f) * lerp(0.90, 1.08, grain);
        let mut color = green;
        for (center, half) in [
            ((0.27, 0.40), (0.155, 0.26)),
            ((0.73, 0.40), (0.155, 0.26)),
            ((0.27, 1.16), (0.155, 0.36)),
            ((0.73, 1.16), (0.155, 0.36)),
        ] {
            let (center, half) = (DVec2::from(center), DVec2::from(half));
            let d = rounded_rectangle(q, center, half, 0.01);
            // a moulding: its upper and left sides in shade, the others in light
            let toward = (q - center) / half;
            let lit = if toward.x.abs() > toward.y.abs() { toward.x } else { -toward.y };
            let moulding = smoothstep(0.022, 0.012, d.abs());
            color = color.lerp(green * if lit > 0.0 { 1.45 } else { 0.55 }, moulding);
        }
        let light = rounded_rectangle(q, DVec2::new(0.5, 1.82), DVec2::new(0.385, 0.17), 0.02);
        let bars =
            ((q.x - 0.5).abs() - 0.012).min((q.x - 0.24).abs().min((q.x - 0.76).abs()) - 0.009);
        let glass = hex(0x33_4450).lerp(hex(0x9d_b4c0), smoothstep(1.65, 2.0, q.y + 0.25 * q.x));
        color = color.lerp(hex(0xe9_e6dc), smoothstep(0.024, 0.018, light));
        color = color.lerp(
            if bars < 0.0 { hex(0xe9_e6dc) } else { glass },
            smoothstep(0.002, -0.002, light),
        );
        let brass = hex(0xc9_a24c);
        let knob = q.distance(DVec2::new(0.92, 0.92)) - 0.028;
        let plate = rounded_rectangle(q, DVec2::new(0.5, 0.755), DVec2::new(0.11, 0.03), 0.01);
        color = color.lerp(green * 0.4, smoothstep(0.012, 0.0, knob));
        color = color.lerp(brass, smoothstep(0.003, -0.003, knob.min(plate)));
        color.lerp(
            hex(0x6b_5220),
            smoothstep(0.004, 0.0, (q.y - 0.755).abs() - 0.008) * smoothstep(0.0, -0.02, plate),
        )
    })
}

/// A sash window behind its frame: glass bars, the sky in the panes, curtains and the dark room
/// behind.
pub fn window() -> Canvas {
    Canvas::paint(256, 384, |p| {
        let q = p * DVec2::new(1.0, 1.5);
        let fold = 0.5 + 0.5 * noise(q.x * 26.0, q.y * 1.2, (1 << 16, 1 << 16), 71);
        let room = hex(0x20_2428).lerp(hex(0x35_3a3c), smoothstep(0.4, 0.0, (q.x - 0.5).abs()));
        // curtains hang from the top and are drawn aside lower down
        let drape = 0.34 - 0.16 * smoothstep(1.35, 0.45, q.y) + 0.05 * smoothstep(0.45, 0.1, q.y);
        let side = q.x.min(1.0 - q.x);
        let curtain = smoothstep(drape, drape - 0.015, side);
        let valance = smoothstep(
            1.30,
            1.315,
            q.y + 0.03 * (q.x * 8.0).fract().min(1.0 - (q.x * 8.0).fract()),
        );
        let cloth = hex(0xd8_d2c2) * lerp(0.66, 1.0, fold);
        let inside = room.lerp(cloth * 0.85, curtain.max(valance));
        // the sky, stronger above, with the edge of a cloud
        let cloud =
            smoothstep(0.45, 0.62, fbm(q.x * 2.0 + 3.0, q.y * 2.0 - q.x, (1 << 16, 1 << 16), 73));
        let sky = hex(0x8f_b0cc).lerp(hex(0xe4_eaee), cloud);
        let glass = inside.lerp(sky, lerp(0.16, 0.52, smoothstep(0.1, 1.5, q.y + 0.35 * q.x)));
        let bar = |x: f64, half: f64| x.abs() - half;
        let bars = bar(q.x - 0.5, 0.014)
            .min(bar(q.y - 0.75, 0.026))
            .min(bar(q.y - 1.13, 0.012))
            .min(bar(q.y - 0.38, 0.012));
        let sash = rounded_rectangle(q, DVec2::new(0.5, 0.75), DVec2::new(0.46, 0.71), 0.0);
        let wood = (-sash).min(bars);
        let shade = lerp(0.62, 1.0, smoothstep(0.0, 0.02, wood));
        (glass * shade).lerp(hex(0xef_ece4), smoothstep(0.002, -0.002, wood))
    })
}

/// A louvred shutter in grey green; fills its picture.
pub fn shutter() -> Canvas {
    Canvas::paint(128, 384, |p| {
        let q = p * DVec2::new(0.5, 1.5);
        let paint =
            hex(0x4d_6f62) * lerp(0.94, 1.05, fbm(q.x * 60.0, q.y * 3.0, (1 << 16, 1 << 16), 81));
        let field = |y: f64| rounded_rectangle(q, DVec2::new(0.25, y), DVec2::new(0.19, 0.32), 0.0);
        let d = field(0.38).min(field(1.12));
        let slat = (q.y * 22.0).fract();
        let louvre = paint
            * lerp(0.40, 1.15, smoothstep(0.0, 0.9, slat))
            * smoothstep(1.0, 0.93, slat).max(0.35);
        let rim = smoothstep(0.010, 0.004, d.abs());
        (if d < 0.0 { louvre } else { paint }) * lerp(1.0, 0.55, rim)
    })
}

/// Lime plaster for the gables, with the brushwork left in it; 2 metres square.
pub fn plaster() -> Canvas {
    Canvas::paint(256, 256, |p| {
        let stroke = fbm(p.x * 10.0, p.y * 22.0, (10, 22), 91);
        let cloud = fbm(p.x * 3.0, p.y * 3.0, (3, 3), 95);
        hex(0xe6_dcc6) * lerp(0.90, 1.04, stroke) * lerp(0.94, 1.03, cloud)
    })
}

/// Mown grass, 2 metres square.
pub fn grass() -> Canvas {
    Canvas::paint(512, 512, |p| {
        let patch = fbm(p.x * 4.0, p.y * 4.0, (4, 4), 101);
        // blades: short strokes that lean two ways
        let lean =
            |s: f64, seed: u32| noise(p.x * 128.0 + s * p.y * 32.0, p.y * 32.0, (128, 32), seed);
        let blades = lean(1.0, 103).max(lean(-1.0, 105));
        let green: Color = hex(0x3f_5c26).lerp(hex(0x6c_8438), patch);
        green * lerp(0.50, 1.25, blades)
    })
}
