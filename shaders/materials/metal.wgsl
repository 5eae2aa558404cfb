// GGX microfacet conductor. Twin: src/materials/metal.rs, which names the sources.

const ALPHA_MIN: f32 = 1e-3;

fn ggx_d(h: vec3f, alpha: f32) -> f32 {
    let a2 = alpha * alpha;
    let sin_sq = h.x * h.x + h.y * h.y;
    let d = h.z * h.z * a2 + sin_sq;
    return a2 / (PI * d * d);
}

fn ggx_lambda(cos: f32, alpha: f32) -> f32 {
    let c2 = cos * cos;
    let tan_sq = max(1.0 - c2, 0.0) / c2;
    return 0.5 * (sqrt(1.0 + alpha * alpha * tan_sq) - 1.0);
}

fn schlick(f0: vec3f, cos: f32) -> vec3f {
    let m = max(1.0 - cos, 0.0);
    let m2 = m * m;
    return f0 + (vec3f(1.0) - f0) * (m2 * m2 * m);
}

fn ggx_brdf(wo: vec3f, wi: vec3f, f0: vec3f, alpha: f32) -> vec3f {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return vec3f(0.0);
    }
    let h = unit(wo + wi);
    let g = 1.0 / (1.0 + ggx_lambda(wo.z, alpha) + ggx_lambda(wi.z, alpha));
    return schlick(f0, dot(wo, h)) * (ggx_d(h, alpha) * g / (4.0 * wo.z * wi.z));
}

fn ggx_visible_normal(wo: vec3f, alpha: f32, u: vec2f) -> vec3f {
    let vh = unit(vec3f(alpha * wo.x, alpha * wo.y, wo.z));
    let len_sq = vh.x * vh.x + vh.y * vh.y;
    var t1 = vec3f(1.0, 0.0, 0.0);
    if len_sq > 1e-12 {
        t1 = vec3f(-vh.y, vh.x, 0.0) * (1.0 / sqrt(len_sq));
    }
    let t2 = cross(vh, t1);
    let r = sqrt(u.x);
    let sc = sin_cos(TAU * u.y);
    let p1 = r * sc.y;
    let s = 0.5 * (1.0 + vh.z);
    let p2 = (1.0 - s) * sqrt(max(1.0 - p1 * p1, 0.0)) + s * (r * sc.x);
    let nh = t1 * p1 + t2 * p2 + vh * sqrt(max(1.0 - p1 * p1 - p2 * p2, 0.0));
    return unit(vec3f(alpha * nh.x, alpha * nh.y, max(nh.z, 1e-6)));
}

fn ggx_pdf(wo: vec3f, wi: vec3f, alpha: f32) -> f32 {
    if wo.z <= 0.0 || wi.z <= 0.0 {
        return 0.0;
    }
    let h = unit(wo + wi);
    return ggx_d(h, alpha) / (4.0 * wo.z * (1.0 + ggx_lambda(wo.z, alpha)));
}

fn ggx_weight(wo: vec3f, h: vec3f, wi: vec3f, f0: vec3f, alpha: f32) -> vec3f {
    if wi.z <= 0.0 {
        return vec3f(0.0);
    }
    let lo = ggx_lambda(wo.z, alpha);
    return schlick(f0, dot(wo, h)) * ((1.0 + lo) / (1.0 + lo + ggx_lambda(wi.z, alpha)));
}

fn eval_metal(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return vec3f(0.0);
    }
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    let local_wi = vec3f(dot(wi, f.t), dot(wi, f.b), cos);
    return ggx_brdf(local_wo, local_wi, lobe.reflectance, lobe.alpha) * cos;
}

fn pdf_metal(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return 0.0;
    }
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    return ggx_pdf(local_wo, vec3f(dot(wi, f.t), dot(wi, f.b), cos), lobe.alpha);
}

//#if scene
fn sample_metal(p: ShadingPoint, u: vec2f, mode: u32) -> Sample {
    let f = basis(p.n);
    let local_wo = vec3f(dot(p.wo, f.t), dot(p.wo, f.b), dot(p.wo, p.n));
    let h = ggx_visible_normal(local_wo, p.lobe.alpha, u);
    let local_wi = mirrored(local_wo, h);
    var weight = ggx_weight(local_wo, h, local_wi, p.lobe.reflectance, p.lobe.alpha);
    let wi = renormalized(from_frame(p.n, local_wi));
    if dot(wi, p.ng) <= 0.0 {
        weight = vec3f(0.0);
    } else if mode == IMPORTANCE {
        // an eye path from behind the shading normal would receive nothing
        let seen = dot(p.wo, p.ns) > 0.0;
        weight *= select(0.0, shading_correction(p, p.n, wi), seen);
    }
    return Sample(wi, weight);
}
//#end
