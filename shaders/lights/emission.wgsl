// Photon emission from all kinds of lights. Twin: src/lights/emission.rs, which documents the
// fields and functions.

struct Emission {
    ray: Ray,
    flux: vec3f,
    relative_flux: f32,
    interior: Interior,
}

fn emit_photon(rng: ptr<function, Rng>) -> Emission {
    let u = rng_next(rng);
    let v = rng_next(rng);
    return emit_from(scene.lights[choose_light(0u, u.x)], u, v);
}

fn emit_from(light: Light, u: vec4f, v: vec4f) -> Emission {
    //#if infinite
    if light.kind >= LIGHT_SUN {
        return emit_from_infinity(light, u, v);
    }
    //#end
    //#if area || point || spot
    //#if guided
    let sent = guided(light, vec2f(v.x, v.y), v.w);
    var emission = emit_nearby(light, u, sent.across);
    emission.flux *= sent.scale;
    emission.relative_flux *= sent.scale;
    //#else
    var emission = emit_nearby(light, u, vec2f(v.x, v.y));
    //#end
    emission.interior = interior_at(light.medium, emission.ray.origin);
    return emission;
    //#else
    let ray = Ray(light.position, 0.0, vec3f(0.0, 0.0, 1.0), FAR);
    return Emission(ray, vec3f(0.0), 1.0, interior_of(NONE));
    //#end
}

//#if area || point || spot
fn emit_nearby(light: Light, u: vec4f, across: vec2f) -> Emission {
    var ray = Ray(light.position, 0.0, vec3f(0.0, 0.0, 1.0), FAR);
    //#if area_sphere
    if light.kind == LIGHT_AREA && kind_of(light.reference) == KIND_SPHERE {
        ray.direction = sample_sphere(across);
        let p = sample_sphere_facing(light, vec2f(u.y, u.z), ray.direction);
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission(ray, flux, 1.0, interior_of(NONE));
    }
    //#end
    //#if area
    if light.kind == LIGHT_AREA {
        let p = sample_shape(light, vec2f(u.y, u.z), u.w);
        ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return Emission(ray, flux, 1.0, interior_of(NONE));
    }
    //#end
    //#if spot
    if light.kind == LIGHT_SPOT {
        let local = sample_cone(across, light.outer);
        ray.direction = unit(from_frame(light.direction, local));
        let solid_angle = TAU * light.outer;
        let flux = light.color * (spot_falloff(light, across.x * light.outer) * solid_angle / light.selection);
        return Emission(ray, flux, 1.0, interior_of(NONE));
    }
    //#end
    ray.direction = unit(sample_sphere(across));
    let flux = light.color * (2.0 * TAU / light.selection);
    return Emission(ray, flux, 1.0, interior_of(NONE));
}
//#end

//#if infinite
fn emit_from_infinity(light: Light, u: vec4f, v: vec4f) -> Emission {
    let near = scene.world.near_radius;
    var ray = Ray(vec3f(0.0), 0.0, light.direction, FAR);
    var radiance = light.color;
    //#if environment
    if light.kind != LIGHT_SUN {
        let w = sample_environment(light, u);
        ray.direction = -w;
        radiance = eval_environment(light, w) * (1.0 / pdf_environment(light, w));
    }
    //#end
    // choose a point on a disc or in the map's square
    let across = vec2f(v.x, v.y);
    let level = find_interval(scene.world.disc_first, scene.world.disc_levels, v.z);
    var d = sample_disc(across) * disc_radius(level);
    //#if guided
    if light.guide != 0u && v.w < GUIDED {
        d = guided(light, across, v.w * (1.0 / GUIDED)).across;
        d = (d * 2.0 - vec2f(1.0)) * near;
    }
    //#end
    // density per area of that point
    var pdf = pdf_discs(dot(d, d));
    //#if guided
    if light.guide != 0u {
        let by_map = pdf_guide(light, (d * (1.0 / near) + vec2f(1.0)) * 0.5) / (4.0 * near * near);
        pdf = GUIDED * by_map + (1.0 - GUIDED) * pdf;
    }
    //#end
    // start far behind the plane of the discs
    let f = basis(ray.direction);
    ray.origin = scene.world.near_center + f.t * d.x + f.b * d.y;
    ray.t_min = -4.0 * disc_radius(scene.world.disc_levels - 1u);
    let flux = radiance * (1.0 / (pdf * light.selection));
    let usual = pdf_discs(0.25 * near * near);
    return Emission(ray, flux, usual / pdf, interior_from(ray.direction));
}

fn disc_radius(level: u32) -> f32 {
    return scene.world.disc_radius * f32(1u << level);
}

fn pdf_discs(r_sq: f32) -> f32 {
    var radius = scene.world.disc_radius;
    var sum = 0.0;
    for (var level = 0u; level < scene.world.disc_levels; level++) {
        if r_sq <= radius * (radius * (1.0 + 16.0 * EPS)) {
            sum += share_of(scene.world.disc_first, level) / (PI * radius * radius);
        }
        radius *= 2.0;
    }
    return sum;
}
//#end
