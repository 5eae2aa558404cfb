// Choice of the light for a shadow ray, by probabilities that the host learns for cells of space.
// Twin: src/lights/select.rs.

const CELL_DEPTH: u32 = 8u;
const CELL_LEAF: u32 = 3u;

fn find_interval(first: u32, count: u32, u: f32) -> u32 {
    // binary search without branches on the compared values, which are unpredictable
    var low = 0u;
    var length = count;
    while length > 1u {
        let half = length / 2u;
        low += select(half, 0u, scene.distributions[first + low + half - 1u] > u);
        length -= half;
    }
    return low;
}

fn shares_at(position: vec3f) -> u32 {
    //#if cells
    var cell = scene.cells[0];
    for (var i = 0u; i < CELL_DEPTH; i++) {
        if cell.axis == CELL_LEAF {
            break;
        }
        let above = position[cell.axis] >= cell.split;
        cell = scene.cells[cell.first + select(0u, 1u, above)];
    }
    return cell.first;
    //#else
    return 0u;
    //#end
}

fn choose_light(shares: u32, u: f32) -> u32 {
    return find_interval(shares, LIGHT_COUNT, u);
}

fn share_of(shares: u32, index: u32) -> f32 {
    let high = scene.distributions[shares + index];
    var low = 0.0;
    if index > 0u {
        low = scene.distributions[shares + index - 1u];
    }
    return high - low;
}
