// Environments: the radiance of rays that leave the scene, constant or from an image. Twin:
// src/lights/environment.rs.

fn eval_environment(light: Light, direction: vec3f) -> vec3f {
    //#if environment_image
    switch light.kind {
        case LIGHT_IMAGE: {
            return eval_image(light, direction);
        }
        default: {}
    }
    //#end
    return light.color;
}

fn sample_environment(light: Light, u: vec4f) -> vec3f {
    //#if environment_image
    switch light.kind {
        case LIGHT_IMAGE: {
            return sample_image(light, u);
        }
        default: {}
    }
    //#end
    return sample_sphere(vec2f(u.y, u.z));
}

fn pdf_environment(light: Light, direction: vec3f) -> f32 {
    //#if environment_image
    switch light.kind {
        case LIGHT_IMAGE: {
            return pdf_image(light, direction);
        }
        default: {}
    }
    //#end
    return PDF_SPHERE;
}

fn light_from_environment(light: Light, share: f32, u: vec4f) -> LightSample {
    let direction = sample_environment(light, u);
    return LightSample(
        direction,
        FAR,
        eval_environment(light, direction),
        pdf_environment(light, direction) * share,
        true,
    );
}
