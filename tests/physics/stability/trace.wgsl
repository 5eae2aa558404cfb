// Rays against the scene, in place of eye paths. A visible point brings origin (position), t_min
// (radius), direction (weight) and t_max (alpha) of a ray, and takes the hit back: t (radius),
// reference (normal), u, v and the error bound (radiance), position, and the surface's normal
// (weight).

@compute @workgroup_size(64)
fn eye_trace(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    let given = visible_points[id];
    let ray = Ray(given.position, given.radius, given.weight, given.alpha);
    let hit = intersect_scene(ray);
    var found = VisiblePoint();
    found.radius = hit.t;
    found.normal = hit.reference;
    if hit.reference != NONE {
        let s = surface_at(ray, hit);
        found.position = s.position;
        found.weight = s.normal;
        found.radiance = vec3f(hit.u, hit.v, s.error);
    }
    if loops_stopped() {
        found.state |= STOPPED;
    }
    visible_points[id] = found;
}
