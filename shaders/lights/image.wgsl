// Environment given by an equirectangular image. Twin: src/lights/image.rs, which explains the
// fields.

fn untilted(light: Light, d: vec3f) -> vec3f {
    //#if tilted_sky
    let z = cross(light.position, light.direction);
    return vec3f(dot(light.position, d), dot(light.direction, d), dot(z, d));
    //#else
    return d;
    //#end
}

fn tilted(light: Light, d: vec3f) -> vec3f {
    //#if tilted_sky
    let z = cross(light.position, light.direction);
    return light.position * d.x + light.direction * d.y + z * d.z;
    //#else
    return d;
    //#end
}

fn image_uv(light: Light, direction: vec3f) -> vec2f {
    let x = light.outer * direction.x - light.inner * direction.z;
    let z = light.inner * direction.x + light.outer * direction.z;
    let r = sqrt(x * x + z * z);
    return vec2f(0.5 - arctan2(z, x) * (1.0 / TAU), 1.0 - arctan2(r, direction.y) * (1.0 / PI));
}

fn eval_image(light: Light, direction: vec3f) -> vec3f {
    return light.color * eval_texture(light.reference, image_uv(light, untilted(light, direction)));
}

fn sample_image(light: Light, u: vec4f) -> vec3f {
    let texture = scene.textures[light.reference];
    let row = find_interval(light.first, texture.height, u.y);
    let column = find_interval(
        light.first + texture.height + row * texture.width, texture.width, u.z
    );
    // offset in the row from the lower bits of u.w: what is left of u.y gives few distinct offsets
    // in rows of low probability
    let fine = u.w * 4096.0;
    let across = (f32(column) + u.w) / f32(texture.width);
    let down = (f32(row) + (fine - floor(fine))) / f32(texture.height);
    let phi = sin_cos((0.5 - across) * TAU);
    let theta = sin_cos(down * PI);
    let x = theta.x * phi.y;
    let z = theta.x * phi.x;
    let d = vec3f(
        light.outer * x + light.inner * z,
        theta.y,
        light.outer * z - light.inner * x,
    );
    return tilted(light, d);
}

fn pdf_image(light: Light, toward: vec3f) -> f32 {
    let texture = scene.textures[light.reference];
    let direction = untilted(light, toward);
    let uv = image_uv(light, direction);
    let row = min(u32(floor((1.0 - uv.y) * f32(texture.height))), texture.height - 1u);
    let column = min(u32(floor(uv.x * f32(texture.width))), texture.width - 1u);
    let p = pdf_bin(light.first, row, texture.height)
        * pdf_bin(light.first + texture.height + row * texture.width, column, texture.width);
    // from x and z: near a pole 1 - y^2 loses all digits
    let sin = sqrt(max(direction.x * direction.x + direction.z * direction.z, 1e-12));
    return p / (2.0 * PI * PI * sin);
}
