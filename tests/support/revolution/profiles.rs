//! Profiles of every kind that a scene may contain.

use caustica::low_level::accel::revolution::{Attributes, PatchBox, Placement, RevolutionTables};
use glam::{DQuat, DVec2, DVec3};

/// A named profile: segments of (radius, height).
pub struct Profile {
    pub name: &'static str,
    pub segments: Vec<Vec<DVec2>>,
}

/// A profile placed in a scene, with its tables.
pub struct Placed {
    pub name: &'static str,
    /// In the local frame of the tables, as f64.
    pub segments: Vec<Vec<DVec2>>,
    pub tables: RevolutionTables,
    pub boxes: Vec<PatchBox>,
}

fn profile(name: &'static str, segments: &[&[[f64; 2]]]) -> Profile {
    // Round to f32, so that every solver receives the same profile.
    let round = |p: &[f64; 2]| DVec2::new(f64::from(p[0] as f32), f64::from(p[1] as f32));
    Profile { name, segments: segments.iter().map(|s| s.iter().map(round).collect()).collect() }
}

pub fn profiles() -> Vec<Profile> {
    let wave: Vec<[f64; 2]> = (0..16)
        .map(|i| {
            [
                0.5 + if i % 2 == 0 { 0.45 } else { -0.45 } * (1.0 - f64::from(i) / 20.0),
                f64::from(i) / 7.5,
            ]
        })
        .collect();
    // r' = (t - 0.37)(3 - t), y' = (t - 0.37)(4 t - 2): a cusp that rounding to f32 opens.
    let mut cusp = vec![[0.8, 0.3]];
    for i in 0..3 {
        let coefficient =
            |a: f64, b: f64| [-0.37 * a, -0.37 * a + 0.5 * (a - 0.37 * b), 0.63 * (a + b)][i] / 3.0;
        let last = cusp[i];
        cusp.push([last[0] + coefficient(3.0, -1.0), last[1] + coefficient(-2.0, 4.0)]);
    }
    vec![
        profile("cylinder", &[&[[0.5, 0.0], [0.5, 1.0]]]),
        profile("cone", &[&[[0.5, 0.0], [0.0, 1.0]]]),
        profile("paraboloid", &[&[[0.0, 0.0], [0.5, 0.0], [1.0, 0.5]]]),
        profile("vase", &[&[[0.0, 0.0], [0.6, 0.0], [0.3, 0.8], [0.4, 1.0]]]),
        profile("drop", &[&[[0.0, 0.0], [0.9, 0.0], [0.35, 0.7], [0.0, 1.3]]]),
        profile("undercut", &[&[[0.3, 0.0], [1.0, 1.2], [0.1, -0.3], [0.6, 1.0]]]),
        profile("degree 15", &[&wave]),
        profile(
            "bottle",
            &[
                &[[0.0, 0.0], [0.35, 0.0]],
                &[[0.35, 0.0], [0.4, 0.0], [0.4, 0.05]],
                &[[0.4, 0.05], [0.4, 0.6]],
                &[[0.4, 0.6], [0.4, 0.9], [0.12, 0.8], [0.12, 1.1]],
                &[[0.12, 1.1], [0.16, 1.12], [0.16, 1.2], [0.12, 1.22], [0.0, 1.22]],
            ],
        ),
        profile("near cusp", &[&cusp]),
        profile("cusp", &[&[[0.2, 0.0], [1.2, 1.0], [0.2, 1.0], [1.2, 0.0]]]),
    ]
}

/// The profile in a scene at the given placement.
pub fn place(profile: &Profile, placement: &Placement) -> Placed {
    let mut tables = RevolutionTables::default();
    let boxes =
        tables.push(&profile.segments, placement, Attributes::default()).expect("a surface");
    let all = || profile.segments.iter().flatten();
    let low = all().fold(DVec2::INFINITY, |a, p| a.min(*p));
    let high = all().fold(DVec2::NEG_INFINITY, |a, p| a.max(*p));
    let middle = 0.5 * (low.y + high.y);
    let size = (0.5 * (high.y - low.y)).max(high.x.abs()).max(low.x.abs());
    let local = |p: &DVec2| DVec2::new(p.x, p.y - middle) / size;
    let segments = profile.segments.iter().map(|s| s.iter().map(local).collect()).collect();
    Placed { name: profile.name, segments, tables, boxes }
}

/// Turned, shrunk and moved.
pub fn skew() -> Placement {
    Placement {
        rotation: DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1),
        scale: 0.37,
        translation: DVec3::new(0.8, -0.3, 0.5),
    }
}
