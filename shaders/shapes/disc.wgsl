// Flat disc and infinite plane. Twin: src/shapes/disc.rs.

//#if disc
fn intersect_disc(disc: Disc, reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let d = ray.origin - disc.center;
    let slope = dot(ray.direction, disc.normal);
    if slope == 0.0 {
        return;
    }
    let t = -dot(d, disc.normal) / slope;
    if !(t > ray.t_min && t < (*hit).t) {
        return;
    }
    let p = d + ray.direction * t;
    if dot(p, p) <= disc.radius * disc.radius {
        *hit = Hit(t, reference, 0.0, 0.0, NONE);
    }
}

fn disc_error(disc: Disc) -> f32 {
    return 16.0 * EPS * (max_abs(disc.center) + disc.radius);
}

fn disc_uv(disc: Disc, position: vec3f) -> vec2f {
    let f = basis(disc.normal);
    let d = (position - disc.center) * (0.5 / disc.radius);
    return vec2f(0.5 + dot(d, f.t), 0.5 + dot(d, f.b));
}
//#end

//#if plane
fn intersect_plane(plane: Plane, reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let slope = dot(ray.direction, plane.normal);
    if slope == 0.0 {
        return;
    }
    let t = -dot(ray.origin - plane.point, plane.normal) / slope;
    if t > ray.t_min && t < (*hit).t {
        *hit = Hit(t, reference, 0.0, 0.0, NONE);
    }
}

fn plane_error(plane: Plane, position: vec3f) -> f32 {
    return 16.0 * EPS * (max_abs(plane.point) + max_abs(position));
}
//#end

fn plane_project(position: vec3f, point: vec3f, normal: vec3f) -> vec3f {
    return position - normal * dot(position - point, normal);
}
