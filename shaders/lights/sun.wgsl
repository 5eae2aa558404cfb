// Suns: parallel light. Twin: src/lights/sun.rs.

fn light_from_sun(light: Light, share: f32) -> LightSample {
    return LightSample(-light.direction, FAR, light.color, share, false);
}
