// Rough diffuse reflection (Oren & Nayar's model in Fujii's form). Twin:
// src/materials/rough_diffuse.rs, which gives the equation.

const ROUGH_COS_MIN: f32 = 1e-2;

fn rho_ratio(sigma: f32, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let cos_i = dot(wi, n);
    let cos_o = dot(wo, n);
    let s = dot(wi, wo) - cos_i * cos_o;
    let t = select(1.0, max(max(cos_i, cos_o), ROUGH_COS_MIN), s > 0.0);
    return PI * (1.0 + sigma * (s / t)) / (PI + (0.5 * PI - 0.6666667) * sigma);
}

fn eval_rough_diffuse(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return vec3f(0.0);
    }
    return lobe.reflectance * (INV_PI * cos * max(rho_ratio(lobe.alpha, n, wo, wi), 0.0));
}

//#if scene
fn pdf_rough_diffuse(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    return pdf_cosine(n, wi);
}

fn sample_rough_diffuse(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let sent = cosine_axis(p, mode);
    var weight = sent.weight;
    let wi = renormalized(from_frame(sent.axis, sample_cosine(u.xy)));
    if dot(wi, p.ng) <= 0.0 || dot(wi, p.n) <= 0.0 {
        weight = vec3f(0.0);
    }
    weight *= max(rho_ratio(p.lobe.alpha, p.n, p.wo, wi), 0.0);
    return Sample(wi, weight);
}
//#end
