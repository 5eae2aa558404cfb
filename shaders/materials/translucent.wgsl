// Diffuse reflection and transmission by a thin surface. Twin: src/materials/translucent.rs.

fn side_share(alpha: f32, cos: f32) -> f32 {
    return select(alpha, 1.0 - alpha, cos > 0.0);
}

fn eval_translucent(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    let cos = dot(wi, n);
    return lobe.reflectance * (INV_PI * abs(cos) * side_share(lobe.alpha, cos));
}

fn pdf_translucent(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> f32 {
    let cos = dot(wi, n);
    return INV_PI * abs(cos) * side_share(lobe.alpha, cos);
}

//#if scene
fn sample_translucent(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let alpha = p.lobe.alpha;
    let sent = cosine_axis(p, mode);
    var weight = sent.weight;
    // choose the side and stretch the number that chose it to [0, 1]
    var x = (u.x - alpha) / max(1.0 - alpha, 1e-6);
    var side = 1.0;
    if u.x < alpha {
        x = u.x / alpha;
        side = -1.0;
    }
    let local = sample_cosine(vec2f(clamp(x, 0.0, 1.0), u.y));
    let wi = renormalized(from_frame(sent.axis, vec3f(local.x, local.y, local.z * side)));
    if dot(wi, p.ng) * side <= 0.0 {
        weight = vec3f(0.0);
    }
    return Sample(wi, weight);
}
//#end
