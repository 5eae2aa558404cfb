// Plain data that every kernel reads. Twin: src/tables.rs, which documents the fields. The storage
// struct `SceneTables` itself is composed per scene, since the lengths of its arrays are part of
// its type.

const ASTRIDE: u32 = 0xfffffffeu;
const TEXTURE_CHECKER: u32 = 0u;
const TEXTURE_IMAGE: u32 = 1u;
const TEXTURE_PLANKS: u32 = 2u;
const TEXTURE_NEAREST: u32 = 1u;
const TEXTURE_CLAMP_U: u32 = 2u;
const TEXTURE_CLAMP_V: u32 = 4u;
const TEXELS_SRGB8: u32 = 0u;
const TEXELS_LINEAR8: u32 = 1u;
const TEXELS_FLOAT: u32 = 2u;

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
    sun_discs: u32,
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
    center: vec3f,
    projection: u32,
    filter_kind: u32,
    filter_size: f32,
    filter_b: f32,
    filter_c: f32,
}

struct Material {
    reflectance: vec3f,
    kind: u32,
    absorption: vec3f,
    ior: f32,
    texture: u32,
    alpha: f32,
    planar_origin: vec2f,
    eta: vec3f,
    first: u32,
    k: vec3f,
    second: u32,
    mean_fresnel: vec3f,
    mean_albedo: f32,
    albedo_low: vec4f,
    albedo_high: vec4f,
    stores: u32,
    textured: u32,
    normal_map: u32,
    normal_strength: f32,
    bump_map: u32,
    bump_height: f32,
    bent: u32,
    coated: f32,
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
