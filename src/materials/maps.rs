//! Normal maps and bump maps: textures that bend the shading normal. Twin:
//! `shaders/materials/maps.wgsl`.

use super::geometry::surface::Surface;
use super::geometry::tangents::{Tangents, tangents_at};
use super::math::unit;
use super::real::{Real, Vec2, Vec3};
use super::shapes::ray::Hit;
use super::tables::*;
use super::texture::eval_texture;

/// Least cosine of a bent normal with the geometric one.
const LEAST_COS: Real = 0.02;
/// Columns and rows of a square of a checker as a height, whose edges are as steep as one of them.
const CHECKER_CELLS: Real = 64.0;

/// Shading normal at a hit with surface `s`, bent by the maps of the material `m`.
#[inline(never)]
pub fn mapped_normal(scene: &SceneTables, m: &Material, hit: Hit, s: Surface) -> Vec3 {
    let t = tangents_at(scene, hit, s);
    let mut n = s.shading;
    if m.bump_map != NONE {
        n = normal_from_bumps(scene, m, s.uv, n, t);
    }
    if m.normal_map != NONE {
        n = normal_from_map(scene, m, s.uv, n, t);
    }
    let cos = n.dot(s.normal);
    if cos < LEAST_COS {
        n = unit(n + s.normal * (LEAST_COS - cos));
    }
    n
}

/// Normal of a surface that is moved along its normal `n` by the height that a texture gives
/// (Mikkelsen 2010, "Bump mapping unparametrized surfaces on the GPU", section 2).
fn normal_from_bumps(scene: &SceneTables, m: &Material, uv: Vec2, n: Vec3, t: Tangents) -> Vec3 {
    let texture = &scene.textures[m.bump_map as usize];
    // central differences over one texel: continuous, because textures are filtered bilinearly
    let mut du = CHECKER_CELLS;
    let mut dv = CHECKER_CELLS;
    if texture.kind != TEXTURE_CHECKER {
        du = texture.width as Real;
        dv = texture.height as Real;
    }
    du = 0.5 / (du * texture.scale.x.abs());
    dv = 0.5 / (dv * texture.scale.y.abs());
    let (u, v) = (Vec2::new(du, 0.0), Vec2::new(0.0, dv));
    let by_u = (height_at(scene, m, uv + u) - height_at(scene, m, uv - u)) / (2.0 * du);
    let by_v = (height_at(scene, m, uv + v) - height_at(scene, m, uv - v)) / (2.0 * dv);
    let area = n.dot(t.u.cross(t.v));
    if area == 0.0 {
        return n;
    }
    let slope = (t.v.cross(n) * by_u + n.cross(t.u) * by_v) * (1.0 / area);
    unit(n - slope)
}

/// Height at `uv`, scene units.
fn height_at(scene: &SceneTables, m: &Material, uv: Vec2) -> Real {
    let color = eval_texture(scene, m.bump_map, uv);
    (color.x + color.y + color.z) * (m.bump_height * (1.0 / 3.0))
}

/// Normal that a texture gives in the frame of `n` and the directions of u and v, each component
/// as `(x + 1) / 2`.
fn normal_from_map(scene: &SceneTables, m: &Material, uv: Vec2, n: Vec3, t: Tangents) -> Vec3 {
    let color = eval_texture(scene, m.normal_map, uv);
    let x = (2.0 * color.x - 1.0) * m.normal_strength;
    let y = (2.0 * color.y - 1.0) * m.normal_strength;
    let z = 2.0 * color.z - 1.0;
    let along = t.u - n * n.dot(t.u);
    if along.dot(along) == 0.0 || x * x + y * y + z * z < 1e-6 {
        return n;
    }
    let tangent = unit(along);
    let mut bitangent = n.cross(tangent);
    if n.dot(t.u.cross(t.v)) < 0.0 {
        bitangent = -bitangent;
    }
    unit((tangent * x + bitangent * y) + n * z)
}
