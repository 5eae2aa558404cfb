// Thin sheet of a dielectric. Twin: src/materials/thin_glass.rs, which states the model.

fn scatter_thin_glass(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter {
    let ior = scene.materials[p.lobe.material].ior;
    let one = fresnel(abs(dot(p.wo, p.n)), 1.0 / ior).reflectance;
    if u < 2.0 * one / (1.0 + one) {
        let mirror = reflected(p, mode);
        return Scatter(mirror.direction, interior, mirror.weight);
    }
    return Scatter(-p.wo, interior, p.lobe.reflectance);
}
