// Thin sheet with rough faces. Twin: src/materials/rough_pane.rs, which states the model.

const PANE_LEAST: f32 = 0.1;

fn pane_scattered_once(material: u32, cos: f32) -> f32 {
    if scene.materials[material].mean_albedo == 1.0 {
        return 1.0;
    }
    return max(facet_albedo(material, cos), PANE_LEAST);
}

fn pane_reflectance(cos: f32, ior: f32) -> f32 {
    let one = fresnel(abs(cos), 1.0 / ior).reflectance;
    return 2.0 * one / (1.0 + one);
}

fn in_front(n: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    return select(wi, wi - n * (2.0 * cos), cos < 0.0);
}

fn eval_rough_pane(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let facets = facets_at(n, wo, in_front(n, wi), lobe.alpha);
    if facets.brdf <= 0.0 {
        return vec3f(0.0);
    }
    let reflected = pane_reflectance(facets.cos_d, scene.materials[lobe.material].ior);
    var f = vec3f(reflected);
    if dot(wi, n) < 0.0 {
        f = lobe.reflectance * (1.0 - reflected);
    }
    return f * (facets.brdf * facets.cos_i / pane_scattered_once(lobe.material, facets.cos_o));
}

//#if scene
fn pdf_rough_pane(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let up = in_front(n, wi);
    let cos_d = facets_at(n, wo, up, lobe.alpha).cos_d;
    let reflected = pane_reflectance(cos_d, scene.materials[lobe.material].ior);
    let share = select(reflected, 1.0 - reflected, dot(wi, n) < 0.0);
    return share * pdf_facets(n, wo, up, lobe.alpha);
}

fn sample_rough_pane(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let facet = sample_facets(p.n, p.wo, p.lobe.alpha, u.xy);
    let reflects = u.z < pane_reflectance(facet.cos_d, scene.materials[p.lobe.material].ior);
    let cos = dot(facet.wi, p.n);
    var wi = facet.wi;
    var side = 1.0;
    var color = vec3f(1.0);
    if !reflects {
        wi = renormalized(facet.wi - p.n * (2.0 * cos));
        side = -1.0;
        color = p.lobe.reflectance;
    }
    if dot(wi, p.ng) * side <= 0.0 {
        return Sample(wi, vec3f(0.0));
    }
    var factor = facet.weight;
    var viewed = dot(p.wo, p.n);
    if mode == IMPORTANCE {
        factor *= shading_correction(p, p.n, wi);
        viewed = cos;
    }
    return Sample(wi, color * (factor / pane_scattered_once(p.lobe.material, viewed)));
}
//#end
