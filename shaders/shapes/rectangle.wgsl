// Parallelogram. Twin: src/shapes/rectangle.rs.

const EDGE: f32 = 8.0 * EPS;

fn intersect_rectangle(rectangle: Rectangle, reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let d = ray.origin - rectangle.origin;
    let slope = dot(ray.direction, rectangle.normal);
    if slope == 0.0 {
        return;
    }
    let t = -dot(d, rectangle.normal) / slope;
    if !(t > ray.t_min && t < (*hit).t) {
        return;
    }
    let p = d + ray.direction * t;
    let s = dot(p, rectangle.dual_u);
    let r = dot(p, rectangle.dual_v);
    if s >= -EDGE && s <= 1.0 + EDGE && r >= -EDGE && r <= 1.0 + EDGE {
        *hit = Hit(t, reference, s, r, NONE);
    }
}

fn rectangle_point(rectangle: Rectangle, s: f32, t: f32) -> vec3f {
    return rectangle.origin + rectangle.u * s + rectangle.v * t;
}

fn rectangle_error(rectangle: Rectangle) -> f32 {
    return 16.0 * EPS * (max_abs(rectangle.origin) + max_abs(rectangle.u) + max_abs(rectangle.v));
}
