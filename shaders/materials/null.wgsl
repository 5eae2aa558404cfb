// No material: paths pass straight through. Twin: src/materials/null.rs.

fn scatter_null(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter {
    return Scatter(-p.wo, interior, p.lobe.reflectance);
}
