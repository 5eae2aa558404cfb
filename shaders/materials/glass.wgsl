// Smooth dielectric: twin of src/materials/glass.rs.

struct Interface {
    reflectance: f32,
    cos_t: f32,
}

fn fresnel(cos_i: f32, eta: f32) -> Interface {
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
