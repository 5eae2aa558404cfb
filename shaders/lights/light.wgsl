// Sampling of a light from a surface point, with densities per solid angle. Twin:
// src/lights/light.rs.

struct LightSample {
    direction: vec3f,
    distance: f32,
    radiance: vec3f,
    pdf: f32,
    extended: bool,
}

const NO_LIGHT = LightSample(vec3f(0.0, 0.0, 1.0), 0.0, vec3f(0.0), 1.0, true);

fn sample_light(shares: u32, position: vec3f, u: vec4f) -> LightSample {
    let index = choose_light(shares, u.x);
    let share = share_of(shares, index);
    return sample_one_light(scene.lights[index], share, position, u);
}

fn sample_one_light(light: Light, share: f32, position: vec3f, u: vec4f) -> LightSample {
    switch light.kind {
        //#if area
        case LIGHT_AREA: {
            return light_from_area(light, share, position, u);
        }
        //#end
        //#if point
        case LIGHT_POINT: {
            return light_from_point(light, share, position);
        }
        //#end
        //#if spot
        case LIGHT_SPOT: {
            return light_from_spot(light, share, position);
        }
        //#end
        //#if infinite
        case LIGHT_SUN: {
            return light_from_sun(light, share);
        }
        //#end
        //#if sun_disc
        case LIGHT_SUN_DISC: {
            return light_from_sun_disc(light, share, u);
        }
        //#end
        //#if environment
        case LIGHT_CONSTANT, LIGHT_IMAGE: {
            return light_from_environment(light, share, u);
        }
        //#end
        default: {
            return NO_LIGHT;
        }
    }
}
