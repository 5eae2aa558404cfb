// Axis-parallel box, intersected by slabs. Twin: src/shapes/cuboid.rs.

fn intersect_cuboid(cuboid: Cuboid, reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    var near = -FAR;
    var far = FAR;
    var near_face = 0.0;
    var far_face = 0.0;
    for (var axis = 0u; axis < 3u; axis++) {
        let v = ray.direction[axis];
        let a = cuboid.lower[axis] - ray.origin[axis];
        let b = cuboid.upper[axis] - ray.origin[axis];
        if v == 0.0 {
            if a > 0.0 || b < 0.0 {
                return;
            }
            continue;
        }
        let upward = v > 0.0;
        let t0 = select(b, a, upward) / v;
        let t1 = select(a, b, upward) / v;
        let face = f32(axis);
        if t0 > near {
            near = t0;
            near_face = select(face + 3.0, face, upward);
        }
        if t1 < far {
            far = t1;
            far_face = select(face, face + 3.0, upward);
        }
    }
    if near > far {
        return;
    }
    let from_outside = near > ray.t_min;
    let t = select(far, near, from_outside);
    if t > ray.t_min && t < (*hit).t {
        *hit = Hit(t, reference, select(far_face, near_face, from_outside), 0.0, NONE);
    }
}

fn cuboid_axis(face: f32) -> u32 {
    return u32(face) % 3u;
}

fn cuboid_normal(face: f32) -> vec3f {
    let s = select(-1.0, 1.0, face >= 3.0);
    let axis = select(face, face - 3.0, face >= 3.0);
    return vec3f(
        select(0.0, s, axis == 0.0),
        select(0.0, s, axis == 1.0),
        select(0.0, s, axis == 2.0),
    );
}

fn cuboid_project(cuboid: Cuboid, position: vec3f, face: f32) -> vec3f {
    let n = cuboid_normal(face);
    let corner = select(cuboid.lower, cuboid.upper, face >= 3.0);
    return position + (corner - position) * abs(n);
}

fn cuboid_error(cuboid: Cuboid) -> f32 {
    return 16.0 * EPS * max(max_abs(cuboid.lower), max_abs(cuboid.upper));
}

fn cuboid_uv(cuboid: Cuboid, position: vec3f, face: f32) -> vec2f {
    let q = (position - cuboid.lower) / (cuboid.upper - cuboid.lower);
    let n = cuboid_normal(face);
    if n.x != 0.0 {
        return vec2f(select(q.z, 1.0 - q.z, n.x > 0.0), q.y);
    }
    if n.y != 0.0 {
        return vec2f(q.x, select(q.z, 1.0 - q.z, n.y > 0.0));
    }
    return vec2f(select(1.0 - q.x, q.x, n.z > 0.0), q.y);
}
