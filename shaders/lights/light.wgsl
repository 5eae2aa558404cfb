// Choice of a light and sampling of its direction from a surface point, with densities per solid
// angle. Twin: src/lights/light.rs.

struct LightSample {
    direction: vec3f,
    distance: f32,
    radiance: vec3f,
    pdf: f32,
    extended: bool,
}

fn find_interval(first: u32, count: u32, u: f32) -> u32 {
    // binary search without branches on the compared values, which are unpredictable
    var low = 0u;
    var length = count;
    while length > 1u {
        let half = length / 2u;
        low += select(half, 0u, scene.distributions[first + low + half - 1u] > u);
        length -= half;
    }
    return low;
}

fn sample_light(shares: u32, position: vec3f, u: vec4f) -> LightSample {
    let index = choose_light(shares, u.x);
    let share = share_of(shares, index);
    return sample_one_light(scene.lights[index], share, position, u);
}

fn sample_one_light(light: Light, share: f32, position: vec3f, u: vec4f) -> LightSample {
    let none = LightSample(vec3f(0.0, 0.0, 1.0), 0.0, vec3f(0.0), 1.0, true);
    //#if area
    if light.kind == LIGHT_AREA {
        //#if area_sphere
        if kind_of(light.reference) == KIND_SPHERE {
            let sphere = scene.spheres[index_of(light.reference)];
            if pdf_sphere_cone(sphere, position) > 0.0 {
                let p = sample_sphere_cone(sphere, position, vec2f(u.y, u.z));
                let to = p.position + p.normal * p.error - position;
                let dist_sq = dot(to, to);
                if dist_sq == 0.0 {
                    return none;
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
            return none;
        }
        let distance = sqrt(dist_sq);
        let direction = to * (1.0 / distance);
        let cos = -dot(direction, p.normal);
        if cos <= 0.0 {
            return none;
        }
        return LightSample(
            direction,
            distance * (1.0 - 16.0 * EPS),
            light.color,
            p.pdf * dist_sq / cos * share,
            true,
        );
    }
    //#end
    //#if point || spot
    if light.kind == LIGHT_POINT || light.kind == LIGHT_SPOT {
        let to = light.position - position;
        let dist_sq = dot(to, to);
        if dist_sq == 0.0 {
            return none;
        }
        let distance = sqrt(dist_sq);
        let direction = to * (1.0 / distance);
        var radiance = light.color * (1.0 / dist_sq);
        //#if spot
        if light.kind == LIGHT_SPOT {
            // half the squared chord: near the axis 1 - cos loses all digits
            let chord = direction + light.direction;
            radiance *= spot_falloff(light, 0.5 * dot(chord, chord));
        }
        //#end
        return LightSample(direction, distance * (1.0 - 16.0 * EPS), radiance, share, false);
    }
    //#end
    //#if infinite
    if light.kind == LIGHT_SUN {
        return LightSample(-light.direction, FAR, light.color, share, false);
    }
    //#end
    //#if environment
    let direction = sample_environment(light, u);
    return LightSample(
        direction,
        FAR,
        eval_environment(light, direction),
        pdf_environment(light, direction) * share,
        true,
    );
    //#else
    return none;
    //#end
}

//#if spot
fn spot_falloff(light: Light, versine: f32) -> f32 {
    if versine <= light.inner {
        return 1.0;
    }
    if versine >= light.outer {
        return 0.0;
    }
    let x = (light.outer - versine) / (light.outer - light.inner);
    return x * x * (3.0 - 2.0 * x);
}
//#end

//#if area
fn pdf_light(shares: u32, index: u32, origin: vec3f, direction: vec3f, t: f32, normal: vec3f, v: f32) -> f32 {
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
//#end

//#if environment
//#if environment_image
fn environment_uv(light: Light, direction: vec3f) -> vec2f {
    let x = light.outer * direction.x - light.inner * direction.z;
    let z = light.inner * direction.x + light.outer * direction.z;
    let r = sqrt(x * x + z * z);
    return vec2f(0.5 - arctan2(z, x) * (1.0 / TAU), 1.0 - arctan2(r, direction.y) * (1.0 / PI));
}
//#end

fn eval_environment(light: Light, direction: vec3f) -> vec3f {
    //#if environment_image
    if light.kind == LIGHT_CONSTANT {
        return light.color;
    }
    return light.color * eval_texture(light.reference, environment_uv(light, direction));
    //#else
    return light.color;
    //#end
}

fn sample_environment(light: Light, u: vec4f) -> vec3f {
    //#if environment_image
    if light.kind == LIGHT_CONSTANT {
        return sample_sphere(vec2f(u.y, u.z));
    }
    let texture = scene.textures[light.reference];
    let row = find_interval(light.first, texture.height, u.y);
    let column = find_interval(light.first + texture.height + row * texture.width, texture.width, u.z);
    // offset in the row from the lower bits of u.w: what is left of u.y gives few distinct offsets
    // in rows of low probability
    let fine = u.w * 4096.0;
    let across = (f32(column) + u.w) / f32(texture.width);
    let down = (f32(row) + (fine - floor(fine))) / f32(texture.height);
    let phi = sin_cos((0.5 - across) * TAU);
    let theta = sin_cos(down * PI);
    let x = theta.x * phi.y;
    let z = theta.x * phi.x;
    return vec3f(
        light.outer * x + light.inner * z,
        theta.y,
        light.outer * z - light.inner * x,
    );
    //#else
    return sample_sphere(vec2f(u.y, u.z));
    //#end
}

fn pdf_environment(light: Light, direction: vec3f) -> f32 {
    //#if environment_image
    if light.kind == LIGHT_CONSTANT {
        return PDF_SPHERE;
    }
    let texture = scene.textures[light.reference];
    let uv = environment_uv(light, direction);
    let row = min(u32(floor((1.0 - uv.y) * f32(texture.height))), texture.height - 1u);
    let column = min(u32(floor(uv.x * f32(texture.width))), texture.width - 1u);
    let p = pdf_bin(light.first, row, texture.height)
        * pdf_bin(light.first + texture.height + row * texture.width, column, texture.width);
    // from x and z: near a pole 1 - y^2 loses all digits
    let sin = sqrt(max(direction.x * direction.x + direction.z * direction.z, 1e-12));
    return p / (2.0 * PI * PI * sin);
    //#else
    return PDF_SPHERE;
    //#end
}
//#end
