// Rays and hits: twin of src/shapes/ray.rs, where each field is explained.

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
}
