// Projectors: points that throw an image through a pinhole. Twin: src/lights/projector.rs.

fn eval_projector(light: Light, uv: vec2f) -> vec3f {
    //#if textures
    if (light.flags & LIGHT_TEXTURED) != 0u {
        return light.color * eval_texture(light.texture, uv);
    }
    //#end
    return light.color;
}

fn light_from_projector(light: Light, share: f32, position: vec3f) -> LightSample {
    let start = position - light.position;
    let z = dot(start, light.direction);
    if z <= 0.0 {
        return NO_LIGHT;
    }
    let up = cross(light.right, light.direction) * light.outer;
    let x = dot(start, light.right) / (z * dot(light.right, light.right));
    let y = dot(start, up) / (z * dot(up, up));
    if abs(x) >= 1.0 || abs(y) >= 1.0 {
        return NO_LIGHT;
    }
    let irradiance = eval_projector(light, vec2f(x + 1.0, y + 1.0) * 0.5);
    let distance = sqrt(dot(start, start));
    return LightSample(
        start * (-1.0 / distance),
        distance * (1.0 - 16.0 * EPS),
        // a screen at depth z receives irradiance / z^2, at the cosine z / distance
        irradiance * (distance / (z * z * z)),
        share,
        false,
    );
}

//#if photon_trace
fn emit_projector(light: Light, across: vec2f) -> Emission {
    var uv = across;
    var pdf = 1.0;
    if (light.flags & LIGHT_MAPPED) != 0u {
        let row = inverted(light.map, 32u, across.y);
        let columns = light.map + 32u + row.bin * 32u;
        let column = inverted(columns, 32u, across.x);
        uv = vec2f(column.at, row.at);
        pdf = row.pdf * column.pdf;
    }
    let up = cross(light.right, light.direction) * light.outer;
    let d = light.direction + light.right * (2.0 * uv.x - 1.0) + up * (2.0 * uv.y - 1.0);
    let ray = Ray(light.position, 0.0, unit(d), FAR);
    let flux = eval_projector(light, uv) * (light.area / (pdf * light.selection));
    return unguided(ray, flux);
}
//#end
