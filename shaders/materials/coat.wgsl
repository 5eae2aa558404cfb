// Rough dielectric coat of plastic. Twin: src/materials/coat.rs.

fn eval_coat(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let facets = facets_at(n, wo, wi, lobe.alpha);
    if facets.brdf <= 0.0 {
        return vec3f(0.0);
    }
    let reflected = fresnel(facets.cos_d, 1.0 / scene.materials[lobe.material].ior).reflectance;
    return lobe.reflectance * (reflected * facets.brdf * facets.cos_i);
}

//#if scene
fn pdf_coat(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    return pdf_facets(n, wo, wi, lobe.alpha);
}

fn sample_coat(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let facet = sample_facets(p.n, p.wo, p.lobe.alpha, u.xy);
    let ior = scene.materials[p.lobe.material].ior;
    let part = fresnel(facet.cos_d, 1.0 / ior).reflectance * facet.weight;
    return Sample(facet.wi, p.lobe.reflectance * (part * facet_correction(p, facet.wi, mode)));
}
//#end
