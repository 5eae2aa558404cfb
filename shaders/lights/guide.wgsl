// Where a light's photons meet glass and mirrors: twin of src/lights/guide.rs, whose host part learns the maps.

const GUIDE_SIDE: u32 = 32u;
const GUIDE_CELLS: u32 = GUIDE_SIDE * GUIDE_SIDE;

struct Guided {
    across: vec2f,
    scale: f32,
}

fn guided(light: Light, across: vec2f, u: f32) -> Guided {
    if light.guide == 0u {
        return Guided(across, 1.0);
    }
    let cell = find_interval(light.guide, GUIDE_CELLS, u);
    let x = (f32(cell % GUIDE_SIDE) + across.x) * (1.0 / f32(GUIDE_SIDE));
    let y = (f32(cell / GUIDE_SIDE) + across.y) * (1.0 / f32(GUIDE_SIDE));
    return Guided(vec2f(x, y), 1.0 / pdf_bin(light.guide, cell, GUIDE_CELLS));
}
