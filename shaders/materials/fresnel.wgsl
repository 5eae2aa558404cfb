// Fresnel terms. Twin: src/materials/fresnel.rs.

fn schlick(f0: vec3f, cos: f32) -> vec3f {
    let m = max(1.0 - cos, 0.0);
    let m2 = m * m;
    return f0 + (vec3f(1.0) - f0) * (m2 * m2 * m);
}

struct Interface {
    reflectance: f32,
    cos_t: f32,
}

fn fresnel(cos_i: f32, eta: f32) -> Interface {
    // as a product: 1 - cos^2 loses all digits near the normal, where dense glass has its critical
    // angle
    let sin_t_sq = eta * eta * max((1.0 - cos_i) * (1.0 + cos_i), 0.0);
    if sin_t_sq >= 1.0 {
        return Interface(1.0, 0.0);
    }
    let cos_t = sqrt(1.0 - sin_t_sq);
    let parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return Interface(0.5 * (parallel * parallel + perpendicular * perpendicular), cos_t);
}

fn refracted(wo: vec3f, n: vec3f, cos_i: f32, cos_t: f32, eta: f32) -> vec3f {
    return n * (eta * cos_i - cos_t) - wo * eta;
}

fn fresnel_conductor(cos: f32, eta: vec3f, k: vec3f) -> vec3f {
    let cos_sq = cos * cos;
    let sin_sq = max(1.0 - cos_sq, 0.0);
    let base = (eta - k) * (eta + k) - vec3f(sin_sq);
    let crossed = eta * k;
    let root = base * base + 4.0 * (crossed * crossed);
    // a^2 + b^2 and a, where a + ib is the cosine inside times the index
    let sum = sqrt(root);
    let half = (sum + base) * 0.5;
    let a = sqrt(max(half, vec3f(0.0)));
    let outer = sum + vec3f(cos_sq);
    let inner = a * (2.0 * cos);
    let perpendicular = (outer - inner) / (outer + inner);
    let long = sum * cos_sq + vec3f(sin_sq * sin_sq);
    let short = inner * sin_sq;
    // the parallel part is that fraction of the perpendicular one
    let fraction = (long - short) / (long + short);
    return perpendicular * (vec3f(0.5) + 0.5 * fraction);
}
