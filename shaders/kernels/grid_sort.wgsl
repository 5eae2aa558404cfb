// Each bucket into the order of its keys: twin of `grid_sort` in src/kernels/grid_build.rs. Run by one invocation per
// bucket; reads `records` and `starts`, sorts slices of `order`, writes `sorted`. A short bucket is sorted by its own
// invocation, a long one by its whole workgroup (radix sort, four bits at a time).

const SORT_SHORT: u32 = 32u;
const RADIX: u32 = 16u;

var<workgroup> slices: array<vec2u, 64>;
var<workgroup> longest: atomic<u32>;
// how many items each invocation has of each digit, then where they go
var<workgroup> tallies: array<u32, 1024>;
var<workgroup> totals: array<u32, 16>;

@compute @workgroup_size(64)
fn grid_sort(
    @builtin(global_invocation_id) gid: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let bucket = invocation(gid, groups);
    if local == 0u {
        atomicStore(&longest, 0u);
    }
    workgroupBarrier();
    slices[local] = vec2u(0u);
    if bucket < dispatch.end {
        let begin = starts[bucket];
        let end = starts[bucket + 1u];
        if end - begin <= SORT_SHORT {
            sort_short(begin, end);
        } else {
            slices[local] = vec2u(begin, end);
            atomicMax(&longest, end - begin);
        }
    }
    workgroupBarrier();
    if local == 0u {
        totals[0] = atomicLoad(&longest);
    }
    if workgroupUniformLoad(&totals[0]) == 0u {
        return;
    }
    for (var i = 0u; i < 64u; i++) {
        let slice = workgroupUniformLoad(&slices[i]);
        if slice.y > slice.x {
            sort_long(slice.x, slice.y, local);
        }
    }
    loops_stopped();
}

// Insertion sort.
fn sort_short(begin: u32, end: u32) {
    for (var i = begin; i < end; i++) {
        let item = order[i];
        let key = records[item].key;
        var j = i;
        while j > begin && records[order[j - 1u]].key > key {
            order[j] = order[j - 1u];
            j -= 1u;
        }
        order[j] = item;
    }
    for (var i = begin; i < end; i++) {
        copy_record(i);
    }
}

// Items go to and fro between `order` and the keys of `sorted`, which are not needed yet.
fn sort_long(begin: u32, end: u32, local: u32) {
    let share = (end - begin + 63u) / 64u;
    let first = min(begin + local * share, end);
    let last = min(first + share, end);
    for (var shift = 0u; shift < 32u; shift += 4u) {
        let odd = (shift & 4u) != 0u;
        for (var digit = 0u; digit < RADIX; digit++) {
            tallies[digit * 64u + local] = 0u;
        }
        for (var i = first; i < last; i++) {
            tallies[digit_of(item_at(i, odd), shift) * 64u + local] += 1u;
        }
        workgroupBarrier();
        if local < RADIX {
            var sum = 0u;
            for (var i = 0u; i < 64u; i++) {
                let at = local * 64u + i;
                let tally = tallies[at];
                tallies[at] = sum;
                sum += tally;
            }
            totals[local] = sum;
        }
        workgroupBarrier();
        var base = begin;
        for (var digit = 0u; digit < RADIX; digit++) {
            tallies[digit * 64u + local] += base;
            base += totals[digit];
        }
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

// What readers need to know of the key is the cell.
fn copy_record(i: u32) {
    let record = records[order[i]];
    sorted[i] = PhotonRecord(record.position, record_code(record), record.flux, record.direction);
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
