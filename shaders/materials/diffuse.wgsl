// Lambertian reflection. Twin: src/materials/diffuse.rs.

fn eval_diffuse(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return vec3f(0.0);
    }
    return lobe.reflectance * (INV_PI * cos);
}

//#if scene
fn pdf_diffuse(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    return pdf_cosine(n, wi);
}

fn sample_diffuse(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let sent = cosine_axis(p, mode);
    var weight = sent.weight;
    let wi = renormalized(from_frame(sent.axis, sample_cosine(u.xy)));
    // a cosine about `ng` itself is above 2^-13, so photons need no test
    if mode == RADIANCE && dot(wi, p.ng) <= 0.0 {
        weight = vec3f(0.0);
    }
    return Sample(wi, weight);
}
//#end
