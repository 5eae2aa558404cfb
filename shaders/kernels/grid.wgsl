// Hash grid over photon records. Twin: src/kernels/grid.rs, which explains it, and the `record_*`
// functions of src/kernels/grid_build.rs.

const CELL_MAX: f32 = 1e9;
const ALONG: f32 = 4.0;

fn grid_cell(position: vec3f, inv_cell: f32) -> vec3i {
    let sides = vec3f(ALONG, 1.0, 1.0) * inv_cell;
    return vec3i(clamp(floor(position * sides), vec3f(-CELL_MAX), vec3f(CELL_MAX)));
}

fn grid_bucket(cell: vec3i, mask: u32) -> u32 {
    var h = (u32(cell.y) * 19349663u) ^ (u32(cell.z) * 83492791u);
    h ^= h >> 16u;
    h *= 0x7feb352du;
    h ^= h >> 15u;
    return (h + u32(cell.x)) & mask;
}

fn grid_code(cell: vec3i, photon_class: u32) -> u32 {
    return (u32(cell.y) & 0x3ffu) | ((u32(cell.z) & 0x3ffu) << 10u) | (photon_class << 20u);
}

// In sorted records, the bit for focused photons lies above those of a code.
const CODE_BITS: u32 = 21u;

fn is_code(word: u32, code: u32) -> bool {
    //#if continued
    return (word & ((1u << CODE_BITS) - 1u)) == code;
    //#else
    return word == code;
    //#end
}

fn is_focused(word: u32) -> bool {
    return (word >> CODE_BITS) != 0u;
}

//#if grid_count || grid_scatter || grid_sort || grid_sort_long
fn record_family(record: PhotonRecord) -> u32 {
    //#if split
    return record.key & 1u;
    //#else
    return 0u;
    //#end
}

fn record_cell(record: PhotonRecord) -> vec3i {
    //#if split
    let indirect = record_family(record) == 1u;
    return grid_cell(
        record.position, select(dispatch.inv_cell, dispatch.inv_cell_indirect, indirect)
    );
    //#else
    return grid_cell(record.position, dispatch.inv_cell);
    //#end
}

fn record_bucket(record: PhotonRecord) -> u32 {
    return grid_bucket(record_cell(record), dispatch.mask);
}

fn record_code(record: PhotonRecord) -> u32 {
    let code = grid_code(record_cell(record), record_family(record));
    //#if continued
    return code | (((record.key & FOCUSED) >> 1u) << CODE_BITS);
    //#else
    return code;
    //#end
}
//#end
