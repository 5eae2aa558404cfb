//! Rays of every kind at a placed surface of revolution, as f32.

use super::profiles::Placed;
use glam::{DVec2, DVec3, Vec3};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }

    /// Uniform on the sphere.
    pub fn direction(&mut self) -> DVec3 {
        let y = self.signed();
        let (s, c) = (std::f64::consts::TAU * self.next()).sin_cos();
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * c, y, r * s)
    }

    /// Uniform in the ball.
    pub fn ball(&mut self) -> DVec3 {
        self.direction() * self.next().cbrt()
    }
}

/// Kinds of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// From three radii away towards a random point of the bounding ball.
    Random,
    /// The same from a thousand radii away.
    Far,
    /// The same from a million radii away; not among [`CLASSES`].
    VeryFar,
    /// Along a tangent of the surface, moved off it along the normal by up to 2 % of its size.
    Grazing,
    /// Parallel to the axis or nearly, along it, through points of it, and square to it.
    Axial,
    /// From inside the bounding ball in any direction.
    Interior,
}

pub const CLASSES: [Class; 5] =
    [Class::Random, Class::Far, Class::Grazing, Class::Axial, Class::Interior];

/// Point and derivative of a Bezier curve.
pub fn curve(points: &[DVec2], t: f64) -> (DVec2, DVec2) {
    let mut b = points.to_vec();
    for k in 1..points.len() - 1 {
        for i in 0..points.len() - k {
            b[i] = b[i] * (1.0 - t) + b[i + 1] * t;
        }
    }
    (b[0] * (1.0 - t) + b[1] * t, (b[1] - b[0]) * (points.len() - 1) as f64)
}

/// An f32 ray (origin, unit direction) of the class.
pub fn ray(placed: &Placed, class: Class, random: &mut Random) -> (Vec3, Vec3) {
    let ball = placed.segments.iter().flatten().fold(0.0_f64, |a, p| a.max(p.length()));
    let (origin, direction) = match class {
        Class::Random | Class::Far | Class::VeryFar => {
            let distance = match class {
                Class::VeryFar => 1e6,
                Class::Far => 1000.0,
                _ => 3.0,
            };
            let origin = random.direction() * ball * distance;
            (origin, random.ball() * ball - origin)
        }
        Class::Interior => (random.ball() * ball, random.direction()),
        Class::Grazing => loop {
            let segment = &placed.segments[(random.next() * placed.segments.len() as f64) as usize];
            let (p, v) = curve(segment, random.next());
            if v.length() < 1e-6 {
                continue;
            }
            let v = v.normalize();
            let (s, c) = (std::f64::consts::TAU * random.next()).sin_cos();
            let point = DVec3::new(p.x * c, p.y, p.x * s);
            let normal = DVec3::new(v.y * c, -v.x, v.y * s);
            let (around, along) = (DVec3::new(-s, 0.0, c), DVec3::new(v.x * c, v.y, v.x * s));
            let (s, c) = (std::f64::consts::TAU * random.next()).sin_cos();
            let direction = around * c + along * s;
            break (point + normal * (0.02 * random.signed()) - direction * 3.0 * ball, direction);
        },
        Class::Axial => {
            let up = if random.next() < 0.5 { 1.0 } else { -1.0 };
            let p = random.ball() * ball;
            let on_axis = DVec3::new(0.0, p.y, 0.0);
            let level = DVec3::new(p.x, 0.0, p.z).normalize_or(DVec3::X);
            match (random.next() * 5.0) as u32 {
                0 => (DVec3::new(p.x, -3.0 * up * ball, p.z), DVec3::Y * up),
                1 => (p - DVec3::Y * (3.0 * up), DVec3::Y * up + random.ball() * 1e-4),
                2 => (DVec3::Y * (-3.0 * up), DVec3::Y * up),
                3 => {
                    let d = random.direction();
                    (on_axis - d * 3.0, d)
                }
                _ => (p - level * 3.0, level),
            }
        }
    };
    let revolution = &placed.tables.revolutions[0];
    let axes = [revolution.x_axis, revolution.y_axis, revolution.z_axis].map(Vec3::as_dvec3);
    let out = |v: DVec3| axes[0] * v.x + axes[1] * v.y + axes[2] * v.z;
    let origin = revolution.center.as_dvec3() + out(origin) * f64::from(revolution.scale);
    (origin.as_vec3(), out(direction).normalize().as_vec3())
}
