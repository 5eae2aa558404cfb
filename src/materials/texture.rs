//! Textures. Images are stored in a buffer and filtered here, so that every engine filters alike.
//! Twin: `shaders/materials/texture.wgsl`.

use super::real::{Real, Vec2, Vec3};
use super::tables::*;

/// Colour of texture `index` at `uv`, linear Rec. 709.
pub fn eval_texture(scene: &SceneTables, index: u32, uv: Vec2) -> Vec3 {
    let texture = &scene.textures[index as usize];
    // patterns
    let mut st = uv * texture.scale;
    if texture.kind == TEXTURE_CHECKER {
        let cell = st.x.floor() + st.y.floor();
        let odd = cell - 2.0 * (cell * 0.5).floor();
        return if odd == 0.0 { texture.color0 } else { texture.color1 };
    }
    if texture.kind == TEXTURE_PLANKS {
        let row = st.x.floor();
        let odd = row - 2.0 * (row * 0.5).floor();
        st.y += 0.5 * odd;
    }
    // position in texels, repeated or clamped
    let clamp_u = texture.flags & TEXTURE_CLAMP_U != 0;
    let clamp_v = texture.flags & TEXTURE_CLAMP_V != 0;
    let x =
        if clamp_u { st.x.clamp(0.0, 1.0) } else { st.x - st.x.floor() } * texture.width as Real;
    let y = (1.0 - if clamp_v { st.y.clamp(0.0, 1.0) } else { st.y - st.y.floor() })
        * texture.height as Real;
    if texture.flags & TEXTURE_NEAREST != 0 {
        return eval_texel(scene, texture, x.floor() as i32, y.floor() as i32);
    }
    // bilinear filter
    let x0 = (x - 0.5).floor();
    let y0 = (y - 0.5).floor();
    let fx = x - 0.5 - x0;
    let fy = y - 0.5 - y0;
    let i = x0 as i32;
    let j = y0 as i32;
    let top =
        eval_texel(scene, texture, i, j) * (1.0 - fx) + eval_texel(scene, texture, i + 1, j) * fx;
    let bottom = eval_texel(scene, texture, i, j + 1) * (1.0 - fx)
        + eval_texel(scene, texture, i + 1, j + 1) * fx;
    top * (1.0 - fy) + bottom * fy
}

/// Texel at column `i`, row `j` from the top, wrapped or clamped; `i` and `j` may be at most one
/// image size outside.
pub fn eval_texel(scene: &SceneTables, texture: &Texture, i: i32, j: i32) -> Vec3 {
    let w = texture.width as i32;
    let h = texture.height as i32;
    let mut x = i;
    let mut y = j;
    if texture.flags & TEXTURE_CLAMP_U == 0 {
        x = if x < 0 {
            x + w
        } else if x >= w {
            x - w
        } else {
            x
        };
    }
    if texture.flags & TEXTURE_CLAMP_V == 0 {
        y = if y < 0 {
            y + h
        } else if y >= h {
            y - h
        } else {
            y
        };
    }
    x = x.clamp(0, w - 1);
    y = y.clamp(0, h - 1);
    let at = (y * w + x) as u32;
    if texture.format == TEXELS_FLOAT {
        let k = (texture.first + 3 * at) as usize;
        return Vec3::new(
            Real::from_bits(scene.texels[k]),
            Real::from_bits(scene.texels[k + 1]),
            Real::from_bits(scene.texels[k + 2]),
        );
    }
    let word = scene.texels[(texture.first + at) as usize];
    let r = word & 255;
    let g = (word >> 8) & 255;
    let b = (word >> 16) & 255;
    if texture.format == TEXELS_SRGB8 {
        return Vec3::new(
            Real::from_bits(scene.texels[r as usize]),
            Real::from_bits(scene.texels[g as usize]),
            Real::from_bits(scene.texels[b as usize]),
        );
    }
    Vec3::new(r as Real, g as Real, b as Real) * (1.0 / 255.0)
}
