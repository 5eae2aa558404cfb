// Area lights: shapes that emit from the side of their normal, or from both sides. Twin: src/lights/area.rs.

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
            //#if glow
            let radiance = glow_at_sample(light, p, vec2f(0.0), 0.0);
            //#else
            let radiance = light.color;
            //#end
            return LightSample(
                to * (1.0 / distance),
                distance * (1.0 - 16.0 * EPS),
                radiance,
                p.pdf * share,
                true,
            );
        }
    }
    //#end
    //#if glow
    let w = warped(light, u);
    var p = sample_shape(light, w.across, w.pick);
    p.pdf *= w.pdf;
    let radiance = glow_at_sample(light, p, w.across, w.pick);
    //#else
    var p = sample_shape(light, vec2f(u.y, u.z), u.w);
    let radiance = light.color;
    //#end
    //#if two_sided
    if (light.flags & LIGHT_TWO_SIDED) != 0u && dot(position - p.position, p.normal) < 0.0 {
        p.normal = -p.normal;
    }
    //#end
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
        radiance,
        p.pdf * dist_sq / cos * share,
        true,
    );
}

fn eval_area(s: Surface, direction: vec3f) -> vec3f {
    let light = scene.lights[s.light];
    var shines = dot(direction, s.normal) < 0.0;
    //#if two_sided
    shines |= (light.flags & LIGHT_TWO_SIDED) != 0u;
    //#end
    if !shines {
        return vec3f(0.0);
    }
    //#if glow
    return glow_at_surface(light, s);
    //#else
    return light.color;
    //#end
}

fn pdf_area(shares: u32, origin: vec3f, direction: vec3f, t: f32, s: Surface) -> f32 {
    let light = scene.lights[s.light];
    let share = share_of(shares, s.light);
    //#if area_sphere
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = scene.spheres[index_of(light.reference)];
        let pdf = pdf_sphere_cone(sphere, origin);
        if pdf > 0.0 {
            return pdf * share;
        }
    }
    //#end
    let cos = abs(dot(direction, s.normal));
    var pdf = pdf_shape(light, s.v);
    //#if glow
    pdf *= pdf_map(light, s.uv);
    //#end
    return pdf * t * t / max(cos, 1e-12) * share;
}

//#if photon_trace
fn emit_area(light: Light, u: vec4f, across: vec2f, side: f32) -> Emission {
    //#if two_sided
    let two_sided = (light.flags & LIGHT_TWO_SIDED) != 0u;
    let behind = two_sided && side < 0.5;
    let sides = select(1.0, 2.0, two_sided);
    //#else
    let behind = false;
    let sides = 1.0;
    //#end
    var ray = Ray(vec3f(0.0), 0.0, vec3f(0.0, 0.0, 1.0), FAR);
    //#if area_sphere
    if kind_of(light.reference) == KIND_SPHERE {
        ray.direction = sample_sphere(across);
        let facing = select(ray.direction, -ray.direction, behind);
        let p = sample_sphere_facing(light, vec2f(u.y, u.z), facing);
        ray.origin = p.position + select(p.normal, -p.normal, behind) * p.error;
        //#if glow
        let radiance = glow_at_sample(light, p, vec2f(0.0), 0.0);
        //#else
        let radiance = light.color;
        //#end
        let flux = radiance * (sides * PI / (p.pdf * light.selection));
        return unguided(ray, flux);
    }
    //#end
    //#if glow
    let w = warped(light, u);
    var p = sample_shape(light, w.across, w.pick);
    p.pdf *= w.pdf;
    let radiance = glow_at_sample(light, p, w.across, w.pick);
    //#else
    var p = sample_shape(light, vec2f(u.y, u.z), u.w);
    let radiance = light.color;
    //#end
    if behind {
        p.normal = -p.normal;
    }
    ray.direction = unit(from_frame(p.normal, sample_cosine(across)));
    ray.origin = p.position + p.normal * p.error;
    let flux = radiance * (sides * PI / (p.pdf * light.selection));
    return unguided(ray, flux);
}
//#end
