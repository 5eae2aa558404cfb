// Suns with an angular size: discs of even radiance at infinity, which eye paths see. Twin:
// src/lights/sun_disc.rs.

fn sample_sun_disc(light: Light, u: vec4f) -> vec3f {
    return unit(from_frame(-light.direction, sample_cone(vec2f(u.y, u.z), light.outer)));
}

fn pdf_sun_disc(light: Light) -> f32 {
    return 1.0 / (TAU * light.outer);
}

fn in_sun_disc(light: Light, direction: vec3f) -> bool {
    // half the squared chord: near the axis 1 - cos loses all digits
    let chord = direction + light.direction;
    return 0.5 * dot(chord, chord) <= light.outer;
}

fn light_from_sun_disc(light: Light, share: f32, u: vec4f) -> LightSample {
    return LightSample(
        sample_sun_disc(light, u), FAR, light.color, pdf_sun_disc(light) * share, true
    );
}

fn eval_sun_discs(direction: vec3f) -> vec3f {
    var radiance = vec3f(0.0);
    var index = scene.world.sun_discs;
    while index != NONE {
        let light = scene.lights[index];
        if in_sun_disc(light, direction) {
            radiance += light.color;
        }
        index = light.reference;
    }
    return radiance;
}
