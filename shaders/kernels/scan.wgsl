// Prefix sum within a workgroup of 256 invocations with 16 items each, shared by the kernels of the
// grid's scan.

const SCAN_ITEMS: u32 = 16u;
const SCAN_BLOCK: u32 = 4096u;

var<workgroup> sums: array<u32, 256>;

// Sum of the values of all invocations before this one (Hillis & Steele 1986).
fn sum_before(local: u32, value: u32) -> u32 {
    sums[local] = value;
    var total = value;
    for (var step = 1u; step < 256u; step <<= 1u) {
        workgroupBarrier();
        var left = 0u;
        if local >= step {
            left = sums[local - step];
        }
        workgroupBarrier();
        total += left;
        sums[local] = total;
    }
    return total - value;
}
