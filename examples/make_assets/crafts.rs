//! The still life's textures: floor boards and a painted vase.

use crate::assets::canvas::{Canvas, Color, hex};
use crate::assets::numbers::{bump, fbm, hash, lerp, noise, sin_cos, smoothstep};
use glam::DVec2;
use std::f64::consts::TAU;

/// Boards side by side in the picture of the floor.
const BOARDS: f64 = 4.0;

/// Oak boards: four side by side, each two pieces long, with joints at different heights, so that a
/// floor laid of this picture does not show its repeat at a glance. Grain runs along y; repeats in
/// both directions.
pub fn planks() -> Canvas {
    Canvas::paint(512, 1024, |p| {
        let board = (p.x * BOARDS).floor();
        let x = p.x * BOARDS - board;
        // each board is cut into two pieces at different heights
        let shift = 0.11 + 0.5 * hash(board as i64, 0, 5);
        let y = (p.y + shift).fract();
        let second = y > 0.46;
        let piece = board as i64 * 2 + i64::from(second);
        let (from, to) = if second { (0.46, 1.0) } else { (0.0, 0.46) };
        let color = oak(x, y, piece);
        // joints: dark lines between the pieces, bevels catching light
        let side = x.min(1.0 - x) * 0.2;
        let end = (y - from).min(to - y) * 3.2;
        let edge = side.min(end);
        color
            * lerp(0.22, 1.0, smoothstep(0.0008, 0.0035, edge))
            * lerp(0.88, 1.0, smoothstep(0.002, 0.012, edge))
    })
}

/// Oak at (x, y) of a board, x across it and y along; `piece` says which tree it came from.
fn oak(x: f64, y: f64, piece: i64) -> Color {
    let seed = (piece as u32 + 1) * 97;
    let tone = hash(piece, 1, 11);
    let long = (1 << 20, 1 << 20);
    // the pith lies beside or under the board: rings are arcs that wander slowly along it
    let wander =
        0.5 * fbm(y * 3.0, 0.5, long, seed) + 0.25 * fbm(y * 7.0, x * 1.5 + 9.0, long, seed + 7);
    let pith = lerp(-0.5, 1.5, hash(piece, 2, 12));
    let mut across = (x - pith) * 1.2 + wander;
    // a knot pushes the rings aside
    let knot =
        DVec2::new(lerp(0.25, 0.75, hash(piece, 3, 13)), lerp(0.08, 0.92, hash(piece, 4, 14)));
    let has_knot = hash(piece, 5, 15) < 0.45;
    let from_knot = ((x - knot.x) * (x - knot.x) + (y - knot.y) * (y - knot.y) * 90.0).sqrt();
    if has_knot {
        across += 0.16
            * bump(from_knot, 0.16)
            * if x > knot.x { 1.0 } else { -1.0 }
            * smoothstep(0.0, 0.1, (x - knot.x).abs());
    }
    let ring = (across * 7.0).rem_euclid(1.0);
    let late = smoothstep(0.15, 0.85, ring) * (1.0 - smoothstep(0.90, 1.0, ring));
    // fibres and pores are long and thin
    let fibre = fbm(x * 60.0, y * 14.0, long, seed + 3);
    let pore =
        smoothstep(0.66, 0.80, noise(x * 110.0, y * 44.0, long, seed + 5)) * (0.35 + 0.65 * late);
    let base = hex(0xc7_9a62).lerp(hex(0x9c_6a3a), tone);
    let mut color = base.lerp(hex(0x86_5428), 0.42 * late) * lerp(0.86, 1.10, fibre);
    color *= 1.0 - 0.28 * pore;
    if has_knot {
        let heart =
            1.0 - smoothstep(0.02, 0.11, from_knot + 0.02 * noise(x * 30.0, y * 200.0, long, seed));
        color = color.lerp(hex(0x3c_2112), 0.8 * heart);
    }
    color
}

/// Cobalt on white glaze. The vase's profile has five segments, so v = 0.2, 0.4, ... are its
/// joints: foot, belly, shoulder, neck and the inside, which stays white.
pub fn porcelain() -> Canvas {
    const BLUE: u32 = 0x1f_3f94;
    Canvas::paint(1024, 512, |p| {
        let glaze = hex(0xf2_f0e8) * lerp(0.97, 1.0, fbm(p.x * 8.0, p.y * 8.0, (8, 8), 41));
        if p.y > 0.8 {
            return glaze;
        }
        let mut ink: f64 = 0.0;
        let mut put = |amount: f64| ink = ink.max(amount);
        // bands, as (v, half width)
        for (at, half) in [
            (0.212, 0.004),
            (0.232, 0.002),
            (0.455, 0.003),
            (0.470, 0.0015),
            (0.560, 0.003),
            (0.655, 0.003),
            (0.785, 0.008),
        ] {
            put(1.0 - smoothstep(half, half + 0.002, (p.y - at).abs()));
        }
        put(petals(p, 0.236, 0.056, 24.0));
        put(flowers(p));
        put(scrolls(p, 0.512, 0.030, 14.0));
        put(0.85 * petals(DVec2::new(p.x, 1.31 - p.y), 0.655, 0.085, 16.0));
        put(leaves(p, 0.715));
        let wash = lerp(0.72, 1.0, fbm(p.x * 64.0, p.y * 32.0, (64, 32), 43));
        glaze.lerp(hex(BLUE), ink * wash)
    })
}

/// A row of `count` pointed petals that stand on v = `foot` and are `high` tall: outlines and a
/// heart.
fn petals(p: DVec2, foot: f64, high: f64, count: f64) -> f64 {
    let y = (p.y - foot) / high;
    if !(0.0..=1.0).contains(&y) {
        return 0.0;
    }
    let x = ((p.x * count).rem_euclid(1.0) - 0.5).abs() * 2.0;
    let edge = (1.0 - y * y).max(0.0).sqrt() * 0.94;
    let outline = 1.0 - smoothstep(0.05, 0.12, (x - edge).abs());
    let heart = 0.55 * (1.0 - smoothstep(0.42, 0.50, x / edge.max(0.05) + 0.3 * y));
    outline.max(heart)
}

/// Six large flowers round the belly, with leaves on winding stems between.
fn flowers(p: DVec2) -> f64 {
    const COUNT: f64 = 6.0;
    let cell = (p.x * COUNT).floor();
    // about equal lengths along both axes where the belly is widest
    let q = DVec2::new(((p.x * COUNT) - cell - 0.5) * 0.72, (p.y - 0.372) * 5.2);
    if q.y.abs() > 0.42 {
        return 0.0;
    }
    let (r, angle) = (q.length(), angle_of(q));
    let petal = |n: f64, turn: f64| ((angle * n + turn).rem_euclid(1.0) - 0.5).abs() * 2.0;
    let outer = 0.26 - 0.07 * petal(8.0, 0.0) * petal(8.0, 0.0);
    let inner = 0.16 - 0.05 * petal(8.0, 0.5);
    let line = |d: f64, half: f64| 1.0 - smoothstep(half, half + 0.008, d.abs());
    let mut ink = line(r - outer, 0.010).max(line(r - inner, 0.008));
    if r < outer {
        let shade = smoothstep(inner, outer, r) * smoothstep(0.75, 0.15, petal(8.0, 0.0));
        ink = ink.max(if r > inner { 0.55 * shade } else { 0.75 * smoothstep(inner, 0.05, r) });
        ink *= smoothstep(0.035, 0.05, r).max(smoothstep(0.025, 0.012, r));
        return ink;
    }
    // the stem is a wave that passes under the flowers; leaves sit along it
    let (s, _) = sin_cos(TAU * (p.x * COUNT + 0.25));
    ink = ink.max(line(q.y - 0.20 * s, 0.011));
    for (x, y, lean) in [
        (-0.26, -0.27, 0.9),
        (0.26, -0.27, -0.9),
        (-0.27, 0.27, -0.9),
        (0.27, 0.27, 0.9),
        (0.0, 0.35, 0.0),
        (0.0, -0.35, 0.0),
    ] {
        let d = q - DVec2::new(x, y);
        let along = DVec2::new(1.0, lean).normalize();
        let (a, b) = (d.dot(along) / 0.10, d.dot(along.perp()) / 0.036);
        let leaf = b.abs() - (1.0 - a * a);
        if a.abs() < 1.0 {
            ink = ink.max(
                (1.0 - smoothstep(-0.1, 0.1, leaf))
                    * (1.0 - 0.75 * (1.0 - smoothstep(0.06, 0.14, b.abs()))),
            );
        }
    }
    ink
}

/// A running wave with dots, about v = `at`.
fn scrolls(p: DVec2, at: f64, high: f64, count: f64) -> f64 {
    let x = (p.x * count).rem_euclid(1.0);
    let (s, _) = sin_cos(TAU * x);
    let y = (p.y - at) / high;
    let wave = 1.0 - smoothstep(0.12, 0.22, (y - 0.7 * s).abs());
    let dot = |cx: f64, cy: f64| {
        let d = DVec2::new((x - cx) * 3.4, y - cy).length();
        (1.0 - smoothstep(0.20, 0.28, d)).max(1.0 - smoothstep(0.04, 0.10, (d - 0.42).abs()))
    };
    wave.max(dot(0.25, -0.35)).max(dot(0.75, 0.35))
}

/// A wreath of leaves about v = `at`.
fn leaves(p: DVec2, at: f64) -> f64 {
    let x = (p.x * 28.0).rem_euclid(1.0);
    let y = (p.y - at) * 40.0;
    let stem = 1.0 - smoothstep(0.05, 0.12, y.abs());
    let leaf = |side: f64| {
        let a = (x - 0.5) * 2.0;
        let b = y * side - 0.45 - 0.35 * a;
        1.0 - smoothstep(-0.08, 0.08, b.abs() - 0.42 * (1.0 - a * a))
    };
    stem.max(leaf(1.0)).max(leaf(-1.0))
}

/// The direction of `q` as a fraction of a turn, monotonic but not exactly even: enough for petals.
fn angle_of(q: DVec2) -> f64 {
    let r = q.x.abs() + q.y.abs();
    if r == 0.0 {
        return 0.0;
    }
    // a diamond angle, bent towards the true one
    let t = q.y.abs() / r;
    let quarter = t + 0.0615 * (2.0 * t - 1.0) * t * (1.0 - t) * -4.0;
    let half = if q.x >= 0.0 { quarter } else { 2.0 - quarter };
    (if q.y >= 0.0 { half } else { 4.0 - half }) / 4.0
}
