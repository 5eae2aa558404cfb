// Adds one pass's photon estimate of a pixel, split into its caustic and indirect parts, to the
// layer. Run by one invocation per pixel of a chunk, before `resolve`; reads `visible_points` and
// `gathered` (and `statistics` under the local rule), updates `parts`. Twin:
// src/kernels/resolve_parts.rs.

struct PartsPixel {
    caustic: vec3f,
    passes: f32,
    indirect: vec3f,
    pad: u32,
}

@compute @workgroup_size(64)
fn resolve_parts(
    @builtin(global_invocation_id) gid: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    var caustic = vec3f(0.0);
    var indirect = vec3f(0.0);
    var state = 0u;
    for (var k = 0u; k < dispatch.eye_samples; k++) {
        let at = id * dispatch.eye_samples + k;
        state |= visible_points[at].state;
        if gathered[at].count > 0u {
            //#if local
            let scale = local_scale_sq(statistics[at]);
            //#else
            let scale = dispatch.scale_sq;
            //#end
            let area = PI * visible_points[at].radius * visible_points[at].radius * scale;
            let share = 1.0 / (dispatch.photons * area);
            caustic += gathered[at].caustic * share;
            indirect += (gathered[at].flux - gathered[at].caustic) * share;
        }
    }
    // as in `resolve`, a pass that is not finite is rejected
    if (state & (BAD_EYE | BAD_DIRECT)) != 0u || !is_finite(caustic) || !is_finite(indirect) {
        return;
    }
    var pixel = parts[id];
    pixel.passes += 1.0;
    let samples = 1.0 / f32(dispatch.eye_samples);
    let share = 1.0 / pixel.passes;
    pixel.caustic += (caustic * samples - pixel.caustic) * share;
    pixel.indirect += (indirect * samples - pixel.indirect) * share;
    parts[id] = pixel;
}
