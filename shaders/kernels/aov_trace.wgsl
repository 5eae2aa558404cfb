// AOVs of a pixel, from the same eye path as a visible point: values at the first hit, at the first
// hit beyond mirrors and glass, and along the whole path. Run by one invocation per pixel of a chunk
// for one of its samples; reads the scene, updates `aovs`, adds to `counters`. Twin: src/kernels/aov_trace.rs.

struct AovPixel {
    albedo: vec3f,
    depth: f32,
    normal: vec3f,
    hits: f32,
    position: vec3f,
    points: f32,
    emission: vec3f,
    radius: f32,
    direct: vec3f,
    reference: u32,
    material: u32,
    state: u32,
    pad0: u32,
    pad1: u32,
}

@compute @workgroup_size(64)
fn aov_trace(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    let camera = scene.camera;
    let pixel = window_pixel(camera, dispatch.chunk_first / dispatch.eye_samples + id);
    let x = pixel % camera.width;
    let y = pixel / camera.width;
    var next = aovs[id];
    // shape and material at the pixel's centre, once
    if dispatch.passes_done == 0u {
        let ray = camera_ray(camera, x, y, vec4f(0.5));
        let hit = intersect_scene(ray);
        next.reference = hit.reference;
        next.material = NONE;
        if hit.reference != NONE {
            next.material = surface_at(ray, hit).material;
        }
    }
    // follow the same path as `eye_trace`
    let k = dispatch.passes_done % dispatch.eye_samples;
    var rng = rng_eye(pixel * dispatch.eye_samples + k, dispatch.pass_number, dispatch.seed);
    let u = stratified(rng_next(&rng), k, pixel);
    //#if filter
    var path = eye_path(camera_ray(camera, x, y, filtered(camera, u)));
    //#else
    var path = eye_path(camera_ray(camera, x, y, u));
    //#end
    //#if continued
    var last = LastLobe(0.0, 0u);
    //#end
    var featured = false;
    var albedo = vec3f(0.0);
    var normal = vec3f(0.0);
    var emitted = vec3f(0.0);
    var direct = vec3f(0.0);
    while continues(path) {
        let hit = intersect_scene(path.ray);
        if hit.reference == NONE {
            //#if continued
            let found = found_environment(path, last);
            emitted += select(found, vec3f(0.0), last.pdf > 0.0);
            direct += select(vec3f(0.0), found, last.pdf > 0.0);
            //#else
            emitted += environment(path);
            //#end
            break;
        }
        let first = path.bounce == 0u && path.hidden == 0u;
        let ray = path.ray;
        let s = surface_at(ray, hit);
        arrive(&path, s, hit.t);
        if first {
            next.hits += 1.0;
            let share = 1.0 / next.hits;
            var depth = dot(s.position - camera.position, camera.forward);
            //#if projection
            if sees_around(camera) {
                depth = hit.t;
            }
            //#end
            next.depth += (depth - next.depth) * share;
            next.position += (s.position - next.position) * share;
        }
        //#if continued
        let seen = found_emission(path, last, ray, s, hit.t);
        emitted += select(seen, vec3f(0.0), last.pdf > 0.0);
        direct += select(vec3f(0.0), seen, last.pdf > 0.0);
        //#else
        emitted += emission(path, s);
        //#end
        //#if nested
        if passes(&path, s) {
            //#if continued
            last.pdf = 0.0;
            //#end
            continue;
        }
        //#end
        var p = shading_point(hit, s, -path.ray.direction, path.interior);
        //#if layered
        if is_layered(p.lobe.bsdf) {
            let u = rng_next(&rng);
            path.throughput *= choose_layer(hit, &p, u.x);
        }
        //#end
        if !featured && !is_specular(p.lobe.bsdf) {
            albedo = path.throughput * p.lobe.reflectance;
            normal = p.n;
            featured = true;
        }
        // as in `eye_trace`, with the same random numbers
        var only_focused = false;
        //#if continued
        if turns_at(path, p.lobe) {
            //#if sampled
            let v = rng_next(&rng);
            //#if direct_layer
            direct += path.throughput * next_event(p, path.interior, true, v).radiance;
            //#end
            //#end
            let way = turn(&path, p, &last, rng_next(&rng));
            if way == CONTINUES {
                continue;
            }
            if way == ENDS {
                break;
            }
            only_focused = true;
        }
        //#end
        if !is_specular(p.lobe.bsdf) {
            if max_component(p.lobe.reflectance) > 0.0 {
                next.points += 1.0;
                let radius = start_radius(footprint(camera, path.length));
                next.radius += (radius - next.radius) * (1.0 / next.points);
                //#if sampled && direct_layer
                if !only_focused {
                    let found = direct_light(p, path.interior, &rng);
                    direct += path.throughput * found.radiance;
                }
                //#end
            }
            break;
        }
        //#if specular
        if path.bounce == dispatch.max_bounces {
            break;
        }
        //#if continued
        last.pdf = 0.0;
        //#end
        let v = rng_next(&rng);
        let scattered = scatter_specular(p, path.interior, v.x, RADIANCE);
        if !scatter(&path, s, scattered, v.y) {
            break;
        }
        //#end
    }
    if !is_finite(emitted) {
        emitted = vec3f(0.0);
    }
    if !is_finite(albedo) {
        albedo = vec3f(0.0);
    }
    if !is_finite(direct) {
        direct = vec3f(0.0);
    }
    if loops_stopped() {
        aovs[id].state |= STOPPED;
        return;
    }
    //#if signed_filter
    // parts of the image have its weights
    let weight = signed_weight(camera, u, pixel);
    emitted *= weight;
    direct *= weight;
    //#end
    // add to the running means
    let share = 1.0 / f32(dispatch.passes_done + 1u);
    next.albedo += (albedo - next.albedo) * share;
    next.normal += (normal - next.normal) * share;
    next.emission += (emitted - next.emission) * share;
    next.direct += (direct - next.direct) * share;
    aovs[id] = next;
}
