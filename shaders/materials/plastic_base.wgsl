// Diffuse base of plastic. Twin: src/materials/plastic_base.rs.

fn coat_reflectance(material: u32, cos: f32) -> f32 {
    if scene.materials[material].alpha > 0.0 {
        return facet_albedo(material, cos);
    }
    return fresnel(cos, 1.0 / scene.materials[material].ior).reflectance;
}

fn eval_plastic_base(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return vec3f(0.0);
    }
    let passed = 1.0 - coat_reflectance(lobe.material, cos);
    return lobe.reflectance * (INV_PI * cos * passed);
}

//#if scene
fn pdf_plastic_base(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    return pdf_cosine(n, wi);
}

fn sample_plastic_base(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let sent = cosine_axis(p, mode);
    var weight = sent.weight;
    let wi = renormalized(from_frame(sent.axis, sample_cosine(u.xy)));
    let cos = dot(wi, p.n);
    if dot(wi, p.ng) <= 0.0 || cos <= 0.0 {
        weight = vec3f(0.0);
    }
    weight *= 1.0 - coat_reflectance(p.lobe.material, max(cos, 0.0));
    return Sample(wi, weight);
}
//#end
