//! Maps from uniform numbers to discs, spheres, hemispheres and triangles. Twin:
//! `shaders/math/sampling.wgsl`.

use super::real::{Real, Vec2, Vec3};
use super::trig::sin_cos;
use super::{PI, TAU};

/// Uniform sample of the unit disc.
pub fn sample_disc(u: Vec2) -> Vec2 {
    let r = u.x.sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec2::new(r * c, r * s)
}

/// Cosine-weighted direction about +z; the density is `z / pi`, sr^-1.
pub fn sample_cosine(u: Vec2) -> Vec3 {
    let d = sample_disc(u);
    Vec3::new(d.x, d.y, (1.0 - u.x).sqrt())
}

/// Uniform direction on the unit sphere; the density is `1 / (4 pi)`, sr^-1.
pub fn sample_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (4.0 * u.x * (1.0 - u.x)).sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec3::new(r * c, r * s, z)
}

/// Uniform direction in the cone about +z with `one_minus_cos = 1 - cos(half-angle)`; the density
/// is `1 / (2 pi one_minus_cos)`, sr^-1.
pub fn sample_cone(u: Vec2, one_minus_cos: Real) -> Vec3 {
    let h = u.x * one_minus_cos;
    let r = (h * (2.0 - h)).sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec3::new(r * c, r * s, 1.0 - h)
}

/// Barycentric weights of the second and third vertex for a uniform point in a triangle.
pub fn sample_triangle(u: Vec2) -> Vec2 {
    let r = u.x.sqrt();
    Vec2::new(r * (1.0 - u.y), r * u.y)
}

/// Weight of strategy `a` against `b` (balance heuristic, Veach & Guibas 1995).
pub fn balance(a: Real, b: Real) -> Real {
    a / (a + b)
}

/// Density of [`sample_sphere`], sr^-1.
pub const PDF_SPHERE: Real = 1.0 / (4.0 * PI);
