// Opacity of a material. Twin: src/materials/opacity.rs.

fn choose_opacity(p: ShadingPoint, u: f32) -> Layer {
    let m = p.lobe.material;
    var opacity = amount_at(p);
    let cutoff = scene.materials[m].ior;
    if cutoff > 0.0 {
        opacity = select(0.0, 1.0, opacity >= cutoff);
    }
    if u < opacity {
        return another(p, scene.materials[m].first, u / opacity);
    }
    var lobe = p.lobe;
    lobe.bsdf = MATERIAL_NULL;
    lobe.reflectance = vec3f(1.0);
    return Layer(lobe, 1.0, u);
}
