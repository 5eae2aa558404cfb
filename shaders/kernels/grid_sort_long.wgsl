// Sorts each long bucket by key with a whole workgroup (radix sort, four bits at a time),
// completing `grid_sort`. Run by one workgroup per 256 buckets; reads `records` and `starts`, sorts
// slices of `order`, writes `sorted` and, if the driver stopped its loops, adds to `counters`. One
// workgroup covers many buckets because most are short and barriers are expensive on a software
// driver, but not more, because that driver counts the rounds of a loop over all buckets of a
// workgroup and stops after 65535. Twin of `grid_sort` in src/kernels/grid_build.rs.

const RADIX: u32 = 16u;
const SORT_BUCKETS: u32 = 256u;

var<workgroup> found: atomic<u32>;
// long buckets in arbitrary order, which does not affect the result
var<workgroup> long_buckets: array<u32, SORT_BUCKETS>;
// number of items per digit and invocation, then their destinations
var<workgroup> tallies: array<u32, 1024>;
var<workgroup> totals: array<u32, 16>;

@compute @workgroup_size(64)
fn grid_sort_long(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if local == 0u {
        atomicStore(&found, 0u);
    }
    workgroupBarrier();
    // collect the long buckets
    let first = dispatch.first + (group.y * groups.x + group.x) * SORT_BUCKETS;
    for (var i = local; i < SORT_BUCKETS; i += 64u) {
        let bucket = first + i;
        if bucket < dispatch.end && starts[bucket + 1u] - starts[bucket] > SORT_SHORT {
            long_buckets[atomicAdd(&found, 1u)] = bucket;
        }
    }
    workgroupBarrier();
    if local == 0u {
        totals[0] = atomicLoad(&found);
    }
    let count = workgroupUniformLoad(&totals[0]);
    for (var i = 0u; i < count; i++) {
        let bucket = workgroupUniformLoad(&long_buckets[i]);
        sort_long(starts[bucket], starts[bucket + 1u], local);
    }
    loops_stopped();
}

// Radix sort of one bucket. The items alternate between `order` and the `key` fields of `sorted`,
// which are still unused.
fn sort_long(begin: u32, end: u32, local: u32) {
    let share = (end - begin + 63u) / 64u;
    let first = min(begin + local * share, end);
    let last = min(first + share, end);
    for (var shift = 0u; shift < 32u; shift += 4u) {
        let odd = (shift & 4u) != 0u;
        // count the digits of this invocation's items
        for (var digit = 0u; digit < RADIX; digit++) {
            tallies[digit * 64u + local] = 0u;
        }
        for (var i = first; i < last; i++) {
            tallies[digit_of(item_at(i, odd), shift) * 64u + local] += 1u;
        }
        workgroupBarrier();
        // prefix sums over the invocations, per digit
        if local < RADIX {
            var sum = 0u;
            for (var at = local * 64u; at < local * 64u + 64u; at += 4u) {
                let next = vec4u(tallies[at], tallies[at + 1u], tallies[at + 2u], tallies[at + 3u]);
                tallies[at] = sum;
                tallies[at + 1u] = sum + next.x;
                tallies[at + 2u] = sum + next.x + next.y;
                tallies[at + 3u] = sum + next.x + next.y + next.z;
                sum += next.x + next.y + next.z + next.w;
            }
            totals[local] = sum;
        }
        workgroupBarrier();
        // add the start of each digit
        var base = begin;
        for (var digit = 0u; digit < RADIX; digit++) {
            tallies[digit * 64u + local] += base;
            base += totals[digit];
        }
        // move the items
        for (var i = first; i < last; i++) {
            let item = item_at(i, odd);
            let slot = digit_of(item, shift) * 64u + local;
            let place = tallies[slot];
            tallies[slot] = place + 1u;
            if odd {
                order[place] = item;
            } else {
                sorted[place].key = item;
            }
        }
        storageBarrier();
        workgroupBarrier();
    }
    for (var i = first; i < last; i++) {
        copy_record(i);
    }
    workgroupBarrier();
}

fn item_at(i: u32, odd: bool) -> u32 {
    if odd {
        return sorted[i].key;
    }
    return order[i];
}

fn digit_of(item: u32, shift: u32) -> u32 {
    return (records[item].key >> shift) & (RADIX - 1u);
}
