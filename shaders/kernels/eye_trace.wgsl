// Eye path of one visible point: samples pixel and lens, follows mirrors and glass to the first
// non-specular hit. Run by one invocation per visible point of a chunk; reads the scene, writes
// `visible_points`, adds to `counters`. Twin: src/kernels/eye_trace.rs.

@compute @workgroup_size(64)
fn eye_trace(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    // sample the pixel and the lens
    let camera = scene.camera;
    let place = (dispatch.chunk_first + id) / dispatch.eye_samples;
    let k = dispatch.chunk_first + id - place * dispatch.eye_samples;
    let pixel = window_pixel(camera, place);
    var rng = rng_eye(pixel * dispatch.eye_samples + k, dispatch.pass_number, dispatch.seed);
    let u = stratified(rng_next(&rng), k, pixel);
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, u);
    var path = eye_path(ray);
    var point = VisiblePoint();
    while continues(path) {
        path.rays += 1u;
        let hit = intersect_scene(path.ray);
        if hit.reference == NONE {
            point.radiance += environment(path);
            break;
        }
        //#if unseen
        if passes_unseen(&path, hit) {
            continue;
        }
        //#end
        let s = surface_at(path.ray, hit);
        arrive(&path, s, hit.t);
        point.radiance += emission(path, s);
        //#if nested
        if passes(&path, s) {
            continue;
        }
        //#end
        let p = shading_point(s, -path.ray.direction);
        // store the visible point at the first non-specular hit
        if !is_specular(p.lobe.bsdf) {
            if max_component(p.lobe.reflectance) <= 0.0 {
                break;
            }
            point.position = s.position;
            point.outline = s.outline;
            point.radius = start_radius(camera.pixel * path.length);
            point.normal = oct_encode(p.ng);
            point.shading = oct_encode(p.n);
            point.bsdf = p.lobe.bsdf;
            point.weight = path.throughput * INV_PI * p.lobe.reflectance;
            //#if lobes
            if p.lobe.bsdf != MATERIAL_DIFFUSE {
                point.weight = path.throughput;
                point.reflectance = p.lobe.reflectance;
                point.alpha = p.lobe.alpha;
                point.wo = oct_encode(p.wo);
            }
            //#end
            //#if sampled
            let found = direct_light(p, path.interior, &rng);
            let direct = path.throughput * found.radiance;
            path.rays += found.rays;
            if is_finite(direct) {
                point.radiance += direct;
            } else {
                point.state |= BAD_DIRECT;
            }
            //#end
            break;
        }
        //#if specular
        // scatter at mirrors and glass
        if path.bounce == dispatch.max_bounces {
            break;
        }
        let v = rng_next(&rng);
        let scattered = scatter_specular(p, path.interior, v.x, RADIANCE);
        if !scatter(&path, s, scattered, v.y) {
            break;
        }
        //#end
    }
    if !is_finite(point.radiance) {
        point.radiance = vec3f(0.0);
        point.state |= BAD_EYE;
    }
    if loops_stopped() {
        point.state |= STOPPED;
    } else {
        count_rays(path.rays);
    }
    visible_points[id] = point;
}
