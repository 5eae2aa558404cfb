// Guide maps of photon emission, learned by the host. Twin: src/lights/guide.rs.

const GUIDE_SIDE: u32 = 32u;
const GUIDE_CELLS: u32 = GUIDE_SIDE * GUIDE_SIDE;
const GUIDED: f32 = 0.5;

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

//#if infinite
fn pdf_guide(light: Light, across: vec2f) -> f32 {
    let x = floor(across.x * f32(GUIDE_SIDE));
    let y = floor(across.y * f32(GUIDE_SIDE));
    let side = f32(GUIDE_SIDE);
    if x < 0.0 || y < 0.0 || x >= side || y >= side {
        return 0.0;
    }
    return pdf_bin(light.guide, u32(y) * GUIDE_SIDE + u32(x), GUIDE_CELLS);
}
//#end
