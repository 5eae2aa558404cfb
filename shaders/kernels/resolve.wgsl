// One pixel's estimate of the pass into the film: twin of src/kernels/resolve.rs. Run by one invocation per pixel of a
// chunk; reads `visible_points` and `gathered`, updates `film` (and `statistics` under the local rule).

const DROP_SHARE: f32 = 1.0 / 256.0;
const CARRY_SHARE: f32 = 1.0 / 256.0;

@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    var sum = vec3f(0.0);
    var state = 0u;
    var photons_finite = true;
    for (var k = 0u; k < dispatch.eye_samples; k++) {
        let at = id * dispatch.eye_samples + k;
        state |= visible_points[at].state;
        photons_finite &= is_finite(gathered[at].flux);
        //#if local
        let scale = local_scale_sq(statistics[at]);
        sum += pass_radiance(at, scale);
        statistics[at] = updated_statistics(statistics[at], gathered[at].count);
        //#else
        sum += pass_radiance(at, dispatch.scale_sq);
        //#end
    }
    fold(id, cause(state, photons_finite), sum * (1.0 / f32(dispatch.eye_samples)));
}

fn cause(state: u32, photons_finite: bool) -> u32 {
    if (state & BAD_EYE) != 0u {
        return REJECTED_EYE;
    }
    if (state & BAD_DIRECT) != 0u {
        return REJECTED_DIRECT;
    }
    return select(REJECTED_PHOTONS, ACCEPTED, photons_finite);
}

fn fold(id: u32, cause: u32, value: vec3f) {
    let found = select(cause, REJECTED_ESTIMATE, cause == ACCEPTED && !is_finite(value));
    if found != ACCEPTED {
        film[id].rejected[found] += 1u;
        return;
    }
    let r = film[id].rejected;
    let n = f32(dispatch.passes_done + 1u - (r.x + r.y + r.z + r.w));
    var pixel = film[id];
    pixel.carry += (value - (pixel.mean + pixel.carry)) * (1.0 / n);
    if max_abs(pixel.carry) > CARRY_SHARE * max_abs(pixel.mean) {
        pixel.mean += pixel.carry;
        pixel.carry = vec3f(0.0);
    }
    film[id] = pixel;
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
