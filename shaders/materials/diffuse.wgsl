// Lambertian reflection. Twin: src/materials/diffuse.rs.

const DIFFUSE_ADJOINT_COS_MIN: f32 = 1e-2;

fn eval_diffuse(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return vec3f(0.0);
    }
    return lobe.reflectance * (INV_PI * cos);
}

fn pdf_diffuse(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return 0.0;
    }
    return cos * INV_PI;
}

//#if scene
fn sample_diffuse(p: ShadingPoint, u: vec2f, mode: u32) -> Sample {
    var axis = p.n;
    var weight = p.lobe.reflectance;
    if mode == IMPORTANCE {
        axis = p.ng;
        if any(p.s.shading != p.s.normal) {
            weight *= max(dot(p.wo, p.n), 0.0) / max(dot(p.wo, p.ng), DIFFUSE_ADJOINT_COS_MIN);
        }
    }
    let wi = renormalized(from_frame(axis, sample_cosine(u)));
    // a cosine about `ng` itself is above 2^-13, so photons need no test
    if mode == RADIANCE && dot(wi, p.ng) <= 0.0 {
        weight = vec3f(0.0);
    }
    return Sample(wi, weight);
}
//#end
