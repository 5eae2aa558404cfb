// What a pixel shows beside radiance: twin of src/kernels/aov_trace.rs. Run by one invocation per
// pixel of a chunk for one of its samples; reads the scene, updates `aovs`, adds to `counters`.

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
    if dispatch.passes_done == 0u {
        let ray = camera_ray(camera, x, y, vec4f(0.5));
        let hit = intersect_scene(ray);
        next.reference = hit.reference;
        next.material = NONE;
        if hit.reference != NONE {
            next.material = surface_at(ray, hit).material;
        }
    }
    let k = dispatch.passes_done % dispatch.eye_samples;
    var rng = rng_eye(pixel * dispatch.eye_samples + k, dispatch.pass_number, dispatch.seed);
    var ray = camera_ray(camera, x, y, stratified(rng_next(&rng), k, pixel));
    var throughput = vec3f(1.0);
    var interior = interior_at(camera.medium, ray.origin);
    var hidden = 0u;
    var bounce = 0u;
    var length = 0.0;
    var albedo = vec3f(0.0);
    var normal = vec3f(0.0);
    var emission = vec3f(0.0);
    var direct = vec3f(0.0);
    while bounce <= dispatch.max_bounces && hidden <= HIDDEN_FACES {
        let hit = intersect_scene(ray);
        if hit.reference == NONE {
            //#if environment
            if scene.world.environment != NONE {
                let light = scene.lights[scene.world.environment];
                emission += throughput * eval_environment(light, ray.direction);
            }
            //#end
            break;
        }
        let s = surface_at(ray, hit);
        let wo = -ray.direction;
        length += hit.t;
        if bounce == 0u && hidden == 0u {
            next.hits += 1.0;
            let share = 1.0 / next.hits;
            next.depth += (dot(s.position - camera.position, camera.forward) - next.depth) * share;
            next.position += (s.position - next.position) * share;
        }
        interior = interior_before(s, wo, interior);
        throughput *= transmittance(medium_of(interior), hit.t);
        //#if area
        if s.light != NONE && dot(wo, s.normal) > 0.0 {
            emission += throughput * scene.lights[s.light].color;
        }
        //#end
        //#if nested
        if passes_hidden(s, &ray, &interior) {
            hidden += 1u;
            continue;
        }
        //#end
        if !is_specular(scene.materials[s.material].kind) {
            let reflectance = reflectance_at(s.material, s.uv);
            albedo = throughput * reflectance;
            normal = shading_normal(s, wo);
            if max_component(reflectance) > 0.0 {
                next.points += 1.0;
                next.radius += (start_radius(camera.pixel * length) - next.radius) * (1.0 / next.points);
                //#if sampled && direct_layer
                let ng = toward(s.normal, wo);
                let found = direct_light(s, wo, normal, ng, reflectance, interior, &rng);
                direct = throughput * found.radiance;
                //#end
            }
            break;
        }
        //#if specular
        if bounce == dispatch.max_bounces {
            break;
        }
        let v = rng_next(&rng);
        let scattered = scatter_specular(s, wo, interior, v.x, RADIANCE);
        throughput *= scattered.weight;
        interior = scattered.interior;
        let survival = min(4.0 * max_component(throughput), 1.0);
        if v.y >= survival {
            break;
        }
        throughput *= 1.0 / survival;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray(origin, 0.0, scattered.direction, FAR);
        bounce += 1u;
        //#end
    }
    if !is_finite(emission) {
        emission = vec3f(0.0);
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
    let share = 1.0 / f32(dispatch.passes_done + 1u);
    next.albedo += (albedo - next.albedo) * share;
    next.normal += (normal - next.normal) * share;
    next.emission += (emission - next.emission) * share;
    next.direct += (direct - next.direct) * share;
    aovs[id] = next;
}
