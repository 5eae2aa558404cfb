// A clear dielectric coat over any other material. Twin: src/materials/clearcoat.rs, which states
// the model.

fn choose_clearcoat(p: ShadingPoint, u: f32) -> Layer {
    let material = p.lobe.material;
    let ior = scene.materials[material].ior;
    let share = fresnel(abs(dot(p.wo, p.n)), 1.0 / ior).reflectance;
    if u >= share {
        let v = (u - share) / max(1.0 - share, 1e-6);
        return another(p, scene.materials[material].first, v);
    }
    let rough = p.lobe.alpha > 0.0;
    var lobe = p.lobe;
    lobe.bsdf = select(MATERIAL_MIRROR, MATERIAL_COAT, rough);
    lobe.reflectance = vec3f(1.0);
    // the mirror reflects the Fresnel fraction, which is the probability
    return Layer(lobe, select(1.0, 1.0 / share, rough), u / share);
}
