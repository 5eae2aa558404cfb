// Rays and hits. Twin: src/shapes/ray.rs, which documents the fields.

struct Ray {
    origin: vec3f,
    t_min: f32,
    direction: vec3f,
    t_max: f32,
}

struct Hit {
    t: f32,
    reference: u32,
    u: f32,
    v: f32,
    member: u32,
}
