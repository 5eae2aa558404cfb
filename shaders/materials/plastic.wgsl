// Plastic: a choice between a coat and a diffuse base. Twin: src/materials/plastic.rs, which states
// the model.

fn coated_albedo(material: u32, rho: vec3f) -> vec3f {
    let m = scene.materials[material];
    let passed = 1.0 - m.mean_albedo;
    if m.first == 1u {
        let inside = passed / (m.ior * m.ior);
        return rho / (m.ior * m.ior) / (vec3f(1.0) - rho * (1.0 - inside));
    }
    return rho / passed;
}

fn choose_plastic(p: ShadingPoint, u: f32) -> Layer {
    let share = coat_reflectance(p.lobe.material, abs(dot(p.wo, p.n)));
    var lobe = p.lobe;
    if u >= share {
        lobe.bsdf = MATERIAL_PLASTIC_BASE;
        lobe.reflectance = coated_albedo(p.lobe.material, p.lobe.reflectance);
        return Layer(lobe, 1.0, (u - share) / max(1.0 - share, 1e-6));
    }
    let rough = p.lobe.alpha > 0.0;
    lobe.bsdf = select(MATERIAL_MIRROR, MATERIAL_COAT, rough);
    lobe.reflectance = vec3f(1.0);
    // the mirror reflects the Fresnel fraction, which is the probability; so does the rough coat
    return Layer(lobe, select(1.0, 1.0 / share, rough), u / share);
}
