// Eye path of one visible point: samples pixel and lens, follows mirrors, glass and narrow lobes to
// the first wide one. Run by one invocation per visible point of a chunk; reads the scene, writes
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
    //#if filter
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, filtered(camera, u));
    //#else
    let ray = camera_ray(camera, pixel % camera.width, pixel / camera.width, u);
    //#end
    var path = eye_path(ray);
    //#if continued
    var last = LastLobe(0.0, 0u);
    //#end
    var point = VisiblePoint();
    while continues(path) {
        path.rays += 1u;
        let hit = intersect_scene(path.ray);
        if hit.reference == NONE {
            //#if continued
            point.radiance += found_environment(path, last);
            //#else
            point.radiance += environment(path);
            //#end
            break;
        }
        let ray = path.ray;
        let s = surface_at(ray, hit);
        arrive(&path, s, hit.t);
        //#if continued
        point.radiance += found_emission(path, last, ray, s, hit.t);
        //#else
        point.radiance += emission(path, s);
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
        var only_focused = false;
        //#if continued
        // continue at a narrow lobe, or gather there the photons that a continued path cannot find
        if turns_at(path, p.lobe) {
            //#if sampled
            let found = next_event(p, path.interior, true, rng_next(&rng));
            add_direct(&point, path.throughput * found.radiance);
            path.rays += found.rays;
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
        // store the visible point at the first wide hit
        if !is_specular(p.lobe.bsdf) {
            if max_component(p.lobe.reflectance) <= 0.0 {
                break;
            }
            point.position = s.position;
            point.outline = s.outline;
            point.radius = start_radius(footprint(camera, path.length));
            point.normal = oct_encode(p.ng);
            point.shading = oct_encode(p.n);
            point.bsdf = p.lobe.bsdf;
            //#if lobe_parameters
            if reads_table(p.lobe) {
                point.bsdf |= p.lobe.material << BSDF_BITS;
            }
            //#end
            point.weight = path.throughput * INV_PI * p.lobe.reflectance;
            //#if lobes
            if p.lobe.bsdf != MATERIAL_DIFFUSE {
                point.weight = path.throughput;
                point.reflectance = p.lobe.reflectance;
                point.alpha = p.lobe.alpha;
                point.wo = oct_encode(p.wo);
            }
            //#end
            if only_focused {
                point.state |= ONLY_FOCUSED;
            }
            //#if sampled
            if !only_focused {
                let found = direct_light(p, path.interior, &rng);
                add_direct(&point, path.throughput * found.radiance);
                path.rays += found.rays;
            }
            //#end
            break;
        }
        //#if specular
        // scatter at mirrors and glass
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
    //#if signed_filter
    let weight = signed_weight(camera, u, pixel);
    point.radiance *= weight;
    point.weight *= weight;
    //#end
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

//#if sampled
fn add_direct(point: ptr<function, VisiblePoint>, direct: vec3f) {
    if is_finite(direct) {
        (*point).radiance += direct;
    } else {
        (*point).state |= BAD_DIRECT;
    }
}
//#end
