// Redirection of photons that scatter far from the scene back towards it. Twin: src/lights/aim.rs,
// which explains the method.

const FAR_OUTSIDE_SQ: f32 = 4.0;

fn aimed_scatter(at: ShadingPoint, u: vec4f, scattered: Scatter) -> Scatter {
    let p = at.s.position - scene.world.near_center;
    let distance_sq = dot(p, p);
    let radius_sq = scene.world.near_radius * scene.world.near_radius;
    if at.lobe.bsdf != MATERIAL_DIFFUSE || distance_sq < FAR_OUTSIDE_SQ * radius_sq {
        return scattered;
    }
    let axis = -unit(p);
    let sin_sq = radius_sq / distance_sq;
    let one_minus_cos = sin_sq / (1.0 + sqrt(1.0 - sin_sq));
    var wi = scattered.direction;
    var in_cone = true;
    if u.z < 0.5 {
        wi = unit(from_frame(axis, sample_cone(u.xy, one_minus_cos)));
    } else {
        // test by the sine: the cosine of a narrow cone loses all digits
        let across = cross(wi, axis);
        in_cone = dot(wi, axis) > 0.0 && dot(across, across) < sin_sq;
    }
    let cos = dot(wi, at.ng);
    if cos <= 0.0 {
        return Scatter(wi, scattered.interior, vec3f(0.0));
    }
    let by_cosine = INV_PI * cos;
    let by_cone = select(0.0, 1.0 / (TAU * one_minus_cos), in_cone);
    let weight = scattered.weight * (by_cosine / (0.5 * by_cosine + 0.5 * by_cone));
    return Scatter(wi, scattered.interior, weight);
}
