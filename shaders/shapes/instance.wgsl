// Instances: groups of shapes in object space, placed by affine maps. Twin:
// src/shapes/instance.rs, which documents the fields and explains the method.

struct Instance {
    row_x: vec3f,
    group: u32,
    row_y: vec3f,
    material: u32,
    row_z: vec3f,
    uv: u32,
    center: vec3f,
    reach: f32,
    column_x: vec3f,
    rounding: f32,
    column_y: vec3f,
    pad0: u32,
    column_z: vec3f,
    pad1: u32,
    slack: vec3f,
    pad2: u32,
}

struct Group {
    bounds_min: vec3f,
    root: u32,
    bounds_max: vec3f,
    first_ref: u32,
    primitive_size: f32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

struct ObjectRay {
    ray: Ray,
    start: f32,
    length: f32,
}

fn leading_part(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

fn object_ray(instance: Instance, ray: Ray, t_max: f32) -> ObjectRay {
    // move a distant origin in front of the bounding sphere: distance and direction are split so
    // that no product rounds
    let d = ray.direction;
    let high = vec3f(leading_part(d.x), leading_part(d.y), leading_part(d.z));
    let low = d - high;
    let ahead = leading_part(dot(instance.center - ray.origin, d));
    let near = leading_part(ahead - instance.reach);
    let moved = near > ray.t_min;
    let start = select(0.0, near, moved);
    let p = ((ray.origin + high * start) - instance.center) + low * start;
    let origin = vec3f(dot(instance.row_x, p), dot(instance.row_y, p), dot(instance.row_z, p));
    let direction = vec3f(dot(instance.row_x, d), dot(instance.row_y, d), dot(instance.row_z, d));
    let length = sqrt(dot(direction, direction));
    let t_min = select(ray.t_min * length, 0.0, moved);
    let end = min((t_max - start) * length, FAR);
    return ObjectRay(Ray(origin, t_min, direction * (1.0 / length), end), start, length);
}

fn placed_normal(instance: Instance, n: vec3f) -> vec3f {
    return instance.row_x * n.x + instance.row_y * n.y + instance.row_z * n.z;
}

fn placed_shading(instance: Instance, shading: vec3f, normal: vec3f) -> vec3f {
    let m = unit(placed_normal(instance, shading));
    return select(-m, m, dot(m, normal) >= 0.0);
}

fn placed_point(instance: Instance, p: vec3f) -> vec3f {
    return ((instance.center + instance.column_x * p.x) + instance.column_y * p.y)
        + instance.column_z * p.z;
}

fn placed_direction(instance: Instance, d: vec3f) -> vec3f {
    return (instance.column_x * d.x + instance.column_y * d.y) + instance.column_z * d.z;
}

fn placed_error(instance: Instance, error: f32, n: vec3f, inverse_length: f32) -> f32 {
    let a = abs(n);
    let own = ((error + a.x * instance.slack.x) + a.y * instance.slack.y) + a.z * instance.slack.z;
    return instance.rounding + own * inverse_length;
}
