//! Textured emission: a texture scales the radiance of an area light. A rectangle is sampled by an
//! emission map, a density over its (s, t) that the host derives from the texture; other shapes are
//! sampled as without a texture. Twin: `shaders/lights/glow.wgsl`.

use super::geometry::surface::Surface;
use super::materials::texture::eval_texture;
use super::math::sampling::sample_triangle;
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::find_interval;
use super::shape::{ShapePoint, pdf_bin};
use super::shapes::cuboid::cuboid_uv;
use super::shapes::disc::disc_uv;
use super::shapes::sphere::sphere_uv;
use super::tables::*;

/// Number of cells along each side of an emission map: cumulative rows, then the cumulative columns
/// of each row.
pub const MAP_SIDE: u32 = 32;

/// Random numbers for `sample_shape`, and their density on the unit square.
#[derive(Clone, Copy, Debug)]
pub struct Warped {
    /// The two numbers that determine the point.
    pub across: Vec2,
    /// The number that chooses a face or patch.
    pub pick: Real,
    /// Density of `across`.
    pub pdf: Real,
}

/// Maps `u.yzw` by the emission map of `light`, if it has one.
pub fn warped(scene: &SceneTables, light: &Light, u: Vec4) -> Warped {
    if light.flags & LIGHT_MAPPED == 0 {
        return Warped { across: Vec2::new(u.y, u.z), pick: u.w, pdf: 1.0 };
    }
    let row = find_interval(scene, light.map, MAP_SIDE, u.y);
    let columns = light.map + MAP_SIDE + row * MAP_SIDE;
    let column = find_interval(scene, columns, MAP_SIDE, u.z);
    // the offset in the row comes from the lower bits of u.w, as in an environment image
    let fine = u.w * 4096.0;
    let x = (column as Real + u.w) * (1.0 / MAP_SIDE as Real);
    let y = (row as Real + (fine - fine.floor())) * (1.0 / MAP_SIDE as Real);
    let pdf = pdf_bin(scene, light.map, row, MAP_SIDE) * pdf_bin(scene, columns, column, MAP_SIDE);
    Warped { across: Vec2::new(x, y), pick: u.w, pdf }
}

/// Density of the emission map of `light` at the rectangle's (s, t); 1 without a map.
pub fn pdf_map(scene: &SceneTables, light: &Light, st: Vec2) -> Real {
    if light.flags & LIGHT_MAPPED == 0 {
        return 1.0;
    }
    let row = ((st.y * MAP_SIDE as Real).floor().max(0.0) as u32).min(MAP_SIDE - 1);
    let column = ((st.x * MAP_SIDE as Real).floor().max(0.0) as u32).min(MAP_SIDE - 1);
    let columns = light.map + MAP_SIDE + row * MAP_SIDE;
    pdf_bin(scene, light.map, row, MAP_SIDE) * pdf_bin(scene, columns, column, MAP_SIDE)
}

/// Radiance at a sampled point; `across` and `pick` are the numbers that it was sampled by.
pub fn glow_at_sample(
    scene: &SceneTables,
    light: &Light,
    p: &ShapePoint,
    across: Vec2,
    pick: Real,
) -> Vec3 {
    if light.flags & LIGHT_TEXTURED == 0 {
        return light.color;
    }
    light.color * eval_texture(scene, light.texture, sample_uv(scene, light, p, across, pick))
}

/// Radiance at a hit.
pub fn glow_at_surface(scene: &SceneTables, light: &Light, s: &Surface) -> Vec3 {
    if light.flags & LIGHT_TEXTURED == 0 {
        return light.color;
    }
    light.color * eval_texture(scene, light.texture, surface_uv(scene, light, s))
}

/// Texture coordinates of the emission at a hit.
fn surface_uv(scene: &SceneTables, light: &Light, s: &Surface) -> Vec2 {
    let index = index_of(light.reference) as usize;
    match kind_of(light.reference) {
        KIND_SPHERE if scene.spheres[index].uv == UV_NATURAL => {
            between_ends(scene, light, sphere_uv(s.normal))
        }
        KIND_REVOLUTION if scene.revolutions[index].uv == UV_NATURAL => {
            between_ends(scene, light, Vec2::new(s.uv.x, s.v))
        }
        _ => s.uv,
    }
}

/// Texture coordinates of the emission at a sampled point.
fn sample_uv(scene: &SceneTables, light: &Light, p: &ShapePoint, across: Vec2, pick: Real) -> Vec2 {
    let index = index_of(light.reference) as usize;
    match kind_of(light.reference) {
        KIND_TRIANGLE => {
            let triangle = &scene.triangles[index];
            if triangle.attributes == NONE {
                return Vec2::ZERO;
            }
            let a = &scene.attributes[triangle.attributes as usize];
            let b = sample_triangle(across);
            let w = 1.0 - b.x - b.y;
            Vec2::new(a.u0 * w + a.u1 * b.x + a.u2 * b.y, a.v0 * w + a.v1 * b.x + a.v2 * b.y)
        }
        KIND_SPHERE => {
            let sphere = &scene.spheres[index];
            if sphere.uv == UV_PLANAR {
                return planar_uv(scene, sphere.material, p.position);
            }
            between_ends(scene, light, sphere_uv(p.normal))
        }
        KIND_RECTANGLE => {
            let rectangle = &scene.rectangles[index];
            if rectangle.uv == UV_PLANAR {
                return planar_uv(scene, rectangle.material, p.position);
            }
            across
        }
        KIND_DISC => {
            let disc = &scene.discs[index];
            if disc.uv == UV_PLANAR {
                return planar_uv(scene, disc.material, p.position);
            }
            disc_uv(disc, p.position)
        }
        KIND_CUBOID => {
            let cuboid = &scene.cuboids[index];
            if cuboid.uv == UV_PLANAR {
                return planar_uv(scene, cuboid.material, p.position);
            }
            let n = p.normal;
            let axis = if n.x != 0.0 {
                0.0
            } else if n.y != 0.0 {
                1.0
            } else {
                2.0
            };
            let upper = if n.x + n.y + n.z > 0.0 { 3.0 } else { 0.0 };
            cuboid_uv(cuboid, p.position, axis + upper)
        }
        _ => {
            let revolution = &scene.revolutions[index];
            if revolution.uv == UV_PLANAR {
                return planar_uv(scene, revolution.material, p.position);
            }
            let k = find_interval(scene, light.first + light.patch_count, light.patch_count, pick);
            let start = scene.distributions[(light.first + k) as usize];
            let end = if k + 1 < light.patch_count {
                scene.distributions[(light.first + k + 1) as usize]
            } else {
                1.0
            };
            // u = 0.5 - angle / 2 pi, and the angle is 2 pi across.y - pi
            let uv = Vec2::new(1.0 - across.y, start + (end - start) * across.x);
            if revolution.uv == UV_NATURAL { between_ends(scene, light, uv) } else { uv }
        }
    }
}

/// World (x, z) of a point, as surfaces with planar uv have it.
fn planar_uv(scene: &SceneTables, material: u32, position: Vec3) -> Vec2 {
    let origin = scene.materials[material as usize].planar_origin;
    Vec2::new(position.x, position.z) * scene.world.unit + origin
}

/// Clamps v to half a texel row from its ends, so that filtering does not mix in the opposite end.
fn between_ends(scene: &SceneTables, light: &Light, uv: Vec2) -> Vec2 {
    let texture = &scene.textures[light.texture as usize];
    if texture.kind != TEXTURE_IMAGE {
        return uv;
    }
    let half = (0.5 / (texture.height as Real * texture.scale.y.abs())).min(0.5);
    Vec2::new(uv.x, uv.y.max(half).min(1.0 - half))
}
