// Plain data that every kernel reads. Twin: src/tables.rs, which documents the fields. The storage
// struct `Scene` itself is composed per scene, since the lengths of its arrays are part of its
// type.

const NONE: u32 = 0xffffffffu;
const ASTRIDE: u32 = 0xfffffffeu;
const REFERENCE_BITS: u32 = 28u;
const KIND_TRIANGLE: u32 = 0u;
const KIND_SPHERE: u32 = 1u;
const KIND_RECTANGLE: u32 = 2u;
const KIND_DISC: u32 = 3u;
const KIND_CUBOID: u32 = 4u;
const KIND_REVOLUTION: u32 = 5u;
const KIND_PLANE: u32 = 6u;
const UV_NATURAL: u32 = 0u;
const UV_PLANAR: u32 = 1u;
const TEXTURE_CHECKER: u32 = 0u;
const TEXTURE_IMAGE: u32 = 1u;
const TEXTURE_PLANKS: u32 = 2u;
const TEXTURE_NEAREST: u32 = 1u;
const TEXTURE_CLAMP_U: u32 = 2u;
const TEXTURE_CLAMP_V: u32 = 4u;
const TEXELS_SRGB8: u32 = 0u;
const TEXELS_LINEAR8: u32 = 1u;
const TEXELS_FLOAT: u32 = 2u;
const LIGHT_AREA: u32 = 0u;
const LIGHT_POINT: u32 = 1u;
const LIGHT_SPOT: u32 = 2u;
const LIGHT_SUN: u32 = 3u;
const LIGHT_CONSTANT: u32 = 4u;
const LIGHT_IMAGE: u32 = 5u;

struct World {
    bounds_min: vec3f,
    unit: f32,
    bounds_max: vec3f,
    near_radius: f32,
    near_center: vec3f,
    disc_radius: f32,
    light_count: u32,
    environment: u32,
    unbounded_count: u32,
    disc_levels: u32,
    disc_first: u32,
    far: u32,
    nested: u32,
    guided: u32,
    primitive_size: f32,
    body_first: u32,
    body_count: u32,
    pad: u32,
}

struct Camera {
    position: vec3f,
    aperture: f32,
    right: vec3f,
    focus: f32,
    up: vec3f,
    pixel: f32,
    forward: vec3f,
    width: u32,
    lens_right: vec3f,
    height: u32,
    lens_up: vec3f,
    medium: u32,
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

struct Material {
    reflectance: vec3f,
    kind: u32,
    absorption: vec3f,
    ior: f32,
    texture: u32,
    alpha: f32,
    planar_origin: vec2f,
}

struct Texture {
    scale: vec2f,
    kind: u32,
    flags: u32,
    first: u32,
    width: u32,
    height: u32,
    format: u32,
    color0: vec3f,
    pad0: u32,
    color1: vec3f,
    pad1: u32,
}

struct Light {
    color: vec3f,
    kind: u32,
    position: vec3f,
    selection: f32,
    direction: vec3f,
    area: f32,
    reference: u32,
    first: u32,
    outer: f32,
    inner: f32,
    patch_first: u32,
    patch_count: u32,
    medium: u32,
    guide: u32,
}

struct Cell {
    split: f32,
    axis: u32,
    first: u32,
    pad: u32,
}
