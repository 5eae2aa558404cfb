// Steps of an eye path, shared by eye tracing and AOVs. Twin: src/kernels/eye_path.rs.

struct EyePath {
    ray: Ray,
    throughput: vec3f,
    interior: Interior,
    hidden: u32,
    bounce: u32,
    length: f32,
    rays: u32,
}

fn eye_path(ray: Ray) -> EyePath {
    let interior = interior_at(scene.camera.medium, ray.origin);
    return EyePath(ray, vec3f(1.0), interior, 0u, 0u, 0.0, 0u);
}

fn continues(path: EyePath) -> bool {
    return path.bounce <= dispatch.max_bounces && path.hidden <= HIDDEN_FACES;
}

fn environment(path: EyePath) -> vec3f {
    var radiance = vec3f(0.0);
    //#if environment
    if scene.world.environment != NONE {
        let light = scene.lights[scene.world.environment];
        radiance = path.throughput * eval_environment(light, path.ray.direction);
    }
    //#end
    //#if sun_disc
    radiance += path.throughput * eval_sun_discs(path.ray.direction);
    //#end
    return radiance;
}

fn arrive(path: ptr<function, EyePath>, s: Surface, t: f32) {
    (*path).length += t;
    (*path).interior = interior_before(s, -(*path).ray.direction, (*path).interior);
    (*path).throughput *= transmittance(medium_of((*path).interior), t);
}

fn emission(path: EyePath, s: Surface) -> vec3f {
    //#if area
    if s.light != NONE {
        return path.throughput * eval_area(s, path.ray.direction);
    }
    //#end
    return vec3f(0.0);
}

//#if unseen
fn passes_unseen(path: ptr<function, EyePath>, hit: Hit) -> bool {
    if (*path).bounce > 0u {
        return false;
    }
    let s = surface_at((*path).ray, hit);
    if s.light == NONE || (scene.lights[s.light].flags & LIGHT_UNSEEN) == 0u {
        return false;
    }
    // the ray goes on from the same origin, so that lengths count from there
    (*path).ray.t_min = hit.t;
    (*path).hidden += 1u;
    return true;
}
//#end

//#if nested
fn passes(path: ptr<function, EyePath>, s: Surface) -> bool {
    var ray = (*path).ray;
    var interior = (*path).interior;
    if !passes_hidden(s, &ray, &interior) {
        return false;
    }
    (*path).ray = ray;
    (*path).interior = interior;
    (*path).hidden += 1u;
    return true;
}
//#end

//#if specular
fn scatter(path: ptr<function, EyePath>, s: Surface, scattered: Scatter, u: f32) -> bool {
    (*path).throughput *= scattered.weight;
    (*path).interior = scattered.interior;
    let survival = min(4.0 * max_component((*path).throughput), 1.0);
    if u >= survival {
        return false;
    }
    (*path).throughput *= 1.0 / survival;
    let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
    (*path).ray = Ray(origin, 0.0, scattered.direction, FAR);
    (*path).bounce += 1u;
    return true;
}
//#end
