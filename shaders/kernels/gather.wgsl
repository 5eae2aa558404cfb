// Density estimate at one visible point: twin of src/kernels/gather.rs. Run by one invocation per visible point of a
// chunk and photon batch; reads `visible_points`, `starts`, `sorted` (and `statistics` under the local rule), adds to
// `gathered` and, where the driver stopped it, to `counters`.

const FLATNESS: f32 = 0.25;
const COS_MIN: f32 = 1e-2;
const BLOCK: u32 = 1024u;

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    let point = visible_points[id];
    if point.radius <= 0.0 {
        return;
    }
    //#if local
    let radius_sq = point.radius * point.radius * local_scale_sq(statistics[id]);
    //#else
    let radius_sq = point.radius * point.radius * dispatch.scale_sq;
    //#end
    let radius = sqrt(radius_sq);
    let ng = oct_decode(point.normal);
    let flat_normal = point.normal == point.shading;
    let n = oct_decode(point.shading);
    let low = grid_cell(point.position - vec3f(radius), dispatch.inv_cell);
    let high = grid_cell(point.position + vec3f(radius), dispatch.inv_cell);
    var found = gathered[id];
    for (var z = low.z; z <= high.z; z++) {
        for (var y = low.y; y <= high.y; y++) {
            for (var x = low.x; x <= high.x; x++) {
                let cell = vec3i(x, y, z);
                let bucket = grid_bucket(cell, dispatch.mask);
                let end = starts[bucket + 1u];
                for (var first = starts[bucket]; first < end; first += BLOCK) {
                    var block = vec3f(0.0);
                    for (var i = first; i < min(first + BLOCK, end); i++) {
                        let record = sorted[i];
                        let d = record.position - point.position;
                        if dot(d, d) > radius_sq
                            || abs(dot(d, ng)) > FLATNESS * radius
                            || any(grid_cell(record.position, dispatch.inv_cell) != cell)
                        {
                            continue;
                        }
                        let wi = oct_decode(record.direction);
                        let cos_g = dot(wi, ng);
                        if cos_g <= 0.0 {
                            continue;
                        }
                        found.count += 1u;
                        var is_metal = false;
                        //#if metal
                        if point.alpha > 0.0 {
                            is_metal = true;
                            let f = eval_rough(MATERIAL_METAL, point.alpha, point.reflectance, n, point.wo, wi);
                            block += point.weight * f * record.flux * (1.0 / max(cos_g, COS_MIN));
                        }
                        //#end
                        if !is_metal && flat_normal {
                            block += point.weight * record.flux;
                        } else if !is_metal {
                            let ratio = max(dot(wi, n), 0.0) / max(cos_g, COS_MIN);
                            block += point.weight * record.flux * ratio;
                        }
                    }
                    found.flux += block;
                }
            }
        }
    }
    gathered[id] = found;
    loops_stopped();
}
