// Profiles: points whose intensity in each direction is given by an equirectangular image. Twin:
// src/lights/profile.rs.

fn light_from_profile(light: Light, share: f32, position: vec3f) -> LightSample {
    let to = light.position - position;
    let dist_sq = dot(to, to);
    if dist_sq == 0.0 {
        return NO_LIGHT;
    }
    let distance = sqrt(dist_sq);
    let direction = to * (1.0 / distance);
    return LightSample(
        direction,
        distance * (1.0 - 16.0 * EPS),
        eval_image(light, -direction) * (1.0 / dist_sq),
        share,
        false,
    );
}

//#if photon_trace
fn sample_profile(light: Light, across: vec2f) -> vec3f {
    let texture = scene.textures[light.reference];
    let row = inverted(light.first, texture.height, across.y);
    let columns = light.first + texture.height + row.bin * texture.width;
    let column = inverted(columns, texture.width, across.x);
    let phi = sin_cos((0.5 - column.at) * TAU);
    let theta = sin_cos(row.at * PI);
    return vec3f(theta.x * phi.y, theta.y, theta.x * phi.x);
}

fn emit_profile(light: Light, across: vec2f) -> Emission {
    let direction = unit(sample_profile(light, across));
    let ray = Ray(light.position, 0.0, direction, FAR);
    let pdf = pdf_image(light, direction);
    let flux = eval_image(light, direction) * (1.0 / (pdf * light.selection));
    return unguided(ray, flux);
}
//#end
