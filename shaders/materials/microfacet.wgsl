// Microfacet reflection. Twin: src/materials/microfacet.rs, which names the sources.

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

//#if scene
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
//#end

struct Facets {
    cos_d: f32,
    cos_o: f32,
    cos_i: f32,
    brdf: f32,
}

fn facets_at(n: vec3f, wo: vec3f, wi: vec3f, alpha: f32) -> Facets {
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    let local_wi = vec3f(dot(wi, f.t), dot(wi, f.b), dot(wi, n));
    let cos_o = local_wo.z;
    let cos_i = local_wi.z;
    if cos_o <= 0.0 || cos_i <= 0.0 {
        return Facets(0.0, cos_o, cos_i, 0.0);
    }
    let h = unit(local_wo + local_wi);
    let g = 1.0 / (1.0 + ggx_lambda(cos_o, alpha) + ggx_lambda(cos_i, alpha));
    return Facets(dot(local_wo, h), cos_o, cos_i, ggx_d(h, alpha) * g / (4.0 * cos_o * cos_i));
}

//#if scene
struct FacetSample {
    wi: vec3f,
    cos_d: f32,
    weight: f32,
}

fn sample_facets(n: vec3f, wo: vec3f, alpha: f32, u: vec2f) -> FacetSample {
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    let h = ggx_visible_normal(local_wo, alpha, u);
    let local_wi = mirrored(local_wo, h);
    let wi = renormalized(from_frame(n, local_wi));
    var weight = 0.0;
    if local_wi.z > 0.0 {
        let lo = ggx_lambda(local_wo.z, alpha);
        weight = (1.0 + lo) / (1.0 + lo + ggx_lambda(local_wi.z, alpha));
    }
    return FacetSample(wi, dot(local_wo, h), weight);
}

fn pdf_facets(n: vec3f, wo: vec3f, wi: vec3f, alpha: f32) -> f32 {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return 0.0;
    }
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    return ggx_pdf(local_wo, vec3f(dot(wi, f.t), dot(wi, f.b), cos), alpha);
}

fn facet_correction(p: ShadingPoint, wi: vec3f, mode: u32) -> f32 {
    if dot(wi, p.ng) <= 0.0 {
        return 0.0;
    }
    if mode == IMPORTANCE {
        // an eye path from behind the shading normal would receive nothing
        return select(0.0, shading_correction(p, p.n, wi), dot(p.wo, p.ns) > 0.0);
    }
    return 1.0;
}
//#end

//#if lobe_parameters
fn facet_albedo(material: u32, cos: f32) -> f32 {
    let a = scene.materials[material].albedo_low;
    let b = scene.materials[material].albedo_high;
    let high = b.x + cos * (b.y + cos * (b.z + cos * b.w));
    return clamp(a.x + cos * (a.y + cos * (a.z + cos * (a.w + cos * high))), 0.0, 1.0);
}

fn inner_albedo(material: u32, cos: f32) -> f32 {
    let a = scene.materials[material].eta;
    let b = scene.materials[material].k;
    let c = scene.materials[material].mean_fresnel;
    let high = b.y + cos * (b.z + cos * (c.x + cos * c.y));
    return clamp(a.x + cos * (a.y + cos * (a.z + cos * (b.x + cos * high))), 0.0, 1.0);
}

fn scattered_again(material: u32, mean_fresnel: vec3f, cos_o: f32, cos_i: f32) -> vec3f {
    let mean_albedo = scene.materials[material].mean_albedo;
    let lost = (1.0 - facet_albedo(material, cos_o)) * (1.0 - facet_albedo(material, cos_i));
    let share = lost * (INV_PI / (1.0 - mean_albedo));
    let kept = mean_fresnel * mean_fresnel * mean_albedo;
    return kept / (vec3f(1.0) - mean_fresnel * (1.0 - mean_albedo)) * share;
}
//#end

//#if scene
//#if lobe_parameters
fn sample_facet_lobe(p: ShadingPoint, u: vec2f) -> vec3f {
    let again = 1.0 - facet_albedo(p.lobe.material, dot(p.wo, p.n));
    if u.x < again {
        return renormalized(from_frame(p.n, sample_cosine(vec2f(u.x / again, u.y))));
    }
    let x = clamp((u.x - again) / max(1.0 - again, 1e-6), 0.0, 1.0);
    return sample_facets(p.n, p.wo, p.lobe.alpha, vec2f(x, u.y)).wi;
}
//#end

fn pdf_facet_lobe(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let pdf = pdf_facets(n, wo, wi, lobe.alpha);
    //#if lobe_parameters
    if scene.materials[lobe.material].mean_albedo < 1.0 {
        let again = 1.0 - facet_albedo(lobe.material, dot(wo, n));
        return pdf * (1.0 - again) + again * pdf_cosine(n, wi);
    }
    //#end
    return pdf;
}
//#end
