// GGX microfacet conductor with Schlick's Fresnel term. Twin: src/materials/metal.rs.

fn fresnel_metal(lobe: Lobe, cos: f32) -> vec3f {
    return schlick(lobe.reflectance, cos);
}

fn mean_schlick(f0: vec3f) -> vec3f {
    return f0 * (20.0 / 21.0) + vec3f(1.0 / 21.0);
}

fn eval_metal(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let facets = facets_at(n, wo, wi, lobe.alpha);
    if facets.cos_o <= 0.0 || facets.cos_i <= 0.0 {
        return vec3f(0.0);
    }
    var f = fresnel_metal(lobe, facets.cos_d) * facets.brdf;
    //#if lobe_parameters
    if scene.materials[lobe.material].mean_albedo < 1.0 {
        f += scattered_again(
            lobe.material, mean_schlick(lobe.reflectance), facets.cos_o, facets.cos_i
        );
    }
    //#end
    return f * facets.cos_i;
}

//#if scene
fn pdf_metal(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    return pdf_facet_lobe(lobe, n, wo, wi);
}

fn sample_metal(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    //#if lobe_parameters
    if scene.materials[p.lobe.material].mean_albedo < 1.0 {
        let wi = sample_facet_lobe(p, u.xy);
        let pdf = pdf_facet_lobe(p.lobe, p.n, p.wo, wi);
        var weight = vec3f(0.0);
        if pdf > 0.0 {
            weight = eval_metal(p.lobe, p.n, p.wo, wi) * (facet_correction(p, wi, mode) / pdf);
        }
        return Sample(wi, weight);
    }
    //#end
    let facet = sample_facets(p.n, p.wo, p.lobe.alpha, u.xy);
    let weight = fresnel_metal(p.lobe, facet.cos_d) * facet.weight;
    return Sample(facet.wi, weight * facet_correction(p, facet.wi, mode));
}
//#end
