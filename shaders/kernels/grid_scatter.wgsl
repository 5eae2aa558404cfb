// Puts record indices into bucket order. Run by one invocation per record of the capacity, of which
// those past `counters.records` do nothing; reads `records` and `starts`, counts `counts` down,
// writes `order`. Within a bucket the order is that of the invocations' arrival. Twin of
// `grid_scatter` in src/kernels/grid_build.rs.

@compute @workgroup_size(64)
fn grid_scatter(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end || id >= atomicLoad(&counters.records) {
        return;
    }
    let bucket = record_bucket(records[id]);
    order[starts[bucket] + atomicSub(&counts[bucket], 1u) - 1u] = id;
}
