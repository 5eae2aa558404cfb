// Point lights: they emit evenly into all directions. Twin: src/lights/point.rs.

fn light_from_point(light: Light, share: f32, position: vec3f) -> LightSample {
    let to = light.position - position;
    let dist_sq = dot(to, to);
    if dist_sq == 0.0 {
        return NO_LIGHT;
    }
    let distance = sqrt(dist_sq);
    return LightSample(
        to * (1.0 / distance),
        distance * (1.0 - 16.0 * EPS),
        light.color * (1.0 / dist_sq),
        share,
        false,
    );
}

//#if photon_trace
fn emit_point(light: Light, across: vec2f) -> Emission {
    let direction = unit(sample_sphere(across));
    let ray = Ray(light.position, 0.0, direction, FAR);
    return unguided(ray, light.color * (2.0 * TAU / light.selection));
}
//#end
