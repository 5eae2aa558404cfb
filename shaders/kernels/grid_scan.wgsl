// Exclusive prefix sums of the buckets' record counts, the last of three steps of `grid_scan` in
// src/kernels/grid_build.rs. Run by one workgroup per block of 4096 buckets; reads `counts` and
// `block_sums`, writes `starts`, whose entry past the buckets becomes the total.

@compute @workgroup_size(256)
fn grid_scan(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = group.y * groups.x + group.x + dispatch.first / SCAN_BLOCK;
    if block * SCAN_BLOCK >= dispatch.end {
        return;
    }
    let first = block * SCAN_BLOCK + local * SCAN_ITEMS;
    var sum = 0u;
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        sum += counts[first + i];
    }
    var before = block_sums[block] + sum_before(local, sum);
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        starts[first + i] = before;
        before += counts[first + i];
    }
    if first + SCAN_ITEMS == dispatch.mask + 1u {
        starts[dispatch.mask + 1u] = before;
    }
}
