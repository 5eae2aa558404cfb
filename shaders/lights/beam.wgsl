// Beams: parallel light that leaves a disc. Twin: src/lights/beam.rs.

fn light_from_beam(light: Light, share: f32, position: vec3f) -> LightSample {
    let d = position - light.position;
    let along = dot(d, light.direction);
    let across = d - light.direction * along;
    if along <= 0.0 || dot(across, across) > light.outer {
        return NO_LIGHT;
    }
    return LightSample(
        -light.direction, along * (1.0 - 16.0 * EPS), light.color, share, false
    );
}

//#if photon_trace
fn emit_beam(light: Light, across: vec2f) -> Emission {
    let d = sample_disc(across) * sqrt(light.outer);
    let f = basis(light.direction);
    let origin = light.position + f.t * d.x + f.b * d.y;
    let ray = Ray(origin, 0.0, light.direction, FAR);
    return unguided(ray, light.color * (light.area / light.selection));
}
//#end
