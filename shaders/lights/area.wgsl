// Area lights: shapes that emit evenly from the side of their normal. Twin: src/lights/area.rs.

fn light_from_area(light: Light, share: f32, position: vec3f, u: vec4f) -> LightSample {
    //#if area_sphere
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = scene.spheres[index_of(light.reference)];
        if pdf_sphere_cone(sphere, position) > 0.0 {
            let p = sample_sphere_cone(sphere, position, vec2f(u.y, u.z));
            let to = p.position + p.normal * p.error - position;
            let dist_sq = dot(to, to);
            if dist_sq == 0.0 {
                return NO_LIGHT;
            }
            let distance = sqrt(dist_sq);
            return LightSample(
                to * (1.0 / distance),
                distance * (1.0 - 16.0 * EPS),
                light.color,
                p.pdf * share,
                true,
            );
        }
    }
    //#end
    let p = sample_shape(light, vec2f(u.y, u.z), u.w);
    let to = p.position + p.normal * p.error - position;
    let dist_sq = dot(to, to);
    if dist_sq == 0.0 {
        return NO_LIGHT;
    }
    let distance = sqrt(dist_sq);
    let direction = to * (1.0 / distance);
    let cos = -dot(direction, p.normal);
    if cos <= 0.0 {
        return NO_LIGHT;
    }
    return LightSample(
        direction,
        distance * (1.0 - 16.0 * EPS),
        light.color,
        p.pdf * dist_sq / cos * share,
        true,
    );
}

fn pdf_area(
    shares: u32,
    index: u32,
    origin: vec3f,
    direction: vec3f,
    t: f32,
    normal: vec3f,
    v: f32,
) -> f32 {
    let light = scene.lights[index];
    let share = share_of(shares, index);
    //#if area_sphere
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = scene.spheres[index_of(light.reference)];
        let pdf = pdf_sphere_cone(sphere, origin);
        if pdf > 0.0 {
            return pdf * share;
        }
    }
    //#end
    let cos = abs(dot(direction, normal));
    return pdf_shape(light, v) * t * t / max(cos, 1e-12) * share;
}

//#if photon_trace
fn emit_area(light: Light, u: vec4f, across: vec2f) -> Emission {
    var ray = Ray(vec3f(0.0), 0.0, vec3f(0.0, 0.0, 1.0), FAR);
    //#if area_sphere
    if kind_of(light.reference) == KIND_SPHERE {
        ray.direction = sample_sphere(across);
        let p = sample_sphere_facing(light, vec2f(u.y, u.z), ray.direction);
        ray.origin = p.position + p.normal * p.error;
        let flux = light.color * (PI / (p.pdf * light.selection));
        return unguided(ray, flux);
    }
    //#end
    let p = sample_shape(light, vec2f(u.y, u.z), u.w);
    ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
    ray.origin = p.position + p.normal * p.error;
    let flux = light.color * (PI / (p.pdf * light.selection));
    return unguided(ray, flux);
}
//#end
