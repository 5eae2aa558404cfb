// Inversion of piecewise constant densities for lamps that emit an image or a table. Twin:
// src/lights/luminaire.rs.

struct Inverted {
    bin: u32,
    at: f32,
    pdf: f32,
}

fn inverted(first: u32, count: u32, u: f32) -> Inverted {
    let bin = find_interval(first, count, u);
    let high = scene.distributions[first + bin];
    var low = 0.0;
    if bin > 0u {
        low = scene.distributions[first + bin - 1u];
    }
    let part = min(max((u - low) / (high - low), 0.0), 1.0 - EPS);
    let pdf = (high - low) * f32(count);
    return Inverted(bin, (f32(bin) + part) / f32(count), pdf);
}
