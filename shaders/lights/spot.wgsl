// Spot lights: points that emit into a cone. Twin: src/lights/spot.rs.

fn spot_falloff(light: Light, versine: f32) -> f32 {
    if versine <= light.inner {
        return 1.0;
    }
    if versine >= light.outer {
        return 0.0;
    }
    let x = (light.outer - versine) / (light.outer - light.inner);
    return x * x * (3.0 - 2.0 * x);
}

fn light_from_spot(light: Light, share: f32, position: vec3f) -> LightSample {
    var sample = light_from_point(light, share, position);
    // half the squared chord: near the axis 1 - cos loses all digits
    let chord = sample.direction + light.direction;
    sample.radiance *= spot_falloff(light, 0.5 * dot(chord, chord));
    return sample;
}

//#if photon_trace
fn emit_spot(light: Light, across: vec2f) -> Emission {
    let local = sample_cone(across, light.outer);
    let direction = unit(from_frame(light.direction, local));
    let ray = Ray(light.position, 0.0, direction, FAR);
    let solid_angle = TAU * light.outer;
    let falloff = spot_falloff(light, across.x * light.outer);
    return unguided(ray, light.color * (falloff * solid_angle / light.selection));
}
//#end
