// Direct light at a rough surface, and absorption along a ray. Twin: src/kernels/direct.rs, which
// explains the method.

fn transmittance(medium: u32, distance: f32) -> vec3f {
    //#if absorption
    if medium == NONE {
        return vec3f(1.0);
    }
    let depth = scene.materials[medium].absorption * -distance;
    return vec3f(exponential(depth.x), exponential(depth.y), exponential(depth.z));
    //#else
    return vec3f(1.0);
    //#end
}

// Adds to the ray count of the pass, carrying from the low to the high word.
fn count_rays(rays: u32) {
    let low = atomicAdd(&counters.rays_low, rays);
    if low + rays < low {
        atomicAdd(&counters.rays_high, 1u);
    }
}

//#if sampled
struct DirectLight {
    radiance: vec3f,
    rays: u32,
}

fn next_event(p: ShadingPoint, interior: Interior, mis: bool, u: vec4f) -> DirectLight {
    var origin = p.s.position + p.ng * p.s.error;
    let light = sample_light(shares_at(p.s.position), origin, u);
    let behind = dot(light.direction, p.ng) <= 0.0;
    if (behind && !transmits(p.lobe.bsdf)) || max_component(light.radiance) <= 0.0 {
        return DirectLight(vec3f(0.0), 0u);
    }
    let f = eval_rough(p.lobe, p.n, p.wo, light.direction);
    if max_component(f) <= 0.0 {
        return DirectLight(vec3f(0.0), 0u);
    }
    //#if lobes
    if behind {
        origin = p.s.position - p.ng * p.s.error;
    }
    //#end
    let ray = Ray(origin, 0.0, light.direction, light.distance);
    if occluded(ray) {
        return DirectLight(vec3f(0.0), 1u);
    }
    var weight = 1.0 / light.pdf;
    //#if lobes
    if mis && light.extended {
        weight *= balance(light.pdf, pdf_rough(p.lobe, p.n, p.wo, light.direction));
    }
    //#end
    var radiance = f * light.radiance * weight;
    if light.distance < FAR {
        var medium = medium_of(interior);
        //#if rough_glass
        if behind && is_body(p.lobe.bsdf) {
            medium = medium_of(interior_beyond(p.s, p.wo, interior));
        }
        //#end
        radiance *= transmittance(medium, light.distance);
    }
    return DirectLight(radiance, 1u);
}

fn direct_light(p: ShadingPoint, interior: Interior, rng: ptr<function, Rng>) -> DirectLight {
    // for narrow lobes, scattered rays find large lights with less noise
    let narrow = !is_wide(p.lobe.bsdf);
    var direct = next_event(p, interior, narrow, rng_next(rng));
    //#if lobes
    if narrow {
        let u = rng_next(rng);
        let scattered = scatter_rough(p, interior, u.xyz, RADIANCE);
        if max_component(scattered.weight) > 0.0 {
            direct.rays += 1u;
            let pdf = pdf_rough(p.lobe, p.n, p.wo, scattered.direction);
            let start = offset_origin(p.s.position, p.s.error, p.ng, scattered.direction);
            let ray = Ray(start, 0.0, scattered.direction, FAR);
            let hit = intersect_scene(ray);
            let shares = shares_at(p.s.position);
            if hit.reference == NONE {
                //#if environment
                if scene.world.environment != NONE {
                    let sky = scene.world.environment;
                    let light = scene.lights[sky];
                    let share = share_of(shares, sky);
                    let other = pdf_environment(light, ray.direction) * share;
                    let seen = eval_environment(light, ray.direction);
                    direct.radiance += scattered.weight * seen * balance(pdf, other);
                }
                //#end
                //#if sun_disc
                var sun = scene.world.sun_discs;
                while sun != NONE {
                    let light = scene.lights[sun];
                    if in_sun_disc(light, ray.direction) {
                        let other = pdf_sun_disc(light) * share_of(shares, sun);
                        direct.radiance += scattered.weight * light.color * balance(pdf, other);
                    }
                    sun = light.reference;
                }
                //#end
            } else {
                //#if area
                let at = surface_at(ray, hit);
                if at.light != NONE && dot(ray.direction, at.normal) < 0.0 {
                    let light = scene.lights[at.light];
                    let other = pdf_area(
                        shares, at.light, start, ray.direction, hit.t, at.normal, at.v
                    );
                    let medium = medium_of(scattered.interior);
                    let seen = light.color * transmittance(medium, hit.t);
                    direct.radiance += scattered.weight * seen * balance(pdf, other);
                }
                //#end
            }
        }
    }
    //#end
    return direct;
}
//#end
