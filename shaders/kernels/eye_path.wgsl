// Steps of an eye path, shared by eye tracing and AOVs. Twin: src/kernels/eye_path.rs.

const NO_RAY: u32 = 0xffffffffu;

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
    var bounce = 0u;
    //#if projection
    if ray.t_max == 0.0 {
        bounce = NO_RAY;
    }
    //#end
    return EyePath(ray, vec3f(1.0), interior, 0u, bounce, 0.0, 0u);
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
    if s.light != NONE && dot(-path.ray.direction, s.normal) > 0.0 {
        return path.throughput * scene.lights[s.light].color;
    }
    //#end
    return vec3f(0.0);
}

//#if continued
const CONTINUES: u32 = 0u;
const GATHERS_FOCUSED: u32 = 1u;
const ENDS: u32 = 2u;
const CONTINUING: f32 = 0.75;

struct LastLobe {
    pdf: f32,
    shares: u32,
}

fn found_environment(path: EyePath, last: LastLobe) -> vec3f {
    //#if sampled
    if last.pdf > 0.0 {
        var radiance = vec3f(0.0);
        let direction = path.ray.direction;
        //#if environment
        if scene.world.environment != NONE {
            let sky = scene.world.environment;
            let light = scene.lights[sky];
            let other = pdf_environment(light, direction) * share_of(last.shares, sky);
            let seen = path.throughput * eval_environment(light, direction);
            radiance = seen * balance(last.pdf, other);
        }
        //#end
        //#if sun_disc
        var sun = scene.world.sun_discs;
        while sun != NONE {
            let light = scene.lights[sun];
            if in_sun_disc(light, direction) {
                let other = pdf_sun_disc(light) * share_of(last.shares, sun);
                radiance += path.throughput * light.color * balance(last.pdf, other);
            }
            sun = light.reference;
        }
        //#end
        return radiance;
    }
    //#end
    return environment(path);
}

fn found_emission(path: EyePath, last: LastLobe, ray: Ray, s: Surface, t: f32) -> vec3f {
    //#if sampled && area
    if last.pdf > 0.0 && s.light != NONE {
        let other = pdf_area(
            last.shares, s.light, ray.origin, ray.direction, t, s.normal, s.v
        );
        return emission(path, s) * balance(last.pdf, other);
    }
    //#end
    return emission(path, s);
}
//#end

//#if continued
fn turns_at(path: EyePath, lobe: Lobe) -> bool {
    return path.bounce < dispatch.max_bounces && is_narrow(lobe);
}

fn turn(
    path: ptr<function, EyePath>,
    p: ShadingPoint,
    last: ptr<function, LastLobe>,
    u: vec4f,
) -> u32 {
    let gathers = (dispatch.continued & FOCUSED) != 0u;
    if gathers && u.z >= CONTINUING {
        (*path).throughput *= 1.0 / (1.0 - CONTINUING);
        return GATHERS_FOCUSED;
    }
    var choice = u.z;
    if gathers {
        (*path).throughput *= 1.0 / CONTINUING;
        choice *= 1.0 / CONTINUING;
    }
    let v = vec3f(u.x, u.y, choice);
    let scattered = scatter_rough(p, (*path).interior, v, RADIANCE);
    //#if sampled
    (*last).shares = shares_at(p.s.position);
    (*last).pdf = pdf_rough(p.lobe, p.n, p.wo, scattered.direction);
    //#end
    return select(ENDS, CONTINUES, scatter(path, p.s, scattered, u.w));
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

//#if specular || continued
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
