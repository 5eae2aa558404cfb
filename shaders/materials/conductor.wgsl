// GGX microfacet conductor with the exact Fresnel term. Twin: src/materials/conductor.rs.

fn fresnel_of_conductor(lobe: Lobe, cos: f32) -> vec3f {
    let m = scene.materials[lobe.material];
    return lobe.reflectance * fresnel_conductor(cos, m.eta, m.k);
}

fn eval_conductor(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let facets = facets_at(n, wo, wi, lobe.alpha);
    if facets.cos_o <= 0.0 || facets.cos_i <= 0.0 {
        return vec3f(0.0);
    }
    var f = fresnel_of_conductor(lobe, facets.cos_d) * facets.brdf;
    //#if lobe_parameters
    if scene.materials[lobe.material].mean_albedo < 1.0 {
        f += lobe.reflectance * scattered_again(
            lobe.material, scene.materials[lobe.material].mean_fresnel, facets.cos_o, facets.cos_i
        );
    }
    //#end
    return f * facets.cos_i;
}

//#if scene
fn pdf_conductor(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    return pdf_facet_lobe(lobe, n, wo, wi);
}

fn sample_conductor(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    //#if lobe_parameters
    if scene.materials[p.lobe.material].mean_albedo < 1.0 {
        let wi = sample_facet_lobe(p, u.xy);
        let pdf = pdf_facet_lobe(p.lobe, p.n, p.wo, wi);
        var weight = vec3f(0.0);
        if pdf > 0.0 {
            weight = eval_conductor(p.lobe, p.n, p.wo, wi) * (facet_correction(p, wi, mode) / pdf);
        }
        return Sample(wi, weight);
    }
    //#end
    let facet = sample_facets(p.n, p.wo, p.lobe.alpha, u.xy);
    let weight = fresnel_of_conductor(p.lobe, facet.cos_d) * facet.weight;
    return Sample(facet.wi, weight * facet_correction(p, facet.wi, mode));
}
//#end
