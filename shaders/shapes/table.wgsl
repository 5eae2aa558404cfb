// Shapes as kernels read them, and references to them: twin of src/shapes/table.rs, which
// explains each field.

const NONE: u32 = 0xffffffffu;
const REFERENCE_BITS: u32 = 28u;
const KIND_TRIANGLE: u32 = 0u;
const KIND_SPHERE: u32 = 1u;
const KIND_RECTANGLE: u32 = 2u;
const KIND_DISC: u32 = 3u;
const KIND_CUBOID: u32 = 4u;
const KIND_REVOLUTION: u32 = 5u;
const KIND_PLANE: u32 = 6u;
const KIND_INSTANCE: u32 = 7u;
const UV_NATURAL: u32 = 0u;
const UV_PLANAR: u32 = 1u;

fn kind_of(reference: u32) -> u32 {
    return reference >> REFERENCE_BITS;
}

fn index_of(reference: u32) -> u32 {
    return reference & ((1u << REFERENCE_BITS) - 1u);
}

struct Sphere {
    anchor: vec3f,
    curvature: f32,
    normal: vec3f,
    radius: f32,
    material: u32,
    light: u32,
    uv: u32,
    pad: u32,
}

struct Rectangle {
    origin: vec3f,
    material: u32,
    normal: vec3f,
    light: u32,
    u: vec3f,
    uv: u32,
    v: vec3f,
    area: f32,
    dual_u: vec3f,
    outline: u32,
    dual_v: vec3f,
    pad: u32,
}

struct Disc {
    center: vec3f,
    radius: f32,
    normal: vec3f,
    material: u32,
    light: u32,
    uv: u32,
    outline: u32,
    pad: u32,
}

struct Cuboid {
    lower: vec3f,
    material: u32,
    upper: vec3f,
    light: u32,
    uv: u32,
    outline: u32,
    pad0: u32,
    pad1: u32,
}

struct Plane {
    point: vec3f,
    material: u32,
    normal: vec3f,
    uv: u32,
    tangent: vec3f,
    u0: f32,
    bitangent: vec3f,
    v0: f32,
    outline: u32,
    pad0: u32,
    pad1: u32,
    pad2: u32,
}

struct Attributes {
    n0: vec3f,
    u0: f32,
    n1: vec3f,
    v0: f32,
    n2: vec3f,
    u1: f32,
    v1: f32,
    u2: f32,
    v2: f32,
    outline_smooth: u32,
}
