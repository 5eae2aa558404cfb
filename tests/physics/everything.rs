//! A scene with every shape and kind of light, at any scale and place.

use glam::DVec3;

/// A scene with every shape and kind of light, scaled by `scale` and then moved by `shift`; `mesh`
/// is the name of a file that contains [`MESH`]. Lengths scale, intensities scale by area,
/// absorption by one over length; radiance and irradiance do not change.
pub fn everything_with(mesh: &str, scale: f64, shift: DVec3, size: u32) -> String {
    let list = |v: DVec3| format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z);
    let p = |x: f64, y: f64, z: f64| list(DVec3::new(x, y, z) * scale + shift);
    let v = |x: f64, y: f64, z: f64| list(DVec3::new(x, y, z) * scale);
    format!(
        r#"version = 1
[camera]
position = {camera}
target = {target}
fov = 42.0
[film]
width = {size}
height = {size}
[textures.tiles]
type = "checker"
colors = [[0.7, 0.7, 0.7], [0.3, 0.3, 0.3]]
scale = [6.0, 6.0]
[materials.floor]
type = "diffuse"
reflectance = "tiles"
[materials.clay]
type = "diffuse"
reflectance = 0.6
[materials.steel]
type = "metal"
reflectance = 0.8
roughness = 0.55
[materials.chrome]
type = "mirror"
reflectance = 0.9
[materials.glass]
type = "glass"
ior = 1.5
absorption = {absorption:?}
[materials.black]
type = "diffuse"
reflectance = 0.0
[[shapes]]
type = "rectangle"
origin = {floor}
u = {floor_u}
v = {floor_v}
material = "floor"
[[shapes]]
type = "rectangle"
origin = {wall}
u = {floor_u}
v = {wall_v}
material = "clay"
[[shapes]]
type = "sphere"
center = {ball}
radius = {ball_r:?}
material = "glass"
[[shapes]]
type = "box"
min = {box_min}
max = {box_max}
material = "clay"
[[shapes]]
type = "disc"
center = {disc}
normal = [0.3, 0.2, 1.0]
radius = {disc_r:?}
material = "chrome"
[[shapes]]
type = "mesh"
file = "{mesh}"
material = "clay"
transform = {{ scale = {mesh_s:?}, translate = {mesh_t} }}
[[shapes]]
type = "revolution"
profile = [[0.0, 0.0], [0.6, 0.0], [0.1, 0.6], [0.4, 0.9]]
material = "steel"
transform = {{ scale = {vase_s:?}, translate = {vase_t} }}
[[shapes]]
type = "disc"
center = {lamp}
normal = [0.0, -1.0, 0.1]
radius = {lamp_r:?}
material = "black"
emission = 5.0
[[lights]]
type = "point"
position = {point}
intensity = {intensity:?}
[[lights]]
type = "spot"
position = {spot}
target = {spot_t}
intensity = {intensity:?}
angle = 30.0
blend = 0.5
[[lights]]
type = "sun"
direction = [0.4, -1.0, -0.5]
irradiance = 0.5
[environment]
radiance = 0.2
"#,
        camera = p(0.0, 1.7, 4.2),
        target = p(0.0, 0.6, 0.0),
        absorption = 0.5 / scale,
        floor = p(-2.0, 0.0, 2.0),
        floor_u = v(4.0, 0.0, 0.0),
        floor_v = v(0.0, 0.0, -4.0),
        wall = p(-2.0, 0.0, -2.0),
        wall_v = v(0.0, 2.5, 0.0),
        ball = p(0.2, 0.4, 1.1),
        ball_r = 0.4 * scale,
        box_min = p(-1.5, 0.0, -1.0),
        box_max = p(-0.9, 0.8, -0.4),
        disc = p(0.1, 1.1, -1.4),
        disc_r = 0.6 * scale,
        mesh_s = 0.4 * scale,
        mesh_t = p(1.2, 0.4, 0.4),
        vase_s = scale,
        vase_t = p(-0.4, 0.0, 0.2),
        lamp = p(0.6, 2.2, 0.2),
        lamp_r = 0.3 * scale,
        point = p(-1.4, 1.6, 1.2),
        spot = p(1.6, 1.9, 1.0),
        spot_t = p(0.6, 0.0, -0.6),
        intensity = 1.5 * scale * scale,
    )
}

/// An octahedron with interpolated normals.
pub const MESH: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1
f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
