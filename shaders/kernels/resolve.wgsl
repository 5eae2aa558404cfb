// Adds one pass's estimate of a pixel to the film and updates the local rule's statistics. Run by
// one invocation per pixel of a chunk; reads `visible_points` and `gathered`, updates `film` (and
// `statistics` under the local rule). Twin: src/kernels/resolve.rs.

const DROP_SHARE: f32 = 1.0 / 256.0;
const CARRY_SHARE: f32 = 1.0 / 256.0;

@compute @workgroup_size(64)
fn resolve(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    // sum the estimates of the pixel's samples
    var sum = Estimate(vec3f(0.0), 0.0, 0.0);
    var state = 0u;
    var photons_finite = true;
    for (var k = 0u; k < dispatch.eye_samples; k++) {
        let at = id * dispatch.eye_samples + k;
        state |= visible_points[at].state;
        photons_finite &= is_finite(gathered[at].flux);
        //#if local
        let scale = local_scale_sq(statistics[at]);
        statistics[at] = updated_statistics(statistics[at], gathered[at].count);
        //#else
        let scale = dispatch.scale_sq;
        //#end
        let found = pass_found(at, scale);
        sum.radiance += found.radiance;
        sum.bias_probe += found.bias_probe;
        sum.halves += half_weight(k) * luminance(found.radiance);
    }
    let share = 1.0 / f32(dispatch.eye_samples);
    fold(
        id,
        cause(state, photons_finite),
        Estimate(sum.radiance * share, sum.bias_probe * share, sum.halves),
    );
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

fn fold(id: u32, cause: u32, found: Estimate) {
    let value = found.radiance;
    let counted = select(cause, REJECTED_ESTIMATE, cause == ACCEPTED && !is_finite(value));
    if counted != ACCEPTED {
        film[id].rejected[counted] += 1u;
        return;
    }
    // number of accepted passes; record the mean when it is a power of two
    let r = film[id].rejected;
    let before = dispatch.passes_done - (r.x + r.y + r.z + r.w);
    var pixel = film[id];
    if (before & (before - 1u)) == 0u {
        pixel.mean_at_half_pow2 = pixel.mean_at_pow2;
        pixel.mean_at_pow2 = luminance(pixel.mean + pixel.carry);
    }
    // running means; the mean itself is updated through `carry`, so that rounding does not lose
    // small changes
    let n = f32(before + 1u);
    let share = 1.0 / n;
    let delta = value - (pixel.mean + pixel.carry);
    let deviation = luminance(delta) * sqrt((n - 1.0) * share);
    let sign = select(-1.0, 1.0, (dispatch.passes_done & 1u) == 0u);
    pixel.spread += (deviation * deviation - pixel.spread) * share;
    pixel.bias_probe += (found.bias_probe - pixel.bias_probe) * share;
    pixel.bias_probe_alternating +=
        (sign * found.bias_probe - pixel.bias_probe_alternating) * share;
    pixel.halves += (found.halves - pixel.halves) * share;
    pixel.carry += delta * share;
    if max_abs(pixel.carry) > CARRY_SHARE * max_abs(pixel.mean) {
        pixel.mean += pixel.carry;
        pixel.carry = vec3f(0.0);
    }
    film[id] = pixel;
}

struct Estimate {
    radiance: vec3f,
    bias_probe: f32,
    halves: f32,
}

fn pass_found(at: u32, scale_sq: f32) -> Estimate {
    let radiance = visible_points[at].radiance;
    if gathered[at].count == 0u {
        return Estimate(radiance, 0.0, 0.0);
    }
    let radius = visible_points[at].radius;
    let radius_sq = radius * radius * scale_sq;
    let share = 1.0 / (dispatch.photons * (PI * radius_sq));
    return Estimate(radiance + gathered[at].flux * share, gathered[at].bias_probe * share, 0.0);
}

fn half_weight(k: u32) -> f32 {
    if dispatch.eye_samples == 1u {
        return 0.0;
    }
    // with an odd number of strata the first colour has one more; with an even number of columns
    // both have the same number
    let first = f32((dispatch.eye_samples + 1u) / 2u);
    let second = f32(dispatch.eye_samples / 2u);
    let row = k / dispatch.strata;
    let odd = (k - row * dispatch.strata + row) & 1u;
    let ratio = select(first / second, second / first, odd == 0u);
    let size = sqrt(ratio) / (first + second);
    return select(-size, size, odd == 0u);
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
    // accumulate the small decreases in `drop`, so that rounding does not lose them
    s.drop += scale_sq * ((1.0 - dispatch.alpha) * f32(m) / (dispatch.alpha * t + f32(m)));
    if s.drop > DROP_SHARE * s.scale_sq {
        s.scale_sq -= s.drop;
        s.drop = 0.0;
    }
    // 64-bit count in two words
    let low = s.count_low + m;
    if low < m {
        s.count_high += 1u;
    }
    s.count_low = low;
    return s;
}
//#end
