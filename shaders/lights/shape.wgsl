// Sampling of points on emitting shapes. Twin: src/lights/shape.rs.

struct ShapePoint {
    position: vec3f,
    error: f32,
    normal: vec3f,
    pdf: f32,
}

//#if area_sphere && photon_trace
fn sample_sphere_facing(light: Light, u: vec2f, direction: vec3f) -> ShapePoint {
    let sphere = scene.spheres[index_of(light.reference)];
    let d = sample_disc(u);
    let n = unit(from_frame(direction, vec3f(d.x, d.y, sqrt(1.0 - u.x))));
    let center = sphere.anchor - sphere.normal * sphere.radius;
    let p = sphere_project(sphere, center + n * sphere.radius);
    return ShapePoint(p, sphere_error(sphere, p), n, 1.0 / light.area);
}
//#end

//#if area
fn sample_shape(light: Light, u: vec2f, w: f32) -> ShapePoint {
    let index = index_of(light.reference);
    let pdf = 1.0 / light.area;
    switch kind_of(light.reference) {
        //#if area_triangle
        case KIND_TRIANGLE: {
            let triangle = triangles[index];
            let b = sample_triangle(u);
            return ShapePoint(
                triangle_point(triangle, b.x, b.y),
                triangle_error(triangle),
                triangle_normal(triangle),
                pdf,
            );
        }
        //#end
        //#if area_sphere
        case KIND_SPHERE: {
            let sphere = scene.spheres[index];
            let n = sample_sphere(u);
            let center = sphere.anchor - sphere.normal * sphere.radius;
            let p = sphere_project(sphere, center + n * sphere.radius);
            return ShapePoint(p, sphere_error(sphere, p), n, pdf);
        }
        //#end
        //#if area_rectangle
        case KIND_RECTANGLE: {
            let rectangle = scene.rectangles[index];
            return ShapePoint(
                rectangle_point(rectangle, u.x, u.y),
                rectangle_error(rectangle),
                rectangle.normal,
                pdf,
            );
        }
        //#end
        //#if area_disc
        case KIND_DISC: {
            let disc = scene.discs[index];
            let d = sample_disc(u) * disc.radius;
            let f = basis(disc.normal);
            return ShapePoint(
                disc.center + f.t * d.x + f.b * d.y,
                disc_error(disc),
                disc.normal,
                pdf,
            );
        }
        //#end
        //#if area_cuboid
        case KIND_CUBOID: {
            let cuboid = scene.cuboids[index];
            let e = cuboid.upper - cuboid.lower;
            let x = e.y * e.z;
            let y = e.z * e.x;
            // choose a pair of opposite faces by area, then one of the two
            let pick = w * light.area;
            let upper = select(0.0, 3.0, u.x < 0.5);
            let s = select(2.0 * u.x - 1.0, 2.0 * u.x, u.x < 0.5);
            let axis = select(select(2.0, 1.0, pick < 2.0 * (x + y)), 0.0, pick < 2.0 * x);
            let n = cuboid_normal(axis + upper);
            let face = upper * (1.0 / 3.0);
            var q = vec3f(s, u.y, face);
            if axis == 0.0 {
                q = vec3f(face, u.y, s);
            } else if axis == 1.0 {
                q = vec3f(s, face, u.y);
            }
            return ShapePoint(cuboid.lower + e * q, cuboid_error(cuboid), n, pdf);
        }
        //#end
        //#if area_revolution
        case KIND_REVOLUTION: {
            let k = find_interval(light.first + light.patch_count, light.patch_count, w);
            let start = scene.distributions[light.first + k];
            let end = patch_end(light, k);
            let v = start + (end - start) * u.x;
            let r = patch_point(light, k, v, TAU * u.y - PI);
            return ShapePoint(
                r.position,
                r.error,
                r.normal,
                pdf_patch(light, k, end - start) / max(r.stretch, 1e-30),
            );
        }
        //#end
        default: {
            return ShapePoint(vec3f(0.0), 0.0, vec3f(0.0, 0.0, 1.0), pdf);
        }
    }
}
//#end

//#if area_revolution
struct PatchPoint {
    position: vec3f,
    error: f32,
    normal: vec3f,
    stretch: f32,
}

fn patch_end(light: Light, k: u32) -> f32 {
    if k + 1u < light.patch_count {
        return scene.distributions[light.first + k + 1u];
    }
    return 1.0;
}

fn patch_point(light: Light, k: u32, v: f32, theta: f32) -> PatchPoint {
    let patch_data = scene.patches[light.patch_first + k];
    let revolution = scene.revolutions[patch_data.revolution];
    let t = v * f32(revolution.segments) - f32(patch_data.segment);
    let tau = clamp((t - patch_data.t0) / (patch_data.t1 - patch_data.t0), 0.0, 1.0);
    let s = revolution_surface(revolution, patch_data, theta, tau);
    let ring = ring_point(patch_data, theta, tau);
    let by_v = ring.d_tau * (f32(revolution.segments) / (patch_data.t1 - patch_data.t0));
    let stretch = cross(ring.d_theta, by_v);
    return PatchPoint(
        s.position,
        s.error,
        s.normal,
        sqrt(dot(stretch, stretch)) * (TAU * revolution.scale * revolution.scale),
    );
}

fn pdf_patch(light: Light, k: u32, width: f32) -> f32 {
    let at = light.first + light.patch_count + k;
    var low = 0.0;
    if k > 0u {
        low = scene.distributions[at - 1u];
    }
    return (scene.distributions[at] - low) / width;
}
//#end

//#if environment_image || profile || glow || guided && photon_trace
fn pdf_bin(first: u32, bin: u32, count: u32) -> f32 {
    let high = scene.distributions[first + bin];
    var low = 0.0;
    if bin > 0u {
        low = scene.distributions[first + bin - 1u];
    }
    return (high - low) * f32(count);
}
//#end

fn pdf_shape(light: Light, v: f32) -> f32 {
    //#if area_revolution
    if kind_of(light.reference) == KIND_REVOLUTION {
        // last patch whose part starts at or before v
        var k = find_interval(light.first, light.patch_count, v);
        if k > 0u && scene.distributions[light.first + k] > v {
            k -= 1u;
        }
        let start = scene.distributions[light.first + k];
        let end = patch_end(light, k);
        let r = patch_point(light, k, v, 0.0);
        return pdf_patch(light, k, end - start) / max(r.stretch, 1e-30);
    }
    //#end
    return 1.0 / light.area;
}

//#if area_sphere
fn sample_sphere_cone(sphere: Sphere, origin: vec3f, u: vec2f) -> ShapePoint {
    let center = sphere.anchor - sphere.normal * sphere.radius;
    let d = center - origin;
    let dist_sq = dot(d, d);
    let sin_sq = sphere.radius * sphere.radius / dist_sq;
    let one_minus_cos = cone_one_minus_cos(sin_sq);
    let local = sample_cone(u, one_minus_cos);
    let w = from_frame(unit(d), local);
    // nearest crossing of the ray with the sphere, clamped at the tangent; computed from the sine,
    // since the distances to the centre and the rim of a small sphere differ by less than a
    // rounding
    let along = sqrt(dist_sq) * local.z;
    let off_sq = (local.x * local.x + local.y * local.y) / sin_sq;
    let half = sphere.radius * sqrt(max(1.0 - off_sq, 0.0));
    let p = sphere_project(sphere, origin + w * (along - half));
    return ShapePoint(p, sphere_error(sphere, p), unit(p - center), 1.0 / (TAU * one_minus_cos));
}

fn cone_one_minus_cos(sin_sq: f32) -> f32 {
    return sin_sq / (1.0 + sqrt(max(1.0 - sin_sq, 0.0)));
}

fn pdf_sphere_cone(sphere: Sphere, origin: vec3f) -> f32 {
    let d = sphere.anchor - sphere.normal * sphere.radius - origin;
    let sin_sq = sphere.radius * sphere.radius / dot(d, d);
    if sin_sq >= 1.0 {
        return 0.0;
    }
    return 1.0 / max(TAU * cone_one_minus_cos(sin_sq), 1.0 / FAR);
}
//#end
