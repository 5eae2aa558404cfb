// Sorts each short bucket by key. Run by one invocation per bucket; reads `records` and `starts`,
// sorts slices of `order`, writes `sorted`. Twin of `grid_sort` in src/kernels/grid_build.rs.

@compute @workgroup_size(64)
fn grid_sort(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let bucket = invocation(gid, groups);
    if bucket >= dispatch.end {
        return;
    }
    let begin = starts[bucket];
    let end = starts[bucket + 1u];
    if end - begin <= SORT_SHORT {
        sort_short(begin, end);
    }
}

// Insertion sort of one bucket, then the copy of its records.
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
