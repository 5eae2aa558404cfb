// Emission of photons from suns and environments. Twin: src/lights/infinity.rs.

fn emit_from_infinity(light: Light, u: vec4f, v: vec4f) -> Emission {
    let near = scene.world.near_radius;
    var ray = Ray(vec3f(0.0), 0.0, light.direction, FAR);
    var radiance = light.color;
    //#if environment
    if is_environment(light.kind) {
        let w = sample_environment(light, u);
        ray.direction = -w;
        radiance = eval_environment(light, w) * (1.0 / pdf_environment(light, w));
    }
    //#end
    //#if sun_disc
    if light.kind == LIGHT_SUN_DISC {
        ray.direction = -sample_sun_disc(light, u);
        radiance = light.color * (1.0 / pdf_sun_disc(light));
    }
    //#end
    // choose a point on a disc or in the map's square
    let across = vec2f(v.x, v.y);
    let level = find_interval(scene.world.disc_first, scene.world.disc_levels, v.z);
    var d = sample_disc(across) * disc_radius(level);
    //#if guided
    if light.guide != 0u && v.w < GUIDED {
        d = guided(light, across, v.w * (1.0 / GUIDED)).across;
        d = (d * 2.0 - vec2f(1.0)) * near;
    }
    //#end
    // density per area of that point
    var pdf = pdf_discs(dot(d, d));
    //#if guided
    if light.guide != 0u {
        let by_map = pdf_guide(light, (d * (1.0 / near) + vec2f(1.0)) * 0.5) / (4.0 * near * near);
        pdf = GUIDED * by_map + (1.0 - GUIDED) * pdf;
    }
    //#end
    // start far behind the plane of the discs
    let f = basis(ray.direction);
    ray.origin = scene.world.near_center + f.t * d.x + f.b * d.y;
    ray.t_min = -4.0 * disc_radius(scene.world.disc_levels - 1u);
    let flux = radiance * (1.0 / (pdf * light.selection));
    let usual = pdf_discs(0.25 * near * near);
    return Emission(ray, flux, usual / pdf, interior_from(ray.direction), false);
}

fn disc_radius(level: u32) -> f32 {
    return scene.world.disc_radius * f32(1u << level);
}

fn pdf_discs(r_sq: f32) -> f32 {
    var radius = scene.world.disc_radius;
    var sum = 0.0;
    for (var level = 0u; level < scene.world.disc_levels; level++) {
        if r_sq <= radius * (radius * (1.0 + 16.0 * EPS)) {
            sum += share_of(scene.world.disc_first, level) / (PI * radius * radius);
        }
        radius *= 2.0;
    }
    return sum;
}
