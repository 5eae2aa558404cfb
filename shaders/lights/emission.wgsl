// Photon emission from every kind of light: twin of src/lights/emission.rs.

struct Emission {
    ray: Ray,
    flux: vec3f,
    excess: f32,
    medium: u32,
}

fn emit_photon(rng: ptr<function, Rng>) -> Emission {
    let u = rng_next(rng);
    let v = rng_next(rng);
    let light = scene.lights[choose_light(u.x)];
    //#if guided
    let sent = guided(light, vec2f(v.x, v.y), v.w);
    var emission = emit_from(light, u, v, sent.across);
    emission.flux *= sent.scale;
    emission.excess *= sent.scale;
    return emission;
    //#else
    return emit_from(light, u, v, vec2f(v.x, v.y));
    //#end
}

fn emit_from(light: Light, u: vec4f, v: vec4f, across: vec2f) -> Emission {
    var ray = Ray(light.position, 0.0, vec3f(0.0, 0.0, 1.0), FAR);
    //#if area_sphere
    if light.kind == LIGHT_AREA && light.reference >> REFERENCE_BITS == KIND_SPHERE {
        ray.direction = sample_sphere(across);
        let p = sample_sphere_facing(light, vec2f(u.y, u.z), ray.direction);
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission(ray, flux, 1.0, light.medium);
    }
    //#end
    //#if area
    if light.kind == LIGHT_AREA {
        let p = sample_shape(light, vec2f(u.y, u.z), u.w);
        ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission(ray, flux, 1.0, light.medium);
    }
    //#end
    //#if point
    if light.kind == LIGHT_POINT {
        ray.direction = unit(sample_sphere(across));
        let flux = light.color * (2.0 * TAU / light.selection);
        return Emission(ray, flux, 1.0, light.medium);
    }
    //#end
    //#if spot
    if light.kind == LIGHT_SPOT {
        let local = sample_cone(across, 1.0 - light.cos_outer);
        ray.direction = unit(from_frame(light.direction, local));
        let solid_angle = TAU * (1.0 - light.cos_outer);
        let flux = light.color * (spot_falloff(light, local.z) * solid_angle / light.selection);
        return Emission(ray, flux, 1.0, light.medium);
    }
    //#end
    //#if infinite
    ray.direction = light.direction;
    var radiance = light.color;
    //#if environment
    if light.kind != LIGHT_SUN {
        let w = sample_environment(light, u);
        ray.direction = -w;
        radiance = eval_environment(light, w) * (1.0 / pdf_environment(light, w));
    }
    //#end
    var radius = scene.world.near_radius;
    var x = v.z;
    for (var i = 1u; i < scene.world.disc_levels; i++) {
        if x >= 0.5 {
            break;
        }
        x *= 2.0;
        radius *= 2.0;
    }
    let d = sample_disc(across) * radius;
    ray.origin = from_frame(ray.direction, vec3f(d.x, d.y, 0.0));
    ray.t_min = -4.0 * disc_radius_max();
    let pdf = pdf_discs(dot(d, d));
    let flux = radiance * (1.0 / (pdf * light.selection));
    return Emission(ray, flux, pdf_discs(0.0) / pdf, light.medium);
    //#else
    return Emission(ray, vec3f(0.0), 1.0, NONE);
    //#end
}

//#if infinite
fn disc_radius_max() -> f32 {
    var radius = scene.world.near_radius;
    for (var i = 1u; i < scene.world.disc_levels; i++) {
        radius *= 2.0;
    }
    return radius;
}

fn pdf_discs(r_sq: f32) -> f32 {
    var radius = scene.world.near_radius;
    var probability = 0.5;
    var sum = 0.0;
    for (var level = 1u; level < scene.world.disc_levels + 1u; level++) {
        if level == scene.world.disc_levels {
            probability *= 2.0;
        }
        if r_sq <= radius * (radius * (1.0 + 16.0 * EPS)) {
            sum += probability / (PI * radius * radius);
        }
        probability *= 0.5;
        radius *= 2.0;
    }
    return sum;
}
//#end
