// Photon emission. Twin: src/lights/emission.rs, which documents the fields and functions.

struct Emission {
    ray: Ray,
    flux: vec3f,
    relative_flux: f32,
    interior: Interior,
    extended: bool,
}

fn unguided(ray: Ray, flux: vec3f) -> Emission {
    return Emission(ray, flux, 1.0, interior_of(NONE), false);
}

fn emit_photon(rng: ptr<function, Rng>) -> Emission {
    let u = rng_next(rng);
    let v = rng_next(rng);
    let light = scene.lights[choose_light(0u, u.x)];
    var emission = emit_from(light, u, v);
    emission.extended = is_extended(light.kind);
    return emission;
}

fn emit_from(light: Light, u: vec4f, v: vec4f) -> Emission {
    //#if infinite
    if is_infinite(light.kind) {
        return emit_from_infinity(light, u, v);
    }
    //#end
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
}

fn emit_nearby(light: Light, u: vec4f, across: vec2f) -> Emission {
    switch light.kind {
        //#if area
        case LIGHT_AREA: {
            return emit_area(light, u, across);
        }
        //#end
        //#if point
        case LIGHT_POINT: {
            return emit_point(light, across);
        }
        //#end
        //#if spot
        case LIGHT_SPOT: {
            return emit_spot(light, across);
        }
        //#end
        default: {
            let ray = Ray(light.position, 0.0, vec3f(0.0, 0.0, 1.0), FAR);
            return unguided(ray, vec3f(0.0));
        }
    }
}
