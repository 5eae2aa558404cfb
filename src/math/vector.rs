//! Small vector functions. Twin: `shaders/math/vector.wgsl`.

use glam::{Vec2, Vec3};

/// pi.
pub const PI: f32 = std::f32::consts::PI;
/// Twice pi.
pub const TAU: f32 = std::f32::consts::TAU;
/// One over pi.
pub const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
/// Farther than anything in a scene; WGSL has no infinity to rely on.
pub const FAR: f32 = 1e30;
/// Half an ulp of 1, the bound of one rounding.
pub const EPS: f32 = 5.9604645e-8;

/// `v` at length one.
pub fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}

/// Greatest component.
pub fn max_component(v: Vec3) -> f32 {
    v.x.max(v.y).max(v.z)
}

/// Greatest absolute value of a component.
pub fn max_abs(v: Vec3) -> f32 {
    max_component(v.abs())
}

/// Two unit vectors that complete `n` to a right-handed frame (Duff et al. 2017).
pub fn basis(n: Vec3) -> (Vec3, Vec3) {
    let s = if n.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (s + n.z);
    let b = n.x * n.y * a;
    (Vec3::new(1.0 + s * n.x * n.x * a, s * b, -s * n.x), Vec3::new(b, s + n.y * n.y * a, -n.y))
}

/// `local` (x, y along the tangents of [`basis`], z along `n`) in the space of `n`.
pub fn from_frame(n: Vec3, local: Vec3) -> Vec3 {
    let (t, b) = basis(n);
    t * local.x + b * local.y + n * local.z
}

/// `w` mirrored at the plane with unit normal `n`; both point away from the surface.
pub fn mirrored(w: Vec3, n: Vec3) -> Vec3 {
    n * (2.0 * w.dot(n)) - w
}

/// The origin of a ray that leaves `position` along `direction`, moved off the surface by the bound of the hit's
/// error (the idea of pbrt-v4, section 6.8, with a scalar bound).
pub fn offset_origin(position: Vec3, error: f32, normal: Vec3, direction: Vec3) -> Vec3 {
    if direction.dot(normal) >= 0.0 { position + normal * error } else { position - normal * error }
}

/// A unit vector in 32 bits: octahedral map, 16 bits each (Cigolle et al. 2014).
pub fn oct_encode(v: Vec3) -> u32 {
    let s = 1.0 / (v.x.abs() + v.y.abs() + v.z.abs());
    let p = Vec2::new(v.x * s, v.y * s);
    let mut q = p;
    if v.z < 0.0 {
        q.x = (1.0 - p.y.abs()) * if p.x >= 0.0 { 1.0 } else { -1.0 };
        q.y = (1.0 - p.x.abs()) * if p.y >= 0.0 { 1.0 } else { -1.0 };
    }
    let x = (q.x * 32767.0 + 32768.5).floor() as u32;
    let y = (q.y * 32767.0 + 32768.5).floor() as u32;
    x | y << 16
}

/// Inverse of [`oct_encode`].
pub fn oct_decode(code: u32) -> Vec3 {
    let x = ((code & 0xffff) as f32 - 32768.0) * (1.0 / 32767.0);
    let y = ((code >> 16) as f32 - 32768.0) * (1.0 / 32767.0);
    let mut v = Vec3::new(x, y, 1.0 - x.abs() - y.abs());
    if v.z < 0.0 {
        v.x = (1.0 - y.abs()) * if x >= 0.0 { 1.0 } else { -1.0 };
        v.y = (1.0 - x.abs()) * if y >= 0.0 { 1.0 } else { -1.0 };
    }
    unit(v)
}
