// Brushed metal: a GGX conductor with two widths. Twin: src/materials/brushed.rs, which names the
// sources and the parameters.

struct Grain {
    t: vec3f,
    b: vec3f,
}

fn grain(n: vec3f, angle: f32) -> Grain {
    let f = basis(n);
    let sc = sin_cos(angle);
    return Grain(f.t * sc.y + f.b * sc.x, f.b * sc.y - f.t * sc.x);
}

fn brushed_d(h: vec3f, material: u32) -> f32 {
    let alpha = vec2f(scene.materials[material].alpha, scene.materials[material].ior);
    let x = h.x / alpha.x;
    let y = h.y / alpha.y;
    let d = (x * x + y * y) + h.z * h.z;
    return 1.0 / (PI * alpha.x * alpha.y * d * d);
}

fn brushed_lambda(w: vec3f, material: u32) -> f32 {
    let x = w.x * scene.materials[material].alpha;
    let y = w.y * scene.materials[material].ior;
    return 0.5 * (sqrt(1.0 + (x * x + y * y) / (w.z * w.z)) - 1.0);
}

fn fresnel_of_brushed(lobe: Lobe, cos: f32) -> vec3f {
    let m = scene.materials[lobe.material];
    if m.first == 1u {
        return lobe.reflectance * fresnel_conductor(cos, m.eta, m.k);
    }
    return schlick(lobe.reflectance, cos);
}

fn mean_fresnel_of_brushed(lobe: Lobe) -> vec3f {
    if scene.materials[lobe.material].first == 1u {
        return scene.materials[lobe.material].mean_fresnel;
    }
    return lobe.reflectance * (20.0 / 21.0) + vec3f(1.0 / 21.0);
}

fn eval_brushed(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let material = lobe.material;
    let frame = grain(n, lobe.alpha);
    let o = vec3f(dot(wo, frame.t), dot(wo, frame.b), dot(wo, n));
    let i = vec3f(dot(wi, frame.t), dot(wi, frame.b), dot(wi, n));
    if o.z <= 0.0 || i.z <= 0.0 {
        return vec3f(0.0);
    }
    let h = unit(o + i);
    let g = 1.0 / (1.0 + brushed_lambda(o, material) + brushed_lambda(i, material));
    var f = fresnel_of_brushed(lobe, dot(o, h)) * (brushed_d(h, material) * g / (4.0 * o.z * i.z));
    if scene.materials[material].mean_albedo < 1.0 {
        let tint = select(vec3f(1.0), lobe.reflectance, scene.materials[material].first == 1u);
        f += tint * scattered_again(material, mean_fresnel_of_brushed(lobe), o.z, i.z);
    }
    return f * i.z;
}

//#if scene
fn grain_angle(hit: Hit, p: ShadingPoint) -> f32 {
    let tangents = tangents_at(hit, p.s);
    let f = basis(p.n);
    return arctan2(dot(tangents.u, f.b), dot(tangents.u, f.t));
}

fn pdf_brushed(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let material = lobe.material;
    let frame = grain(n, lobe.alpha);
    let o = vec3f(dot(wo, frame.t), dot(wo, frame.b), dot(wo, n));
    let i = vec3f(dot(wi, frame.t), dot(wi, frame.b), dot(wi, n));
    if o.z <= 0.0 || i.z <= 0.0 {
        return 0.0;
    }
    let d = brushed_d(unit(o + i), material);
    let pdf = d / (4.0 * o.z * (1.0 + brushed_lambda(o, material)));
    let again = again_share(material, o.z);
    return pdf * (1.0 - again) + again * pdf_cosine(n, wi);
}

fn again_share(material: u32, cos: f32) -> f32 {
    if scene.materials[material].mean_albedo < 1.0 {
        return 1.0 - facet_albedo(material, cos);
    }
    return 0.0;
}

fn brushed_normal(wo: vec3f, material: u32, u: vec2f) -> vec3f {
    let alpha = vec2f(scene.materials[material].alpha, scene.materials[material].ior);
    let vh = unit(vec3f(alpha.x * wo.x, alpha.y * wo.y, wo.z));
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
    return unit(vec3f(alpha.x * nh.x, alpha.y * nh.y, max(nh.z, 1e-6)));
}

fn sample_brushed(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let material = p.lobe.material;
    let frame = grain(p.n, p.lobe.alpha);
    let o = vec3f(dot(p.wo, frame.t), dot(p.wo, frame.b), dot(p.wo, p.n));
    let again = again_share(material, o.z);
    var direction: vec3f;
    if u.x < again {
        direction = from_frame(p.n, sample_cosine(vec2f(u.x / again, u.y)));
    } else {
        let x = clamp((u.x - again) / max(1.0 - again, 1e-6), 0.0, 1.0);
        let i = mirrored(o, brushed_normal(o, material, vec2f(x, u.y)));
        direction = (frame.t * i.x + frame.b * i.y) + p.n * i.z;
    }
    let wi = renormalized(direction);
    let pdf = pdf_brushed(p.lobe, p.n, p.wo, wi);
    var weight = vec3f(0.0);
    if pdf > 0.0 {
        weight = eval_brushed(p.lobe, p.n, p.wo, wi) * (facet_correction(p, wi, mode) / pdf);
    }
    return Sample(wi, weight);
}
//#end
