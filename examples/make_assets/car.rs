//! A small rounded car of the fifties: a painted body with wheels, and its chrome apart.

use crate::assets::car_shape::{
    AXIS_HEIGHT, AXLES, FLOOR, Unwrapping, WHEEL_RADIUS, body_normal, in_arch, meet,
};
use crate::assets::mesh::Mesh;
use crate::assets::numbers::{lerp, sin_cos};
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The part of the atlas's height that the body takes; the rest holds the small parts.
pub const BODY_V: (f64, f64) = (0.375, 1.0);
/// A black texel for hidden surfaces.
const BLACK: DVec2 = DVec2::new(0.985, 0.36);
/// The wheel's place in the atlas: (u0, v0, u1, v1), u round the axle, v from tread to hub.
pub const WHEEL: [f64; 4] = [0.0, 0.0, 0.5, 0.34];
/// The headlight's place: u round it, v from rim to middle.
pub const HEADLIGHT: [f64; 4] = [0.52, 0.0, 0.72, 0.16];
/// The tail light's place, likewise.
pub const TAILLIGHT: [f64; 4] = [0.74, 0.0, 0.94, 0.16];
/// The number plate's place.
pub const PLATE: [f64; 4] = [0.52, 0.18, 0.94, 0.26];

/// Where the lamps sit: (position, direction, radius, depth).
const HEADLIGHTS: (DVec3, DVec3, f64) =
    (DVec3::new(1.72, 0.665, 0.58), DVec3::new(1.0, 0.08, 0.12), 0.115);
const TAILLIGHTS: (DVec3, DVec3, f64) =
    (DVec3::new(-1.70, 0.60, 0.60), DVec3::new(-1.0, 0.12, 0.22), 0.065);

/// Everything that is painted: body, wheels, lamps and number plates. The body is closed.
pub fn painted(unwrapping: &Unwrapping) -> Mesh {
    let mut mesh = body(unwrapping);
    let wheel = lathe(&TYRE, 32, WHEEL);
    place_wheels(&mut mesh, &wheel);
    for side in [-1.0, 1.0] {
        for (lamp, region) in [(HEADLIGHTS, HEADLIGHT), (TAILLIGHTS, TAILLIGHT)] {
            let (turn, at) = lamp_frame(lamp, side);
            mesh.append(
                &lathe(
                    &[[0.0, 0.92], [0.12, 0.92], [0.22, 0.6], [0.28, 0.0]]
                        .map(|[y, r]| [y * lamp.2, r * lamp.2]),
                    20,
                    region,
                ),
                turn,
                at,
            );
        }
    }
    plate(&mut mesh, DVec3::new(2.045, 0.41, 0.0), 1.0);
    plate(&mut mesh, DVec3::new(-2.045, 0.41, 0.0), -1.0);
    mesh
}

/// Everything that shines: bumpers, hubcaps, lamp rims, door handles and a strip along each side.
pub fn chrome() -> Mesh {
    let mut mesh = Mesh::default();
    let all = [0.0, 0.0, 1.0, 1.0];
    place_wheels(&mut mesh, &lathe(&HUBCAP, 28, all));
    for side in [-1.0, 1.0] {
        for lamp in [HEADLIGHTS, TAILLIGHTS] {
            let (turn, at) = lamp_frame(lamp, side);
            let rim = [[-0.9, 1.0], [-0.1, 1.12], [0.08, 1.08], [0.16, 0.98], [0.12, 0.9]];
            mesh.append(&lathe(&rim.map(|[y, r]| [y * lamp.2, r * lamp.2]), 24, all), turn, at);
        }
        strip(&mut mesh, side);
        let handle = |u: f64| DVec3::new(lerp(-0.14, -0.27, u), 0.815, 0.0);
        if let Some(p) = meet(DVec3::new(-0.2, 0.815, 1.2), -DVec3::Z, 1.2) {
            let path: Vec<DVec3> =
                (0..=8).map(|k| handle(f64::from(k) / 8.0) + DVec3::Z * (p.z + 0.02)).collect();
            let path: Vec<DVec3> = path.iter().map(|&p| DVec3::new(p.x, p.y, p.z * side)).collect();
            tube(&mut mesh, &path, 0.013, 0.013);
        }
    }
    for end in [1.0, -1.0] {
        let path: Vec<DVec3> = (0..=24)
            .map(|k| {
                let (s, c) = sin_cos(PI * (f64::from(k) / 24.0 - 0.5));
                // a superellipse that wraps round the corners
                let bend = c.max(0.0).sqrt();
                DVec3::new(end * (1.62 + 0.40 * bend), 0.37, 0.80 * s)
            })
            .collect();
        tube(&mut mesh, &path, 0.05, 0.022);
        for z in [-0.33, 0.33] {
            let guard = [
                DVec3::new(end * 2.03, 0.27, z),
                DVec3::new(end * 2.05, 0.37, z),
                DVec3::new(end * 2.03, 0.47, z),
            ];
            tube(&mut mesh, &guard, 0.028, 0.028);
        }
    }
    mesh
}

/// The closed shell: each section runs from the middle of the underside out, up the side and to the
/// roof's middle, then down the other side. Wheel wells are where the lower edge is higher than the
/// floor.
pub fn body(unwrapping: &Unwrapping) -> Mesh {
    const SIDE: usize = 25;
    const INNER: f64 = 0.42;
    let stations = unwrapping.stations();
    let mut mesh = Mesh::default();
    let atlas = |u: f64, v: f64| {
        DVec2::new(lerp(0.004, 0.996, u), lerp(BODY_V.0 + 0.004, BODY_V.1 - 0.004, v))
    };
    // the first and the last section shrink to a point
    let tip_or = |row: usize, u: f64, v: f64| {
        let p = unwrapping.point(u, v);
        if row == 0 || row + 1 == stations.len() { DVec3::new(p.x, AXIS_HEIGHT, 0.0) } else { p }
    };
    for side in [1.0, -1.0] {
        let outward = |p: DVec3| DVec3::new(p.x, p.y, p.z * side);
        // the left half is the mirror image: its columns run the other way, so that it winds
        // outward too
        let column = |col: usize| if side > 0.0 { col } else { SIDE - col };
        mesh.grid(stations.len(), SIDE + 1, |row, col| {
            let u = stations[row];
            let low = unwrapping.lower_edge(unwrapping.x(u));
            let v = lerp(low, 1.0, column(col) as f64 / SIDE as f64);
            let p = tip_or(row, u, v);
            let p = if column(col) == SIDE || v == 0.0 { p.with_z(0.0) } else { p };
            (outward(p), outward(body_normal(p)), atlas(u, v))
        });
        // underside: from the edge in to the well's inner wall, down it, and to the middle
        let section = |row: usize| {
            let edge =
                tip_or(row, stations[row], unwrapping.lower_edge(unwrapping.x(stations[row])));
            let inner = edge.z.min(INNER);
            let floor = if in_arch(edge.x) { FLOOR.min(edge.y) } else { edge.y };
            [
                edge,
                edge.with_z(inner),
                DVec3::new(edge.x, floor, inner),
                DVec3::new(edge.x, floor, 0.0),
            ]
        };
        for (part, normal) in [-DVec3::Y, DVec3::Z, -DVec3::Y].into_iter().enumerate() {
            mesh.grid(stations.len(), 2, |row, col| {
                let k = if side > 0.0 { part + 1 - col } else { part + col };
                (outward(section(row)[k]), outward(normal), BLACK)
            });
        }
    }
    mesh
}

/// Profile of a wheel about its axle, as (outward along the axle, radius), from inside to hub.
const TYRE: [[f64; 2]; 14] = [
    [-0.085, 0.16],
    [-0.09, 0.24],
    [-0.08, 0.295],
    [-0.055, 0.313],
    [0.0, 0.315],
    [0.055, 0.313],
    [0.08, 0.295],
    [0.09, 0.26],
    [0.088, 0.225],
    [0.075, 0.208],
    [0.06, 0.20],
    [0.045, 0.16],
    [0.05, 0.08],
    [0.05, 0.0],
];
const HUBCAP: [[f64; 2]; 8] = [
    [0.04, 0.145],
    [0.06, 0.142],
    [0.068, 0.13],
    [0.062, 0.112],
    [0.078, 0.085],
    [0.094, 0.055],
    [0.102, 0.025],
    [0.104, 0.0],
];

fn place_wheels(mesh: &mut Mesh, wheel: &Mesh) {
    for x in AXLES {
        // the lathe turns about y: lay its axis along z
        let right = DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y);
        let left = DMat3::from_cols(-DVec3::X, -DVec3::Z, -DVec3::Y);
        mesh.append(wheel, right, DVec3::new(x, WHEEL_RADIUS, 0.655));
        mesh.append(wheel, left, DVec3::new(x, WHEEL_RADIUS, -0.655));
    }
}

fn lamp_frame((at, direction, radius): (DVec3, DVec3, f64), side: f64) -> (DMat3, DVec3) {
    let y = DVec3::new(direction.x, direction.y, direction.z * side).normalize();
    let x = y.cross(DVec3::Y).normalize();
    let away = DVec3::new(at.x, at.y, at.z * side) + y * 0.5;
    let on_body = meet(away, -y, 1.0).unwrap_or(away);
    (DMat3::from_cols(x, y, x.cross(y)), on_body + y * (0.3 * radius))
}

/// Turns a profile of (height, radius) about y. Smooth normals; the region is (u0, v0, u1, v1).
fn lathe(profile: &[[f64; 2]], around: usize, region: [f64; 4]) -> Mesh {
    let mut mesh = Mesh::default();
    let rows = profile.len();
    mesh.grid(rows, around + 1, |row, col| {
        let [y, r] = profile[row];
        let (before, after) = (profile[row.saturating_sub(1)], profile[(row + 1).min(rows - 1)]);
        let (dy, dr) = (after[0] - before[0], after[1] - before[1]);
        let (u, v) = (col as f64 / around as f64, row as f64 / (rows - 1) as f64);
        let (s, c) = sin_cos(-TAU * u);
        let normal = if r == 0.0 { DVec3::Y } else { DVec3::new(dy * c, -dr, dy * s) };
        let uv = DVec2::new(lerp(region[0], region[2], u), lerp(region[1], region[3], v));
        (DVec3::new(r * c, y, r * s), normal, uv)
    });
    mesh
}

/// A tube with an elliptic section (`high` along y, `deep` across) along a path, closed by points
/// at its ends.
fn tube(mesh: &mut Mesh, path: &[DVec3], high: f64, deep: f64) {
    const AROUND: usize = 10;
    let last = path.len() - 1;
    let rows = path.len() + 4;
    mesh.grid(rows, AROUND + 1, |row, col| {
        // two extra rows at each end round the tube off
        let (k, cap): (usize, f64) = match row {
            0 => (0, 1.0),
            1 => (0, 0.6),
            r if r == rows - 2 => (last, -0.6),
            r if r == rows - 1 => (last, -1.0),
            r => ((r - 2).min(last), 0.0),
        };
        let forward = (path[(k + 1).min(last)] - path[k.saturating_sub(1)]).normalize();
        let up = if forward.y.abs() > 0.5 { DVec3::Z } else { DVec3::Y };
        let across = forward.cross(up).normalize();
        let up = across.cross(forward);
        let (s, c) = sin_cos(TAU * col as f64 / AROUND as f64);
        let shrink = (1.0 - cap * cap).max(0.0).sqrt();
        let out = up * (c / high) + across * (s / deep);
        let normal = out.normalize() * shrink - forward * cap;
        let p = path[k] + (up * (high * c) + across * (deep * s)) * shrink - forward * (cap * deep);
        (p, normal, DVec2::ZERO)
    });
}

/// A chrome strip along the waist.
fn strip(mesh: &mut Mesh, side: f64) {
    let path: Vec<DVec3> = (0..=18)
        .filter_map(|k| {
            let x = lerp(1.02, -1.05, f64::from(k) / 18.0);
            let y = 0.735 + 0.02 * (x * 1.2);
            meet(DVec3::new(x, y, 1.2), -DVec3::Z, 1.2)
        })
        .map(|p| DVec3::new(p.x, p.y, (p.z + 0.003) * side))
        .collect();
    tube(mesh, &path, 0.011, 0.009);
}

fn plate(mesh: &mut Mesh, at: DVec3, end: f64) {
    let [u0, v0, u1, v1] = PLATE;
    let (half, high) = (0.24 * end, 0.055);
    let corner = |s: f64, t: f64| {
        (
            at + DVec3::new(0.0, high * t, -half * s),
            DVec2::new(lerp(u0, u1, 0.5 + 0.5 * s), lerp(v0, v1, 0.5 + 0.5 * t)),
        )
    };
    mesh.polygon(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)]);
    let behind = |s: f64, t: f64| (at + DVec3::new(-0.004 * end, high * t, -half * s), BLACK);
    mesh.polygon(&[behind(1.0, -1.0), behind(-1.0, -1.0), behind(-1.0, 1.0), behind(1.0, 1.0)]);
}
