// Perfect mirror. Twin: src/materials/mirror.rs.

fn scatter_mirror(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter {
    let mirror = reflected(p, mode);
    return Scatter(mirror.direction, interior, mirror.weight * p.lobe.reflectance);
}
