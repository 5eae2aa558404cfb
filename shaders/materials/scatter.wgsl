// Scattering at a surface, the dispatch over materials: twin of src/materials/scatter.rs.

const RADIANCE: u32 = 0u;
const IMPORTANCE: u32 = 1u;
const ADJOINT_COS_MIN: f32 = 1e-2;

//#if scene
struct Scatter {
    direction: vec3f,
    interior: Interior,
    weight: vec3f,
}

fn reflectance_at(material: u32, uv: vec2f) -> vec3f {
    let m = scene.materials[material];
    //#if textures
    if m.texture != NONE {
        return eval_texture(m.texture, uv);
    }
    //#end
    return m.reflectance;
}

fn is_specular(kind: u32) -> bool {
    return kind == MATERIAL_MIRROR || kind == MATERIAL_GLASS;
}

fn toward(v: vec3f, w: vec3f) -> vec3f {
    return select(-v, v, dot(v, w) >= 0.0);
}

fn shading_normal(s: Surface, wo: vec3f) -> vec3f {
    let ng = toward(s.normal, wo);
    let ns = toward(s.shading, ng);
    let diffuse = scene.materials[s.material].kind == MATERIAL_DIFFUSE;
    return select(ng, ns, diffuse || dot(wo, ns) > 0.0);
}

//#if specular
fn scatter_specular(s: Surface, wo: vec3f, interior: Interior, u: f32, mode: u32) -> Scatter {
    let m = scene.materials[s.material];
    let ng = toward(s.normal, wo);
    var n = shading_normal(s, wo);
    //#if glass
    if m.kind == MATERIAL_GLASS {
        let beyond = interior_beyond(s, wo, interior);
        let eta = relative_ior(s, wo, interior, beyond);
        let cos_i = dot(wo, n);
        let interface_n = fresnel(cos_i, eta);
        if u >= interface_n.reflectance {
            var wi = refracted(wo, n, cos_i, interface_n.cos_t, eta);
            if dot(wi, ng) >= 0.0 {
                n = ng;
                let cos_g = dot(wo, ng);
                let flat_ng = fresnel(cos_g, eta);
                wi = refracted(wo, ng, cos_g, flat_ng.cos_t, eta);
            }
            var weight = eta * eta;
            if mode == IMPORTANCE {
                weight = shading_correction(s, n, ng, wo, wi);
            }
            return Scatter(wi, beyond, vec3f(weight));
        }
    }
    //#end
    if dot(mirrored(wo, n), ng) <= 0.0 {
        n = ng;
    }
    let wi = mirrored(wo, n);
    var weight = vec3f(1.0);
    if mode == IMPORTANCE {
        weight *= shading_correction(s, n, ng, wo, wi);
    }
    if m.kind != MATERIAL_GLASS {
        weight *= reflectance_at(s.material, s.uv);
    }
    return Scatter(wi, interior, weight);
}
//#end

fn scatter_rough(s: Surface, wo: vec3f, interior: Interior, u: vec2f, mode: u32) -> Scatter {
    let m = scene.materials[s.material];
    let ng = toward(s.normal, wo);
    let n = shading_normal(s, wo);
    var wi: vec3f;
    var weight = reflectance_at(s.material, s.uv);
    //#if metal
    if m.kind == MATERIAL_METAL {
        let f = basis(n);
        let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
        let h = sample_metal(local_wo, m.alpha, u);
        let local_wi = mirrored(local_wo, h);
        weight = weight_metal(local_wo, h, local_wi, weight, m.alpha);
        wi = from_frame(n, local_wi);
    }
    //#end
    if m.kind == MATERIAL_DIFFUSE {
        var axis = n;
        if mode == IMPORTANCE {
            axis = ng;
            if any(s.shading != s.normal) {
                weight *= max(dot(wo, n), 0.0) / max(dot(wo, ng), ADJOINT_COS_MIN);
            }
        }
        wi = from_frame(axis, sample_cosine(u));
    }
    wi *= 1.0 / sqrt(dot(wi, wi));
    let cos_g = dot(wi, ng);
    if cos_g <= 0.0 {
        weight = vec3f(0.0);
    } else if mode == IMPORTANCE && m.kind == MATERIAL_METAL {
        // from behind the shading normal an eye path would get nothing
        let seen = dot(wo, toward(s.shading, ng)) > 0.0;
        weight *= select(0.0, shading_correction(s, n, ng, wo, wi), seen);
    }
    return Scatter(wi, interior, weight);
}

fn shading_correction(s: Surface, n: vec3f, ng: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    if all(s.shading == s.normal) {
        return 1.0;
    }
    let denominator = abs(dot(wo, ng) * dot(wi, n));
    if denominator <= 1e-6 {
        return 0.0;
    }
    return abs(dot(wo, n) * dot(wi, ng)) / denominator;
}
//#end

fn eval_rough(kind: u32, alpha: f32, reflectance: vec3f, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return vec3f(0.0);
    }
    //#if metal
    if kind == MATERIAL_METAL {
        let f = basis(n);
        let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
        let local_wi = vec3f(dot(wi, f.t), dot(wi, f.b), cos);
        return eval_metal(local_wo, local_wi, reflectance, alpha) * cos;
    }
    //#end
    return reflectance * (INV_PI * cos);
}

fn pdf_rough(kind: u32, alpha: f32, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return 0.0;
    }
    //#if metal
    if kind == MATERIAL_METAL {
        let f = basis(n);
        let local_wo = vec3f(dot(wo, f.t), dot(wo, f.b), dot(wo, n));
        return pdf_metal(local_wo, vec3f(dot(wi, f.t), dot(wi, f.b), cos), alpha);
    }
    //#end
    return cos * INV_PI;
}
