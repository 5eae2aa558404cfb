// The hash grid over photon records: twin of src/grid.rs.

const CELL_MAX: f32 = 1e9;

fn grid_cell(position: vec3f, inv_cell: f32) -> vec3i {
    return vec3i(clamp(floor(position * inv_cell), vec3f(-CELL_MAX), vec3f(CELL_MAX)));
}

fn grid_bucket(cell: vec3i, mask: u32) -> u32 {
    var h = (u32(cell.x) * 73856093u) ^ (u32(cell.y) * 19349663u) ^ (u32(cell.z) * 83492791u);
    h ^= h >> 16u;
    h *= 0x7feb352du;
    h ^= h >> 15u;
    return h & mask;
}
