// Counts the records per bucket. Run by one invocation per record of the capacity, of which those
// past `counters.records` do nothing; reads `records`, adds to `counts`. Twin of `grid_count` in
// src/kernels/grid_build.rs.

@compute @workgroup_size(64)
fn grid_count(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end || id >= atomicLoad(&counters.records) {
        return;
    }
    let bucket = record_bucket(records[id]);
    atomicAdd(&counts[bucket], 1u);
}
