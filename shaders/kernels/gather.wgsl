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
    let inner_sq = 0.5 * radius_sq;
    let tint = point.weight * LUMINANCE;
    var count = 0u;
    var ring = gathered[id].ring;
    var sum = vec3f(0.0);
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
                        let distance_sq = dot(d, d);
                        if distance_sq > radius_sq
                            || abs(dot(d, ng)) > FLATNESS * radius
                            || any(grid_cell(record.position, dispatch.inv_cell) != cell)
                        {
                            continue;
                        }
                        let toward_light = oct_vector(record.direction);
                        if dot(toward_light, ng) <= 0.0 {
                            continue;
                        }
                        count += 1u;
                        var flux = record.flux;
                        if !flat_normal || point.alpha > 0.0 {
                            let wi = unit(toward_light);
                            let cos_g = max(dot(wi, ng), COS_MIN);
                            //#if metal
                            if point.alpha > 0.0 {
                                let reflectance = point.reflectance;
                                let f = eval_rough(MATERIAL_METAL, point.alpha, reflectance, n, point.wo, wi);
                                flux = f * record.flux * (1.0 / cos_g);
                            } else {
                                flux = record.flux * (max(dot(wi, n), 0.0) / cos_g);
                            }
                            //#else
                            flux = record.flux * (max(dot(wi, n), 0.0) / cos_g);
                            //#end
                        }
                        block += flux;
                        let side = select(-1.0, 1.0, distance_sq > inner_sq);
                        ring += side * dot(tint, flux);
                    }
                    sum += block;
                }
            }
        }
    }
    let before = gathered[id];
    gathered[id] = Gathered(before.flux + point.weight * sum, before.count + count, ring, 0u, 0u, 0u);
    loops_stopped();
}
