// Rough dielectric. Twin: src/materials/rough_glass.rs, which names the sources.

const LEAST: f32 = 0.1;

fn scattered_once(material: u32, outside: bool, cos: f32) -> f32 {
    if scene.materials[material].mean_albedo == 1.0 {
        return 1.0;
    }
    if outside {
        return max(facet_albedo(material, cos), LEAST);
    }
    return max(inner_albedo(material, cos), LEAST);
}

fn is_outside(lobe: Lobe) -> bool {
    return (lobe.reflectance.x < 1.0) == (scene.materials[lobe.material].ior > 1.0);
}

struct Refraction {
    value: f32,
    pdf: f32,
}

fn refraction(wo: vec3f, wi: vec3f, alpha: f32, eta: f32) -> Refraction {
    let sum = wo * eta + wi;
    let long = unit(sum);
    let h = select(long, -long, long.z < 0.0);
    let cos_d = dot(wo, h);
    let cos_t = -dot(wi, h);
    if cos_d <= 0.0 || cos_t <= 0.0 {
        return Refraction(0.0, 0.0);
    }
    let passed = 1.0 - fresnel(cos_d, eta).reflectance;
    let lambda = ggx_lambda(wo.z, alpha);
    let root = eta * cos_d - cos_t;
    // solid angle of the facets' normals over that of `wi`, times the visible normals' density
    let spread = ggx_d(h, alpha) * cos_d * cos_t / (root * root * wo.z);
    return Refraction(
        passed * spread * (eta * eta) / (1.0 + lambda + ggx_lambda(-wi.z, alpha)),
        passed * spread / (1.0 + lambda)
    );
}

fn eval_rough_glass(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let eta = lobe.reflectance.x;
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    let local_wi = vec3f(dot(wi, f.t), dot(wi, f.b), dot(wi, n));
    if local_wo.z <= 0.0 || local_wi.z == 0.0 {
        return vec3f(0.0);
    }
    var value = 0.0;
    if local_wi.z > 0.0 {
        let facets = facets_at(n, wo, wi, lobe.alpha);
        value += fresnel(facets.cos_d, eta).reflectance * facets.brdf * facets.cos_i;
    } else {
        value += refraction(local_wo, local_wi, lobe.alpha, eta).value;
    }
    return vec3f(value / scattered_once(lobe.material, is_outside(lobe), local_wo.z));
}

//#if scene
fn pdf_rough_glass(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let eta = lobe.reflectance.x;
    let f = basis(n);
    let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
    let local_wi = vec3f(dot(wi, f.t), dot(wi, f.b), dot(wi, n));
    if local_wo.z <= 0.0 || local_wi.z == 0.0 {
        return 0.0;
    }
    if local_wi.z > 0.0 {
        let h = unit(local_wo + local_wi);
        return fresnel(dot(local_wo, h), eta).reflectance
            * ggx_pdf(local_wo, local_wi, lobe.alpha);
    }
    return refraction(local_wo, local_wi, lobe.alpha, eta).pdf;
}

fn sample_rough_glass(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let eta = p.lobe.reflectance.x;
    let alpha = p.lobe.alpha;
    let f = basis(p.n);
    let local_wo = vec3f(dot(p.wo, f.t), dot(p.wo, f.b), dot(p.wo, p.n));
    let h = ggx_visible_normal(local_wo, alpha, u.xy);
    let cos_d = dot(local_wo, h);
    let facet = fresnel(cos_d, eta);
    let reflects = u.z < facet.reflectance;
    var local_wi = mirrored(local_wo, h);
    var side = 1.0;
    if !reflects {
        local_wi = refracted(local_wo, h, cos_d, facet.cos_t, eta);
        side = -1.0;
    }
    let wi = renormalized(from_frame(p.n, local_wi));
    var weight = 0.0;
    if local_wi.z * side > 0.0 && dot(wi, p.ng) * side > 0.0 {
        let lambda = ggx_lambda(local_wo.z, alpha);
        weight = (1.0 + lambda) / (1.0 + lambda + ggx_lambda(abs(local_wi.z), alpha));
        let outside = is_outside(p.lobe);
        if mode == IMPORTANCE {
            weight *= shading_correction(p, p.n, wi);
            let leaves_outside = outside == reflects;
            weight *= 1.0 / scattered_once(p.lobe.material, leaves_outside, abs(local_wi.z));
        } else {
            // radiance is compressed into a smaller solid angle inside
            weight *= select(eta * eta, 1.0, reflects);
            weight *= 1.0 / scattered_once(p.lobe.material, outside, local_wo.z);
        }
    }
    return Sample(wi, vec3f(weight));
}
//#end
