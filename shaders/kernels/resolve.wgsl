// One pixel's estimate of the pass into the film: twin of src/kernels/resolve.rs. Run by one invocation per pixel of a
// chunk; reads `visible_points` and `gathered`, updates `film` (and `statistics` under the local rule).

const DROP_SHARE: f32 = 1.0 / 4096.0;

@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    var sum = vec3f(0.0);
    for (var k = 0u; k < dispatch.eye_samples; k++) {
        let at = id * dispatch.eye_samples + k;
        //#if local
        let scale = local_scale_sq(statistics[at]);
        sum += pass_radiance(at, scale);
        statistics[at] = updated_statistics(statistics[at], gathered[at].count);
        //#else
        sum += pass_radiance(at, dispatch.scale_sq);
        //#end
    }
    fold(id, sum * (1.0 / f32(dispatch.eye_samples)));
}

fn fold(id: u32, value: vec3f) {
    if !is_finite(value) {
        film[id].rejected += 1u;
        return;
    }
    let n = f32(dispatch.passes_done + 1u - film[id].rejected);
    film[id].mean += (value - film[id].mean) * (1.0 / n);
}

fn pass_radiance(at: u32, scale_sq: f32) -> vec3f {
    let radiance = visible_points[at].radiance;
    if gathered[at].count == 0u {
        return radiance;
    }
    let radius = visible_points[at].radius;
    let radius_sq = radius * radius * scale_sq;
    return radiance + gathered[at].flux * (1.0 / (dispatch.photons * (PI * radius_sq)));
}

//#if local
fn updated_statistics(before: Statistics, m: u32) -> Statistics {
    var s = before;
    if s.scale_sq == 0.0 {
        s.scale_sq = 1.0;
    }
    if m == 0u {
        return s;
    }
    let t = f32(s.count_high) * 4294967296.0 + f32(s.count_low);
    let scale_sq = s.scale_sq - s.drop;
    s.drop += scale_sq * ((1.0 - dispatch.alpha) * f32(m) / (dispatch.alpha * t + f32(m)));
    if s.drop > DROP_SHARE * s.scale_sq {
        s.scale_sq -= s.drop;
        s.drop = 0.0;
    }
    let low = s.count_low + m;
    if low < m {
        s.count_high += 1u;
    }
    s.count_low = low;
    return s;
}
//#end

fn is_finite(v: vec3f) -> bool {
    let mask = vec3u(0x7f800000u);
    return all((bitcast<vec3u>(v) & mask) != mask);
}
