// Sums of the record counts in blocks of 4096 buckets, the first of three steps of `grid_scan` in
// src/kernels/grid_build.rs. Run by one workgroup per block; reads `counts`, writes `block_sums`.

@compute @workgroup_size(256)
fn grid_scan_reduce(
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
    // tree reduction in workgroup memory
    sums[local] = sum;
    for (var width = 128u; width > 0u; width >>= 1u) {
        workgroupBarrier();
        if local < width {
            sums[local] += sums[local + width];
        }
    }
    if local == 0u {
        block_sums[block] = sums[0];
    }
}
