// Sphere of any radius, described relative to an anchor on its surface. Twin: src/shapes/sphere.rs,
// which gives the equation.

fn intersect_sphere(sphere: Sphere, reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let k = sphere.curvature;
    let d0 = ray.origin - sphere.anchor;
    let side = dot(d0, sphere.normal) + 0.5 * k * dot(d0, d0);
    // rays from infinity start behind their origin, so the side of the origin is irrelevant
    let backward = ray.t_min < 0.0;
    if !backward
        && side >= 0.0
        && dot(ray.direction, sphere.normal) + k * dot(d0, ray.direction) >= 0.0 {
        return;
    }
    // solve from the point of the ray nearest to the anchor: small numbers however distant the
    // origin
    let t0 = -dot(d0, ray.direction);
    let d = d0 + ray.direction * t0;
    let b = dot(ray.direction, sphere.normal) + k * dot(d, ray.direction);
    let c = dot(d, sphere.normal) + 0.5 * k * dot(d, d);
    // roots of the quadratic without cancellation
    let discriminant = b * b - 2.0 * k * c;
    if discriminant < 0.0 {
        return;
    }
    let root = sqrt(discriminant);
    let q = select(root - b, -(b + root), b >= 0.0);
    let t1 = q / k;
    var t2 = t1;
    if q != 0.0 {
        t2 = 2.0 * c / q;
    }
    let near = t0 + min(t1, t2);
    let far = t0 + max(t1, t2);
    let from_outside = select(side >= 0.0, near > ray.t_min, backward);
    let t = select(far, near, from_outside);
    if t > ray.t_min && t < (*hit).t {
        *hit = Hit(t, reference, 0.0, 0.0, NONE);
    }
}

fn sphere_normal(sphere: Sphere, position: vec3f) -> vec3f {
    return unit(sphere.normal + (position - sphere.anchor) * sphere.curvature);
}

fn sphere_project(sphere: Sphere, position: vec3f) -> vec3f {
    let d = position - sphere.anchor;
    let c = dot(d, sphere.normal) + 0.5 * sphere.curvature * dot(d, d);
    return position - sphere_normal(sphere, position) * c;
}

fn sphere_error(sphere: Sphere, position: vec3f) -> f32 {
    return 16.0 * EPS * (max_abs(sphere.anchor) + max_abs(position - sphere.anchor));
}

fn sphere_uv(n: vec3f) -> vec2f {
    let r = sqrt(n.x * n.x + n.z * n.z);
    return vec2f(0.5 - arctan2(n.z, n.x) * (1.0 / TAU), 0.5 + arctan2(n.y, r) * (1.0 / PI));
}
