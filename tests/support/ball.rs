//! A scene of few pixels with caustics, direct and indirect light: a glass ball over a floor under
//! a lamp.

/// A floor, or a lamp: TOML of one shape.
pub type Shape = &'static str;

/// A disc as floor.
pub const DISC: Shape = r#"
[[shapes]]
type = "disc"
center = [0.0, 0.0, 0.0]
normal = [0.0, 1.0, 0.0]
radius = 3.0
material = "white"
"#;

/// A plane as floor.
pub const PLANE: Shape = r#"
[[shapes]]
type = "plane"
point = [0.0, 0.0, 0.0]
normal = [0.0, 1.0, 0.0]
material = "white"
"#;

/// A mesh as floor, in the file `floor.obj`, which holds [`FLOOR`].
pub const MESH: Shape = r#"
[[shapes]]
type = "mesh"
file = "floor.obj"
material = "white"
"#;

/// A square.
pub const FLOOR: &str = "v -3 0 3\nv 3 0 3\nv 3 0 -3\nv -3 0 -3\nf 1 2 3 4\n";

/// A disc as lamp.
pub const LAMP: Shape = r#"
[[shapes]]
type = "disc"
center = [0.0, 3.0, 1.0]
normal = [0.0, -1.0, 0.0]
radius = 0.3
material = "white"
emission = [20.0, 20.0, 20.0]
"#;

/// A sphere as lamp.
pub const GLOBE: Shape = r#"
[[shapes]]
type = "sphere"
center = [0.0, 3.0, 1.0]
radius = 0.3
material = "white"
emission = [20.0, 20.0, 20.0]
"#;

/// The scene file, with an image of this size, the lines of `[render]`, and shapes in addition to
/// the ball.
pub fn ball((width, height): (u32, u32), render: &str, shapes: &[Shape]) -> String {
    format!(
        r#"version = 1
[camera]
position = [0.0, 1.0, 5.0]
target = [0.0, 0.5, 0.0]
fov = 40.0
[film]
width = {width}
height = {height}
[render]
{render}
[materials.white]
type = "diffuse"
reflectance = 0.5
[materials.glass]
type = "glass"
ior = 1.5
[[shapes]]
type = "sphere"
center = [0.0, 0.7, 0.0]
radius = 0.5
material = "glass"
{}"#,
        shapes.concat()
    )
}
