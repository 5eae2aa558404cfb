// Exclusive prefix sums of the sums of at most 4096 blocks, the second of three steps of
// `grid_scan` in src/kernels/grid_build.rs. Run by one workgroup; updates `block_sums`, whose entry
// past the blocks becomes the total.

@compute @workgroup_size(256)
fn grid_scan_sums(@builtin(local_invocation_index) local: u32) {
    let first = local * SCAN_ITEMS;
    var sum = 0u;
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        if first + i < dispatch.end {
            sum += block_sums[first + i];
        }
    }
    var before = sum_before(local, sum);
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        if first + i < dispatch.end {
            let count = block_sums[first + i];
            block_sums[first + i] = before;
            before += count;
        }
    }
    // the last invocation ends with the sum of all blocks
    if local == 255u {
        block_sums[dispatch.end] = before;
    }
}
