// Eye path of one visible point: twin of src/kernels/eye_trace.rs. Run by one invocation per
// visible point of a chunk; reads the scene, writes `visible_points`, adds to `counters`.

@compute @workgroup_size(64)
fn eye_trace(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    let camera = scene.camera;
    let place = (dispatch.chunk_first + id) / dispatch.eye_samples;
    let k = dispatch.chunk_first + id - place * dispatch.eye_samples;
    let pixel = window_pixel(camera, place);
    var rng = rng_eye(pixel * dispatch.eye_samples + k, dispatch.pass_number, dispatch.seed);
    let u = stratified(rng_next(&rng), k, pixel);
    var ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, u);
    var throughput = vec3f(1.0);
    var interior = interior_at(camera.medium, ray.origin);
    var hidden = 0u;
    var bounce = 0u;
    var length = 0.0;
    var rays = 0u;
    var point = VisiblePoint();
    while bounce <= dispatch.max_bounces && hidden <= HIDDEN_FACES {
        rays += 1u;
        let hit = intersect_scene(ray);
        if hit.reference == NONE {
            //#if environment
            if scene.world.environment != NONE {
                let light = scene.lights[scene.world.environment];
                point.radiance += throughput * eval_environment(light, ray.direction);
            }
            //#end
            break;
        }
        let s = surface_at(ray, hit);
        let wo = -ray.direction;
        length += hit.t;
        interior = interior_before(s, wo, interior);
        throughput *= transmittance(medium_of(interior), hit.t);
        //#if area
        if s.light != NONE && dot(wo, s.normal) > 0.0 {
            point.radiance += throughput * scene.lights[s.light].color;
        }
        //#end
        //#if nested
        if passes_hidden(s, &ray, &interior) {
            hidden += 1u;
            continue;
        }
        //#end
        let kind = scene.materials[s.material].kind;
        if !is_specular(kind) {
            let reflectance = reflectance_at(s.material, s.uv);
            if max_component(reflectance) <= 0.0 {
                break;
            }
            let ng = toward(s.normal, wo);
            let n = shading_normal(s, wo);
            point.position = s.position;
            point.facet = s.facet;
            point.radius = start_radius(camera.pixel * length);
            point.normal = oct_encode(ng);
            point.shading = oct_encode(n);
            point.weight = throughput * INV_PI * reflectance;
            //#if metal
            if kind == MATERIAL_METAL {
                point.weight = throughput;
                point.reflectance = reflectance;
                point.alpha = scene.materials[s.material].alpha;
                point.wo = oct_encode(wo);
            }
            //#end
            //#if sampled
            let found = direct_light(s, wo, n, ng, reflectance, interior, &rng);
            let direct = throughput * found.radiance;
            rays += found.rays;
            if is_finite(direct) {
                point.radiance += direct;
            } else {
                point.state |= BAD_DIRECT;
            }
            //#end
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
    if !is_finite(point.radiance) {
        point.radiance = vec3f(0.0);
        point.state |= BAD_EYE;
    }
    if loops_stopped() {
        point.state |= STOPPED;
    } else {
        count_rays(rays);
    }
    visible_points[id] = point;
}
