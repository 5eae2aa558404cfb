//! A brick cottage as one mesh, in metres: its front looks along +z, x is to the right of someone
//! who faces the front, the ground is y = 0 and the origin is under its middle.

use crate::assets::mesh::Mesh;
use crate::assets::numbers::{lerp, sin_cos};
use crate::assets::parts::{append_with_materials, beam, half_pipe, metres};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// Half the length along x, half the depth along z, and the height of the eaves.
const HALF: DVec3 = DVec3::new(3.7, 3.0, 2.5);
/// Rise of the roof over run.
const PITCH: f64 = 0.95;
/// Height of the plinth, and of the floor within.
const PLINTH: f64 = 0.45;
/// How far the roof stands out over the walls along the eaves, and over the gables.
const EAVES: f64 = 0.38;
const VERGE: f64 = 0.28;
/// How deep windows and doors are set into the wall.
const REVEAL: f64 = 0.14;
/// What one picture of brickwork covers, in metres.
const BRICKWORK: DVec2 = DVec2::new(1.0, 1.2);

/// An opening in a wall, in the wall's (s, t) metres, and the texture that fills it.
struct Opening {
    low: DVec2,
    high: DVec2,
    filling: &'static str,
}

fn opening(center: f64, sill: f64, width: f64, height: f64, filling: &'static str) -> Opening {
    let low = DVec2::new(center - 0.5 * width, sill);
    Opening { low, high: low + DVec2::new(width, height), filling }
}

/// A vertical wall: `origin` its lower left corner seen from outside, `along` to the right; y is
/// up.
struct Wall {
    origin: DVec3,
    along: DVec3,
    size: DVec2,
}

impl Wall {
    fn out(&self) -> DVec3 {
        self.along.cross(DVec3::Y)
    }

    fn at(&self, s: f64, t: f64, out: f64) -> DVec3 {
        self.origin + self.along * s + DVec3::Y * t + self.out() * out
    }
}

/// The whole house.
pub fn house() -> Mesh {
    let mut mesh = Mesh::default();
    walls(&mut mesh);
    roof(&mut mesh, HALF.x + VERGE, HALF.z + EAVES, ridge(), 0.14, DVec3::ZERO, true);
    mesh.set_material("trim");
    bargeboards(&mut mesh);
    chimney(&mut mesh, DVec3::new(2.2, 0.0, -0.55));
    for x in [-1.9, 1.9] {
        dormer(&mut mesh, x);
    }
    porch(&mut mesh);
    mesh
}

/// Height of the ridge, over the middle of the house.
fn ridge() -> f64 {
    HALF.y + HALF.z * PITCH + 0.12
}

fn walls(mesh: &mut Mesh) {
    let (x, y, z) = (HALF.x, HALF.y, HALF.z);
    let front =
        Wall { origin: DVec3::new(-x, 0.0, z), along: DVec3::X, size: DVec2::new(2.0 * x, y) };
    let back =
        Wall { origin: DVec3::new(x, 0.0, -z), along: -DVec3::X, size: DVec2::new(2.0 * x, y) };
    let right =
        Wall { origin: DVec3::new(x, 0.0, z), along: -DVec3::Z, size: DVec2::new(2.0 * z, y) };
    let left =
        Wall { origin: DVec3::new(-x, 0.0, -z), along: DVec3::Z, size: DVec2::new(2.0 * z, y) };
    let window = |center: f64| opening(center, 1.15, 1.0, 1.5, "window");
    wall(mesh, &front, &[window(1.35), window(6.05), opening(3.7, PLINTH, 1.0, 2.1, "door")]);
    wall(mesh, &back, &[window(1.6), window(5.8)]);
    wall(mesh, &right, &[window(1.5), window(3.5)]);
    wall(mesh, &left, &[window(1.5), window(3.5)]);
    mesh.set_material("stone");
    let skirt = DVec3::new(x + 0.06, PLINTH, z + 0.06);
    mesh.cuboid(DVec3::new(-skirt.x, 0.0, -skirt.z), skirt, |p, n| metres(p, n) / 1.2);
    // gables, plastered, with an attic window each
    for wall in [&right, &left] {
        mesh.set_material("plaster");
        let high = ridge() - 0.16 - y;
        let corner = |s: f64, t: f64| (wall.at(s, t, 0.0), DVec2::new(s, t) / 2.0);
        mesh.polygon(&[corner(0.0, y), corner(2.0 * z, y), corner(z, y + high)]);
        mesh.set_material("trim");
        beam(mesh, wall.at(0.0, y, 0.0), wall.at(2.0 * z, y, 0.0), DVec3::Y, 0.09, 0.05);
        pane(mesh, wall, &opening(z, y + 0.55, 0.75, 1.1, "window"), 0.02);
    }
}

/// Brickwork cut along the edges of its openings, their reveals, and what fills them.
fn wall(mesh: &mut Mesh, wall: &Wall, openings: &[Opening]) {
    mesh.set_material("brick");
    let cuts = |edge: fn(DVec2) -> f64, end: f64| {
        let mut cuts = vec![0.0, end];
        cuts.extend(openings.iter().flat_map(|o| [edge(o.low), edge(o.high)]));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    };
    let (columns, rows) = (cuts(|p| p.x, wall.size.x), cuts(|p| p.y, wall.size.y));
    for s in columns.windows(2) {
        for t in rows.windows(2) {
            let middle = DVec2::new(s[0] + s[1], t[0] + t[1]) * 0.5;
            if openings.iter().any(|o| middle.cmpgt(o.low).all() && middle.cmplt(o.high).all()) {
                continue;
            }
            let corner = |s: f64, t: f64| (wall.at(s, t, 0.0), DVec2::new(s, t) / BRICKWORK);
            mesh.polygon(&[
                corner(s[0], t[0]),
                corner(s[1], t[0]),
                corner(s[1], t[1]),
                corner(s[0], t[1]),
            ]);
        }
    }
    for hole in openings {
        mesh.set_material("brick");
        let around =
            [hole.low, hole.high.with_y(hole.low.y), hole.high, hole.low.with_y(hole.high.y)];
        for (k, &a) in around.iter().enumerate() {
            let b = around[(k + 1) % 4];
            let corner = |p: DVec2, out: f64| {
                (wall.at(p.x, p.y, out), DVec2::new(p.x + out, p.y) / BRICKWORK)
            };
            mesh.polygon(&[corner(a, 0.0), corner(b, 0.0), corner(b, -REVEAL), corner(a, -REVEAL)]);
        }
        pane(mesh, wall, hole, -REVEAL);
    }
}

/// A window or a door with its frame, standing `depth` in front of the wall's plane; and what goes
/// with it.
fn pane(mesh: &mut Mesh, wall: &Wall, hole: &Opening, depth: f64) {
    let Opening { low, high, filling } = *hole;
    mesh.set_material(filling);
    let corner = |s: f64, t: f64| {
        (wall.at(lerp(low.x, high.x, s), lerp(low.y, high.y, t), depth), DVec2::new(s, t))
    };
    mesh.polygon(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]);
    mesh.set_material("trim");
    let at = |s: f64, t: f64| wall.at(s, t, depth);
    let up = DVec3::Y;
    for s in [low.x + 0.03, high.x - 0.03] {
        beam(mesh, at(s, low.y), at(s, high.y), wall.along, 0.03, 0.05);
    }
    beam(mesh, at(low.x, high.y - 0.03), at(high.x, high.y - 0.03), up, 0.03, 0.05);
    if filling == "window" {
        mesh.set_material("stone");
        let sill = wall.at(0.0, low.y - 0.05, 0.0);
        beam(
            mesh,
            sill + wall.along * (low.x - 0.08),
            sill + wall.along * (high.x + 0.08),
            up,
            0.05,
            0.09,
        );
    }
    if depth < 0.0 {
        mesh.set_material("stone");
        let lintel = wall.at(0.0, high.y + 0.11, 0.0);
        beam(
            mesh,
            lintel + wall.along * (low.x - 0.14),
            lintel + wall.along * (high.x + 0.14),
            up,
            0.11,
            0.025,
        );
        if filling == "window" {
            shutters(mesh, wall, low, high);
        }
    }
}

fn shutters(mesh: &mut Mesh, wall: &Wall, low: DVec2, high: DVec2) {
    for s in [low.x - 0.52, high.x + 0.04] {
        mesh.set_material("shutter");
        let corner = |a: f64, t: f64| {
            (wall.at(s + 0.48 * a, lerp(low.y, high.y, t), 0.06), DVec2::new(a, t))
        };
        mesh.polygon(&[corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)]);
        // the edges, in a plain part of the picture
        let around = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        for (k, &(a, t)) in around.iter().enumerate() {
            let (b, u) = around[(k + 1) % 4];
            let back = |a: f64, t: f64| wall.at(s + 0.48 * a, lerp(low.y, high.y, t), 0.0);
            let plain = DVec2::new(0.05, 0.5);
            mesh.polygon(&[
                (corner(b, u).0, plain),
                (corner(a, t).0, plain),
                (back(a, t), plain),
                (back(b, u), plain),
            ]);
        }
    }
}

/// A gable roof: two tiled slabs that meet at the ridge. `half_x` and `half_z` reach to their
/// edges.
fn roof(mesh: &mut Mesh, half_x: f64, half_z: f64, top: f64, thick: f64, at: DVec3, tiles: bool) {
    let drop = half_z * PITCH;
    let slope = (half_z * half_z + drop * drop).sqrt();
    for side in [1.0, -1.0] {
        let along = DVec3::X * side;
        let down = DVec3::new(0.0, -drop, half_z * side);
        let out = DVec3::new(0.0, half_z, drop * side) / slope * thick;
        let (l, r) = (at + DVec3::Y * top - along * half_x, at + DVec3::Y * top + along * half_x);
        let tile = |s: f64, t: f64| DVec2::new(s * 2.0 * half_x / 1.5, (1.0 - t) * slope / 1.6);
        mesh.set_material(if tiles { "roof" } else { "trim" });
        // top, underside, eaves, two verges; the ridge closes the other long side
        mesh.polygon(&[
            (l + down, tile(0.0, 1.0)),
            (r + down, tile(1.0, 1.0)),
            (r, tile(1.0, 0.0)),
            (l, tile(0.0, 0.0)),
        ]);
        mesh.set_material("trim");
        let flat = |corners: [DVec3; 4]| corners.map(|p| (p, DVec2::ZERO));
        mesh.polygon(&flat([l - out, r - out, r + down - out, l + down - out]));
        mesh.polygon(&flat([l + down - out, r + down - out, r + down, l + down]));
        mesh.polygon(&flat([r + down - out, r - out, r, r + down]));
        mesh.polygon(&flat([l - out, l + down - out, l + down, l]));
    }
    if tiles {
        mesh.set_material("ridge");
        half_pipe(
            mesh,
            at + DVec3::new(-half_x, top - 0.03, 0.0),
            at + DVec3::new(half_x, top - 0.03, 0.0),
            0.10,
        );
    }
}

/// Boards under the verges of the gables, and gutters along the eaves with their downpipes.
fn bargeboards(mesh: &mut Mesh) {
    let foot = HALF.z + EAVES;
    let low = ridge() - foot * PITCH;
    for z in [1.0, -1.0] {
        let gutter = DVec3::new(0.0, low - 0.04, z * (foot + 0.05));
        beam(
            mesh,
            gutter - DVec3::X * (HALF.x + VERGE),
            gutter + DVec3::X * (HALF.x + VERGE),
            DVec3::Y,
            0.05,
            0.06,
        );
        for x in [1.0, -1.0] {
            let wall = DVec3::new(x * (HALF.x - 0.12), 0.0, z * (HALF.z + 0.07));
            beam(mesh, wall + DVec3::Y * 0.05, wall + DVec3::Y * (low + 0.2), DVec3::X, 0.04, 0.04);
            let bend = DVec3::new(wall.x, low - 0.06, z * (foot + 0.03));
            beam(mesh, wall + DVec3::Y * (low - 0.2), bend, DVec3::X, 0.04, 0.04);
        }
    }
}

fn chimney(mesh: &mut Mesh, at: DVec3) {
    let (half, top) = (0.36, ridge() + 0.95);
    let base = HALF.y + 0.8;
    mesh.set_material("brick");
    let stack = DVec3::new(half, 0.0, half);
    mesh.cuboid(at - stack + DVec3::Y * base, at + stack + DVec3::Y * top, |p, n| {
        metres(p, n) / BRICKWORK
    });
    let course = stack + DVec3::new(0.06, 0.0, 0.06);
    mesh.cuboid(
        at - course + DVec3::Y * (top - 0.30),
        at + course + DVec3::Y * (top - 0.15),
        |p, n| metres(p, n) / BRICKWORK,
    );
    mesh.set_material("stone");
    mesh.cuboid(at - course + DVec3::Y * top, at + course + DVec3::Y * (top + 0.09), |p, n| {
        metres(p, n) / 1.2
    });
    mesh.set_material("pot");
    for x in [-0.16, 0.16] {
        let profile = [
            (0.13, 0.0),
            (0.115, 0.36),
            (0.14, 0.38),
            (0.14, 0.44),
            (0.10, 0.44),
            (0.10, 0.20),
            (0.0, 0.20),
        ];
        let foot = at + DVec3::new(x, top + 0.09, 0.0);
        for pair in profile.windows(2) {
            let slope = DVec2::new(pair[1].1 - pair[0].1, pair[0].0 - pair[1].0);
            mesh.grid(2, 17, |row, col| {
                let (s, c) = sin_cos(-TAU * col as f64 / 16.0);
                let (r, y) = pair[row];
                (
                    foot + DVec3::new(r * c, y, r * s),
                    DVec3::new(slope.x * c, slope.y, slope.x * s),
                    DVec2::ZERO,
                )
            });
        }
    }
}

/// A dormer window in the front slope.
fn dormer(mesh: &mut Mesh, x: f64) {
    let (half, front, low, high) = (0.72, 1.95, 3.35, 4.75);
    mesh.set_material("plaster");
    // the box reaches back into the roof
    let (a, b) = (DVec3::new(x - half, low, 0.3), DVec3::new(x + half, high, front));
    mesh.cuboid(a, b, |p, n| metres(p, n) / 2.0);
    let face = Wall {
        origin: DVec3::new(x - half, 0.0, front),
        along: DVec3::X,
        size: DVec2::new(2.0 * half, high),
    };
    let peak = high + half * PITCH;
    let corner = |s: f64, t: f64| (face.at(s, t, 0.0), DVec2::new(s, t) / 2.0);
    mesh.polygon(&[corner(0.0, high), corner(2.0 * half, high), corner(half, peak)]);
    pane(mesh, &face, &opening(half, low + 0.28, 0.85, 1.05, "window"), 0.02);
    let mut cover = Mesh::default();
    let deep = 1.05;
    roof(&mut cover, deep, half + 0.20, peak + 0.14, 0.10, DVec3::ZERO, true);
    // turned so that its ridge runs back along z
    let turn = DMat3::from_cols(-DVec3::Z, DVec3::Y, DVec3::X);
    append_with_materials(mesh, &cover, turn, DVec3::new(x, 0.0, front + 0.22 - deep));
}

/// Steps to the door under a small roof on two posts.
fn porch(mesh: &mut Mesh) {
    let (half, front) = (0.95, HALF.z + 1.25);
    mesh.set_material("stone");
    for step in 0..3 {
        let k = f64::from(step);
        let (reach, high) = (front + 0.30 * k, PLINTH * (3.0 - k) / 3.0);
        let wide = half + 0.12 + 0.16 * k;
        mesh.cuboid(DVec3::new(-wide, 0.0, HALF.z - 0.1), DVec3::new(wide, high, reach), |p, n| {
            metres(p, n) / 1.2
        });
    }
    mesh.set_material("trim");
    let (beam_y, eaves) = (2.72, 2.82);
    for x in [-half, half] {
        beam(
            mesh,
            DVec3::new(x, PLINTH, front - 0.15),
            DVec3::new(x, beam_y, front - 0.15),
            DVec3::X,
            0.065,
            0.065,
        );
        let foot = DVec3::new(x, PLINTH, front - 0.15);
        mesh.cuboid(
            foot - DVec3::new(0.10, 0.0, 0.10),
            foot + DVec3::new(0.10, 0.16, 0.10),
            |_, _| DVec2::ZERO,
        );
        beam(
            mesh,
            DVec3::new(x, beam_y, HALF.z),
            DVec3::new(x, beam_y, front),
            DVec3::Y,
            0.07,
            0.06,
        );
    }
    beam(
        mesh,
        DVec3::new(-half, beam_y, front - 0.15),
        DVec3::new(half, beam_y, front - 0.15),
        DVec3::Y,
        0.07,
        0.06,
    );
    let peak = eaves + half * PITCH;
    mesh.set_material("plaster");
    let corner = |x: f64, y: f64| (DVec3::new(x, y, front - 0.08), DVec2::new(x, y) / 2.0);
    mesh.polygon(&[corner(-half, eaves - 0.05), corner(half, eaves - 0.05), corner(0.0, peak)]);
    let mut cover = Mesh::default();
    let deep = 0.95;
    roof(&mut cover, deep, half + 0.22, peak + 0.14, 0.10, DVec3::ZERO, true);
    let turn = DMat3::from_cols(-DVec3::Z, DVec3::Y, DVec3::X);
    append_with_materials(mesh, &cover, turn, DVec3::new(0.0, 0.0, front + 0.18 - deep));
}

/// The material library of the house: name, diffuse colour (linear) and texture.
pub fn materials() -> String {
    let list: [(&str, &str, Option<&str>); 10] = [
        ("brick", "1 1 1", Some("brick.png")),
        ("roof", "1 1 1", Some("roof.png")),
        ("stone", "1 1 1", Some("stone.png")),
        ("plaster", "1 1 1", Some("plaster.png")),
        ("door", "1 1 1", Some("door.png")),
        ("window", "1 1 1", Some("window.png")),
        ("shutter", "1 1 1", Some("shutter.png")),
        ("trim", "0.76 0.74 0.68", None),
        ("ridge", "0.30 0.11 0.07", None),
        ("pot", "0.45 0.17 0.09", None),
    ];
    let mut out = String::from("# the materials of house.obj\n");
    for (name, color, texture) in list {
        out += &format!("\nnewmtl {name}\nKd {color}\nillum 1\n");
        if let Some(texture) = texture {
            out += &format!("map_Kd {texture}\n");
        }
    }
    out
}
