// Textures. Images are stored in a buffer and filtered here, so that every engine filters alike.
// Twin: src/materials/texture.rs.

fn eval_texture(index: u32, uv: vec2f) -> vec3f {
    let texture = scene.textures[index];
    var st = uv * texture.scale;
    //#if checker
    if texture.kind == TEXTURE_CHECKER {
        let cell = floor(st.x) + floor(st.y);
        let odd = cell - 2.0 * floor(cell * 0.5);
        return select(texture.color1, texture.color0, odd == 0.0);
    }
    //#end
    //#if texels
    if texture.kind == TEXTURE_PLANKS {
        let row = floor(st.x);
        let odd = row - 2.0 * floor(row * 0.5);
        st.y += 0.5 * odd;
    }
    // position in texels, repeated or clamped
    let clamp_u = (texture.flags & TEXTURE_CLAMP_U) != 0u;
    let clamp_v = (texture.flags & TEXTURE_CLAMP_V) != 0u;
    let x = select(st.x - floor(st.x), clamp(st.x, 0.0, 1.0), clamp_u) * f32(texture.width);
    let t = select(st.y - floor(st.y), clamp(st.y, 0.0, 1.0), clamp_v);
    let y = (1.0 - t) * f32(texture.height);
    if (texture.flags & TEXTURE_NEAREST) != 0u {
        return eval_texel(texture, i32(floor(x)), i32(floor(y)));
    }
    // bilinear filter
    let x0 = floor(x - 0.5);
    let y0 = floor(y - 0.5);
    let fx = x - 0.5 - x0;
    let fy = y - 0.5 - y0;
    let i = i32(x0);
    let j = i32(y0);
    let top = eval_texel(texture, i, j) * (1.0 - fx) + eval_texel(texture, i + 1, j) * fx;
    let bottom = eval_texel(texture, i, j + 1) * (1.0 - fx)
        + eval_texel(texture, i + 1, j + 1) * fx;
    return top * (1.0 - fy) + bottom * fy;
    //#else
    return vec3f(0.0);
    //#end
}

//#if texels
fn eval_texel(texture: Texture, i: i32, j: i32) -> vec3f {
    let w = i32(texture.width);
    let h = i32(texture.height);
    var x = i;
    var y = j;
    if (texture.flags & TEXTURE_CLAMP_U) == 0u {
        x = select(select(x, x - w, x >= w), x + w, x < 0);
    }
    if (texture.flags & TEXTURE_CLAMP_V) == 0u {
        y = select(select(y, y - h, y >= h), y + h, y < 0);
    }
    x = clamp(x, 0, w - 1);
    y = clamp(y, 0, h - 1);
    let at = u32(y * w + x);
    if texture.format == TEXELS_FLOAT {
        let k = texture.first + 3u * at;
        return vec3f(
            bitcast<f32>(texels[k]), bitcast<f32>(texels[k + 1u]), bitcast<f32>(texels[k + 2u])
        );
    }
    let word = texels[texture.first + at];
    let r = word & 255u;
    let g = (word >> 8u) & 255u;
    let b = (word >> 16u) & 255u;
    if texture.format == TEXELS_SRGB8 {
        return vec3f(bitcast<f32>(texels[r]), bitcast<f32>(texels[g]), bitcast<f32>(texels[b]));
    }
    return vec3f(f32(r), f32(g), f32(b)) * (1.0 / 255.0);
}
//#end
