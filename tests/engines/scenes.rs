//! Scenes that together use every feature, and the files that they refer to.

use std::path::{Path, PathBuf};

use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::Plan;
use caustica::low_level::scene::{Aovs, Loaded, parse};

use crate::support::folder;

const HEAD: &str = r#"
version = 1
[camera]
position = [0.2, 1.3, 4.5]
target = [0.0, 0.6, 0.0]
"#;

const FLOOR: &str = r#"
[materials.white]
type = "diffuse"
reflectance = [0.7, 0.6, 0.5]
[[shapes]]
type = "rectangle"
origin = [-3.0, 0.0, 3.0]
u = [6.0, 0.0, 0.0]
v = [0.0, 0.0, -6.0]
material = "white"
"#;

/// A ball of glass and a lamp.
const BALL: &str = r#"
[materials.glass]
type = "glass"
ior = 1.5
[[shapes]]
type = "sphere"
center = [-0.6, 0.5, 0.0]
radius = 0.5
material = "glass"
[[shapes]]
type = "rectangle"
origin = [-0.4, 2.5, -0.4]
u = [0.8, 0.0, 0.0]
v = [0.0, 0.0, 0.8]
material = "white"
emission = 20.0
"#;

/// Other cameras and pixel filters: name, render settings, and keys of the camera and the film.
pub const CAMERAS: [(&str, &str, &str, &str); 5] = [
    (
        "orthographic camera with a lens, cubic filter, fixed points",
        "method = \"ppm\"\neye_samples = 6",
        "type = \"orthographic\"\nsize = 2.5\nshift = [0.1, 0.05]\naperture = 0.1\nfocus = 4.3",
        "filter = \"mitchell\"",
    ),
    (
        "panorama, tent filter",
        "",
        "type = \"panorama\"",
        "filter = { type = \"tent\", radius = 1.25 }",
    ),
    (
        "fisheye, Gaussian filter, local radii",
        "radius_rule = \"local\"",
        "type = \"fisheye\"\nfov = 200\nfov_axis = \"diagonal\"",
        "filter = \"gaussian\"",
    ),
    (
        "shifted lens, cubic filter",
        "direct = \"photons\"",
        "focal_length = 35.0\nfov_axis = \"larger\"\nshift = [-0.1, 0.2]\naperture = 0.05\n\
         focus = 4.0",
        "filter = { type = \"mitchell\", b = 0.0, c = 0.5 }",
    ),
    (
        "fisheye of all directions, wide box",
        "",
        "type = \"fisheye\"\nfov = 360",
        "filter = { type = \"box\", radius = 1.0 }",
    ),
];

/// Name, render settings, and the rest of the scene file.
pub const SCENES: [(&str, &str, &str); 16] = [
    (
        "glass and mirror under a rectangle",
        "",
        r#"
        [materials.amber]
        type = "glass"
        ior = 1.5
        absorption = [0.1, 0.4, 1.5]
        [materials.chrome]
        type = "mirror"
        reflectance = [0.95, 0.9, 0.85]
        [[shapes]]
        type = "sphere"
        center = [-0.6, 0.5, 0.0]
        radius = 0.5
        material = "amber"
        [[shapes]]
        type = "sphere"
        center = [0.7, 0.4, 0.3]
        radius = 0.4
        material = "chrome"
        [[shapes]]
        type = "rectangle"
        origin = [-0.4, 2.5, -0.4]
        u = [0.8, 0.0, 0.0]
        v = [0.0, 0.0, 0.8]
        material = "white"
        emission = [20.0, 18.0, 15.0]
        "#,
    ),
    (
        "metals under a sphere, a disc and a box, local radii",
        "radius_rule = \"local\"",
        r#"
        [materials.gold]
        type = "metal"
        reflectance = [0.9, 0.7, 0.3]
        roughness = 0.3
        [[shapes]]
        type = "sphere"
        center = [-0.5, 0.5, 0.0]
        radius = 0.5
        material = "gold"
        [[shapes]]
        type = "box"
        min = [0.3, 0.0, -0.3]
        max = [0.9, 0.7, 0.3]
        material = "gold"
        [[shapes]]
        type = "sphere"
        center = [-1.0, 2.0, 0.5]
        radius = 0.2
        material = "white"
        emission = [30.0, 30.0, 30.0]
        [[shapes]]
        type = "disc"
        center = [1.0, 2.0, 0.5]
        normal = [-0.3, -1.0, 0.1]
        radius = 0.3
        material = "white"
        emission = [10.0, 20.0, 30.0]
        [[shapes]]
        type = "box"
        min = [-0.2, 1.5, -1.0]
        max = [0.2, 1.7, -0.8]
        material = "white"
        emission = [5.0, 5.0, 1.0]
        "#,
    ),
    (
        "point, spot and sun on a huge sphere and a plane, photons alone",
        "direct = \"photons\"\nradius_rule = \"fixed\"\nradius = { units = 0.08 }",
        r#"
        [textures.tiles]
        type = "checker"
        colors = [[0.8, 0.8, 0.8], [0.1, 0.2, 0.4]]
        scale = [2.0, 2.0]
        [materials.tiled]
        type = "diffuse"
        reflectance = "tiles"
        [materials.glass]
        type = "glass"
        ior = 1.4
        [[shapes]]
        type = "sphere"
        center = [0.0, -99999.9, 0.0]
        radius = 100000.0
        material = "tiled"
        uv = "planar"
        [[shapes]]
        type = "plane"
        point = [0.0, 0.0, -3.0]
        normal = [0.0, 0.0, 1.0]
        material = "tiled"
        [[shapes]]
        type = "disc"
        center = [0.0, 0.8, 0.0]
        normal = [0.2, 1.0, 0.3]
        radius = 0.4
        material = "tiled"
        [[shapes]]
        type = "sphere"
        center = [0.9, 0.5, 0.6]
        radius = 0.3
        material = "glass"
        [[lights]]
        type = "point"
        position = [1.0, 2.0, 1.0]
        intensity = [3.0, 3.0, 3.0]
        [[lights]]
        type = "spot"
        position = [-1.5, 2.0, 1.0]
        target = [0.0, 0.0, 0.0]
        intensity = [9.0, 5.0, 3.0]
        angle = 25.0
        blend = 0.4
        [[lights]]
        type = "sun"
        direction = [0.3, -1.0, -0.2]
        irradiance = [1.0, 1.0, 0.8]
        "#,
    ),
    (
        "point and spot by shadow rays",
        "",
        r#"
        [materials.glass]
        type = "glass"
        ior = 1.5
        [[shapes]]
        type = "sphere"
        center = [0.0, 0.5, 0.0]
        radius = 0.5
        material = "white"
        [[shapes]]
        type = "sphere"
        center = [0.7, 0.9, 0.5]
        radius = 0.4
        material = "glass"
        [[lights]]
        type = "point"
        position = [1.0, 2.0, 1.0]
        intensity = [3.0, 3.0, 3.0]
        [[lights]]
        type = "spot"
        position = [-1.5, 2.0, 1.0]
        target = [0.0, 0.0, 0.0]
        intensity = [9.0, 5.0, 3.0]
        angle = 25.0
        "#,
    ),
    (
        "a glowing mesh through a lens, fixed visible points",
        "method = \"ppm\"\neye_samples = 6",
        r#"
        [materials.label]
        type = "diffuse"
        reflectance = "picture"
        [textures.picture]
        type = "image"
        file = "picture.png"
        wrap = "clamp"
        filter = "nearest"
        scale = [1.5, 1.5]
        [[shapes]]
        type = "mesh"
        file = "cube.obj"
        material = "label"
        emission = [1.0, 2.0, 3.0]
        transform = { scale = 0.2, rotate = { axis = [1, 2, 0.5], degrees = 40 }, translate = [-0.6, 1.2, 0.0] }
        [[shapes]]
        type = "mesh"
        file = "cube.obj"
        material = "label"
        transform = { scale = 0.4, rotate = { axis = [0, 1, 0], degrees = 30 }, translate = [0.5, 0.4, 0.0] }
        [[shapes]]
        type = "mesh"
        file = "wedge.obj"
        smooth = false
        material = "label"
        transform = { translate = [-0.7, 0.0, 0.3] }
        "#,
    ),
    (
        "a smooth mesh under the sky's picture",
        "",
        r#"
        [materials.boards]
        type = "diffuse"
        reflectance = "wood"
        [materials.steel]
        type = "metal"
        reflectance = 0.8
        roughness = 0.5
        [textures.wood]
        type = "planks"
        file = "picture.png"
        size = [0.3, 0.8]
        [[shapes]]
        type = "box"
        min = [-0.9, 0.0, -0.4]
        max = [-0.2, 0.7, 0.3]
        material = "boards"
        [[shapes]]
        type = "mesh"
        file = "ball.obj"
        material = "steel"
        transform = { scale = 0.5, translate = [0.5, 0.5, 0.2] }
        [environment]
        file = "sky.hdr"
        rotate = 70.0
        "#,
    ),
    (
        "the sky's picture by photons, and the sun",
        "direct = \"photons\"\nindirect_radius = 2.5",
        r#"
        [materials.mirror]
        type = "mirror"
        reflectance = 0.9
        [[shapes]]
        type = "mesh"
        file = "ball.obj"
        material = "mirror"
        transform = { scale = 0.5, translate = [0.0, 0.5, 0.2] }
        [[lights]]
        type = "sun"
        direction = [0.3, -1.0, -0.2]
        irradiance = [1.0, 1.0, 0.8]
        [environment]
        file = "sky.hdr"
        "#,
    ),
    (
        "an even sky, metal, and glass in glass",
        "",
        r#"
        [materials.copper]
        type = "metal"
        reflectance = [0.9, 0.5, 0.4]
        roughness = 0.6
        [materials.glass]
        type = "glass"
        ior = 1.5
        [[shapes]]
        type = "sphere"
        center = [-0.6, 0.5, 0.0]
        radius = 0.5
        material = "copper"
        [[shapes]]
        type = "sphere"
        center = [0.6, 0.5, 0.0]
        radius = 0.5
        material = "glass"
        [materials.water]
        type = "glass"
        ior = 1.33
        [[shapes]]
        type = "sphere"
        center = [0.5, 0.45, 0.1]
        radius = 0.25
        material = "water"
        [environment]
        radiance = [0.5, 0.7, 1.0]
        "#,
    ),
    (
        "a glass vase and a glowing one",
        "",
        r#"
        [materials.glass]
        type = "glass"
        ior = 1.5
        absorption = [0.3, 0.1, 0.2]
        [materials.clay]
        type = "diffuse"
        reflectance = "picture"
        [textures.picture]
        type = "image"
        file = "picture.png"
        [[shapes]]
        type = "revolution"
        profile = [[0.0, 0.0], [0.5, 0.1], [0.5, 0.5], [0.0, 1.3]]
        transform = { translate = [-0.6, 0.05, 0.0] }
        material = "glass"
        [[shapes]]
        type = "revolution"
        profile = [[0.0, 0.0], [0.6, 0.0], [0.1, 0.6], [0.3, 0.8]]
        transform = { translate = [0.6, 0.0, 0.0], rotate = { axis = [1, 0, 0], degrees = 20 } }
        material = "clay"
        [[shapes]]
        type = "revolution"
        profile = [[0.1, 0.0], [0.3, 0.1], [0.1, 0.4]]
        transform = { translate = [0.0, 1.4, 0.0] }
        material = "clay"
        emission = [8.0, 7.0, 6.0]
        "#,
    ),
    (
        "bodies in a lake, with lamp and lens astride",
        "max_bounces = 12",
        r#"
        [materials.lake]
        type = "glass"
        ior = 1.33
        absorption = [0.3, 0.1, 0.05]
        [materials.same]
        type = "glass"
        ior = 1.33
        [materials.crown]
        type = "glass"
        ior = 1.52
        priority = 2
        [materials.air]
        type = "glass"
        ior = 1.0
        [[shapes]]
        type = "plane"
        point = [0.0, 1.3, 0.0]
        normal = [0.1, 1.0, 0.0]
        material = "lake"
        [[shapes]]
        type = "sphere"
        center = [-0.6, 0.5, 0.0]
        radius = 0.5
        material = "crown"
        [[shapes]]
        type = "sphere"
        center = [-0.5, 0.5, 0.1]
        radius = 0.3
        material = "air"
        [[shapes]]
        type = "box"
        min = [0.2, 0.0, -0.3]
        max = [1.0, 0.9, 0.4]
        material = "same"
        [[shapes]]
        type = "box"
        min = [0.6, 0.0, -0.3]
        max = [1.3, 0.9, 0.4]
        material = "crown"
        [[shapes]]
        type = "rectangle"
        origin = [-0.4, 0.9, -1.0]
        u = [0.8, 0.0, 0.0]
        v = [0.0, 0.8, 0.3]
        material = "white"
        emission = [20.0, 18.0, 15.0]
        [environment]
        radiance = 0.3
        "#,
    ),
    (
        "conductors, plastics, mixes, masks and panes",
        "indirect_radius = 2.0",
        r#"
        [textures.holes]
        type = "checker"
        colors = [1.0, 0.1]
        scale = [6.0, 6.0]
        [materials.gold]
        type = "metal"
        material = "gold"
        roughness = 0.7
        [materials.copper]
        type = "metal"
        material = "copper"
        [materials.glazed]
        type = "plastic"
        reflectance = [0.7, 0.2, 0.1]
        nonlinear = true
        [materials.worn]
        type = "plastic"
        reflectance = [0.1, 0.3, 0.7]
        roughness = 0.5
        [materials.leaf]
        type = "mix"
        materials = ["glazed", "gold"]
        amount = "holes"
        opacity = "holes"
        opacity_cutoff = 0.5
        [materials.veil]
        type = "two_sided"
        front = "leaf"
        back = "worn"
        opacity = 0.6
        [materials.pane]
        type = "glass"
        ior = 1.5
        thin = true
        transmittance = [0.9, 0.7, 0.8]
        [[shapes]]
        type = "sphere"
        center = [-0.9, 0.4, 0.0]
        radius = 0.4
        material = "gold"
        [[shapes]]
        type = "sphere"
        center = [0.0, 0.4, -0.4]
        radius = 0.4
        material = "worn"
        [[shapes]]
        type = "sphere"
        center = [0.9, 0.4, 0.0]
        radius = 0.4
        material = "glazed"
        [[shapes]]
        type = "sphere"
        center = [0.4, 0.25, 0.6]
        radius = 0.25
        material = "copper"
        [materials.polished]
        type = "metal"
        reflectance = 0.8
        roughness = 0.2
        [[shapes]]
        type = "sphere"
        center = [-0.3, 0.2, 0.7]
        radius = 0.2
        material = "polished"
        [[shapes]]
        type = "rectangle"
        origin = [-0.9, 0.0, 0.9]
        u = [0.9, 0.0, 0.3]
        v = [0.0, 0.8, 0.0]
        material = "veil"
        [[shapes]]
        type = "rectangle"
        origin = [-0.2, 0.1, 1.2]
        u = [0.9, 0.0, 0.0]
        v = [0.0, 0.9, 0.0]
        material = "pane"
        [[lights]]
        type = "point"
        position = [0.5, 2.5, 1.0]
        intensity = 8.0
        [environment]
        radiance = [0.2, 0.3, 0.4]
        "#,
    ),
    (
        "instances of every shape, mirrored, stretched, nested and of glass",
        "max_bounces = 8",
        r#"
        [textures.tiles]
        type = "checker"
        colors = [[0.8, 0.7, 0.6], [0.1, 0.2, 0.3]]
        scale = [4.0, 3.0]
        [materials.tiles]
        type = "diffuse"
        reflectance = "tiles"
        [materials.red]
        type = "diffuse"
        reflectance = [0.7, 0.2, 0.1]
        [materials.steel]
        type = "metal"
        reflectance = [0.6, 0.6, 0.65]
        roughness = 0.4
        [materials.clear]
        type = "glass"
        ior = 1.5
        absorption = [0.2, 0.4, 0.1]
        [materials.oil]
        type = "glass"
        ior = 1.3
        [[groups.toys.shapes]]
        type = "mesh"
        file = "ball.obj"
        material = "tiles"
        transform = { scale = 0.3, translate = [0.0, 0.3, 0.0] }
        [[groups.toys.shapes]]
        type = "sphere"
        center = [0.6, 0.2, 0.0]
        radius = 0.2
        material = "red"
        [[groups.toys.shapes]]
        type = "box"
        min = [-0.7, 0.0, -0.2]
        max = [-0.4, 0.4, 0.1]
        material = "tiles"
        [[groups.toys.shapes]]
        type = "revolution"
        segments = [[[0.0, 0.0], [0.2, 0.0]], [[0.2, 0.0], [0.1, 0.1], [0.2, 0.3]]]
        material = "steel"
        transform = { translate = [0.3, 0.6, 0.2] }
        [[groups.toys.shapes]]
        type = "cylinder"
        radius = 0.1
        p0 = [0.2, 0.0, 0.5]
        p1 = [0.3, 0.4, 0.6]
        material = "tiles"
        [[groups.toys.shapes]]
        type = "cone"
        radius = 0.15
        height = 0.3
        material = "steel"
        transform = { translate = [-0.2, 0.0, 0.5] }
        [[groups.toys.shapes]]
        type = "disc"
        center = [-0.3, 0.6, 0.3]
        normal = [0.2, 1.0, 0.3]
        radius = 0.15
        material = "red"
        [[groups.toys.shapes]]
        type = "rectangle"
        origin = [-0.8, 0.0, -0.4]
        u = [1.6, 0.0, 0.0]
        v = [0.0, 0.7, 0.0]
        material = "tiles"
        [[groups.pair.instances]]
        group = "toys"
        transform = [{ scale = [1.0, 1.3, 0.7] }, { translate = [-0.6, 0.0, -0.5] }]
        [[groups.pair.instances]]
        group = "toys"
        transform = [{ scale = [-0.6, 0.6, 0.6] }, { translate = [0.8, 0.0, 0.6] }]
        [[instances]]
        group = "pair"
        transform = { rotate = { axis = [0.0, 1.0, 0.0], degrees = 20.0 } }
        [[instances]]
        group = "pair"
        transform = { matrix = [[0.5, 0.2, 0, 0.9], [0, 0.5, 0, 0], [0.1, 0, 0.5, -0.6]] }
        [[shapes]]
        type = "sphere"
        center = [0.0, 0.0, 0.0]
        radius = 1.0
        material = "clear"
        transform = [
            { scale = [0.5, 0.2, 0.3] },
            { rotate = { axis = [0.0, 0.0, 1.0], degrees = 25.0 } },
            { translate = [-0.5, 0.35, 0.9] },
        ]
        [[shapes]]
        type = "sphere"
        center = [0.0, 0.0, 0.0]
        radius = 1.0
        material = "oil"
        transform = [{ scale = [0.2, 0.3, 0.2] }, { translate = [-0.2, 0.35, 0.9] }]
        [[shapes]]
        type = "sphere"
        center = [1.0, 1.0, 0.0]
        radius = 0.3
        material = "tiles"
        uv = "planar"
        transform = [{ scale = [1.0, 0.5, 1.0] }]
        [[shapes]]
        type = "rectangle"
        origin = [-0.4, 2.5, -0.4]
        u = [0.8, 0.0, 0.0]
        v = [0.0, 0.0, 0.8]
        material = "white"
        emission = [20.0, 18.0, 15.0]
        "#,
    ),
    (
        "every shape under uneven maps and mirrors, photons alone",
        "direct = \"photons\"\nindirect_radius = 2.0",
        r#"
        [textures.tiles]
        type = "checker"
        colors = [[0.8, 0.7, 0.6], [0.1, 0.2, 0.3]]
        scale = [4.0, 3.0]
        [materials.tiles]
        type = "diffuse"
        reflectance = "tiles"
        bump_map = "tiles"
        bump_height = 0.02
        [materials.both]
        type = "two_sided"
        front = "tiles"
        back = "white"
        [materials.clear]
        type = "glass"
        ior = 1.5
        [[shapes]]
        type = "mesh"
        file = "ball.obj"
        material = "tiles"
        transform = [{ scale = [0.4, 0.25, -0.3] }, { translate = [-1.2, 0.3, 0.0] }]
        [[shapes]]
        type = "mesh"
        file = "ball.obj"
        material = "clear"
        transform = { matrix = [[-0.3, 0.1, 0.0, -0.5], [0.0, 0.2, 0.0, 0.3], [0.0, 0.0, 0.3, 0.8]] }
        [[shapes]]
        type = "sphere"
        center = [0.0, 0.0, 0.0]
        radius = 0.3
        material = "both"
        transform = [{ scale = [1.0, 0.6, -1.0] }, { translate = [-0.4, 0.2, -0.2] }]
        [[shapes]]
        type = "box"
        min = [-0.2, -0.2, -0.2]
        max = [0.2, 0.2, 0.2]
        material = "tiles"
        transform = [
            { rotate = { axis = [1.0, 0.5, 0.2], degrees = 30.0 } },
            { translate = [0.3, 0.35, -0.3] },
        ]
        [[shapes]]
        type = "disc"
        center = [0.0, 0.0, 0.0]
        normal = [0.0, 1.0, 0.2]
        radius = 0.4
        material = "both"
        transform = [{ scale = [1.0, 1.0, 0.5] }, { translate = [0.3, 0.8, 0.2] }]
        [[shapes]]
        type = "rectangle"
        origin = [-0.3, 0.0, 0.0]
        u = [0.6, 0.0, 0.0]
        v = [0.0, 0.5, 0.1]
        material = "tiles"
        transform = [{ scale = [-1.0, 1.0, 2.0] }, { translate = [0.9, 0.0, -0.8] }]
        [[shapes]]
        type = "revolution"
        segments = [[[0.0, 0.0], [0.2, 0.0]], [[0.2, 0.0], [0.1, 0.1], [0.2, 0.3]]]
        material = "tiles"
        transform = [{ scale = [1.0, 1.2, 0.6] }, { translate = [0.9, 0.0, 0.2] }]
        [[shapes]]
        type = "cylinder"
        radius = 0.15
        height = 0.4
        material = "both"
        transform = [{ scale = [1.5, 1.0, 0.7] }, { translate = [1.4, 0.0, 0.0] }]
        [[shapes]]
        type = "cone"
        radius = 0.2
        top_radius = 0.1
        p0 = [0.0, 0.0, 0.0]
        p1 = [0.1, 0.5, 0.0]
        material = "clear"
        transform = [{ scale = [1.2, 1.0, 0.8] }, { translate = [0.5, 0.02, 0.9] }]
        [[shapes]]
        type = "plane"
        point = [0.0, 0.0, -2.0]
        normal = [0.0, 0.0, 1.0]
        material = "tiles"
        transform = [{ scale = [1.0, 2.0, 1.0] }, { rotate = { axis = [0, 1, 0], degrees = 10.0 } }]
        [[shapes]]
        type = "rectangle"
        origin = [-0.2, 0.0, -0.2]
        u = [0.4, 0.0, 0.0]
        v = [0.0, 0.0, 0.4]
        material = "white"
        emission = [20.0, 18.0, 15.0]
        transform = [{ scale = [2.0, 1.0, -1.5] }, { translate = [0.0, 2.5, 0.0] }]
        "#,
    ),
    (
        "normal maps and bumps on every material",
        "",
        r#"
        [textures.n]
        type = "image"
        file = "picture.png"
        color_space = "linear"
        scale = [3.0, 2.0]
        [textures.h]
        type = "checker"
        colors = [0.2, 0.8]
        scale = [4.0, 3.0]
        [materials.wall]
        type = "diffuse"
        reflectance = [0.7, 0.2, 0.1]
        normal_map = "n"
        normal_strength = 0.4
        bump_map = "h"
        bump_height = 0.01
        [materials.steel]
        type = "metal"
        reflectance = [0.6, 0.6, 0.65]
        roughness = 0.5
        bump_map = "n"
        bump_height = 0.05
        [materials.clear]
        type = "glass"
        ior = 1.5
        bump_map = "h"
        bump_height = -0.02
        [materials.gloss]
        type = "plastic"
        reflectance = [0.1, 0.5, 0.2]
        roughness = 0.2
        normal_map = "n"
        [materials.patchy]
        type = "mix"
        materials = ["steel", "gloss"]
        amount = "h"
        bump_map = "n"
        bump_height = 0.02
        [[shapes]]
        type = "sphere"
        center = [-1.20, 0.22, 0.0]
        radius = 0.22
        material = "wall"
        [[shapes]]
        type = "sphere"
        center = [-0.72, 0.22, 0.6]
        radius = 0.22
        material = "steel"
        [[shapes]]
        type = "sphere"
        center = [-0.24, 0.22, 0.0]
        radius = 0.22
        material = "clear"
        [[shapes]]
        type = "sphere"
        center = [0.24, 0.22, 0.6]
        radius = 0.22
        material = "gloss"
        [[shapes]]
        type = "sphere"
        center = [0.72, 0.22, 0.0]
        radius = 0.22
        material = "patchy"
        [[shapes]]
        type = "rectangle"
        origin = [-0.4, 2.5, -0.4]
        u = [0.8, 0.0, 0.0]
        v = [0.0, 0.0, 0.8]
        material = "white"
        emission = 20.0
        "#,
    ),
    (
        "principled materials with textures, clear coats and rough panes",
        "",
        r#"
        [textures.t]
        type = "image"
        file = "picture.png"
        color_space = "linear"
        channel = "green"
        scale = [3.0, 2.0]
        [textures.spots]
        type = "checker"
        colors = [[0.8, 0.7, 0.6], [0.1, 0.2, 0.3]]
        scale = [4.0, 3.0]
        [materials.all]
        type = "principled"
        base_color = "spots"
        metallic = "t"
        roughness = "t"
        specular = 0.7
        clearcoat = "t"
        clearcoat_roughness = 0.4
        bump_map = "t"
        bump_height = 0.02
        [materials.lacquer]
        type = "principled"
        base_color = [0.6, 0.1, 0.05]
        roughness = 0.3
        clearcoat = 1.0
        [materials.frosted]
        type = "principled"
        base_color = [0.8, 0.9, 0.9]
        roughness = "t"
        transmission = 0.8
        [materials.pane]
        type = "glass"
        ior = 1.5
        thin = true
        roughness = 0.6
        [materials.worn]
        type = "metal"
        material = "copper"
        roughness = "t"
        [materials.brushed]
        type = "metal"
        material = "iron"
        roughness = [0.2, 0.6]
        [materials.grained]
        type = "principled"
        base_color = "spots"
        metallic = 0.8
        roughness = "t"
        anisotropy = 0.7
        normal_map = "t"
        [materials.chalk]
        type = "diffuse"
        reflectance = 0.7
        roughness = "t"
        [[shapes]]
        type = "sphere"
        center = [-1.20, 0.22, 0.0]
        radius = 0.22
        material = "all"
        [[shapes]]
        type = "sphere"
        center = [-0.72, 0.22, 0.6]
        radius = 0.22
        material = "lacquer"
        [[shapes]]
        type = "sphere"
        center = [-0.24, 0.22, 0.0]
        radius = 0.22
        material = "frosted"
        [[shapes]]
        type = "sphere"
        center = [0.24, 0.22, 0.6]
        radius = 0.22
        material = "worn"
        [[shapes]]
        type = "sphere"
        center = [0.72, 0.22, 0.0]
        radius = 0.22
        material = "chalk"
        [[shapes]]
        type = "sphere"
        center = [1.20, 0.22, 0.6]
        radius = 0.22
        material = "brushed"
        [[shapes]]
        type = "sphere"
        center = [1.68, 0.22, 0.0]
        radius = 0.22
        material = "grained"
        [[shapes]]
        type = "rectangle"
        origin = [0.3, 0.5, 0.9]
        u = [0.5, 0.0, -0.1]
        v = [0.0, 0.5, 0.0]
        material = "pane"
        [[shapes]]
        type = "rectangle"
        origin = [-0.4, 2.5, -0.4]
        u = [0.8, 0.0, 0.0]
        v = [0.0, 0.0, 0.8]
        material = "white"
        emission = 20.0
        "#,
    ),
    (
        "two suns with a size, and a tilted sky",
        "",
        r#"
        [materials.steel]
        type = "metal"
        reflectance = 0.8
        roughness = 0.2
        [materials.glass]
        type = "glass"
        ior = 1.5
        [[shapes]]
        type = "sphere"
        center = [-0.6, 0.5, 0.0]
        radius = 0.5
        material = "steel"
        [[shapes]]
        type = "sphere"
        center = [0.6, 0.5, 0.0]
        radius = 0.5
        material = "glass"
        [[lights]]
        type = "sun"
        direction = [0.3, -1.0, -0.2]
        irradiance = [1.0, 1.0, 0.8]
        angle = 0.53
        [[lights]]
        type = "sun"
        direction = [0.1, -0.2, 1.0]
        irradiance = [0.5, 0.2, 0.1]
        angle = 30.0
        [environment]
        file = "sky.hdr"
        rotate = { axis = [1.0, 0.2, 0.3], degrees = 40.0 }
        "#,
    ),
];

/// The folder with the files that scenes refer to.
fn assets() -> &'static Path {
    static FOLDER: std::sync::OnceLock<PathBuf> = std::sync::OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = folder("assets");
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        std::fs::copy(data.join("cube.obj"), folder.join("cube.obj")).unwrap();
        let picture = image::RgbImage::from_fn(13, 7, |x, y| {
            image::Rgb([(x * 19) as u8, (y * 36) as u8, (x * y * 3) as u8])
        });
        picture.save(folder.join("picture.png")).unwrap();
        let sky = image::Rgb32FImage::from_fn(16, 8, |x, y| {
            let sun = if (x, y) == (5, 2) { 40.0 } else { 0.0 };
            image::Rgb([0.2 + 0.05 * x as f32 + sun, 0.3 + sun, 1.0 - 0.1 * y as f32 + sun])
        });
        sky.save(folder.join("sky.hdr")).unwrap();
        std::fs::write(folder.join("wedge.obj"), WEDGE).unwrap();
        std::fs::write(folder.join("ball.obj"), ball(12, 8)).unwrap();
        folder
    })
}

/// A wedge with triangular ends.
const WEDGE: &str = "v 0 0 0\nv 0.5 0 0.1\nv 0.1 0.3 0\nv 0 0 0.6\nv 0.5 0 0.7\nv 0.1 0.3 0.6\n\
    f 1 3 2\nf 4 5 6\nf 1 2 5 4\nf 2 3 6 5\nf 3 1 4 6\n";

/// A sphere as a mesh with normals and uv.
fn ball(columns: u32, rows: u32) -> String {
    let mut text = String::new();
    for row in 0..=rows {
        let theta = std::f64::consts::PI * row as f64 / rows as f64;
        for column in 0..=columns {
            let phi = std::f64::consts::TAU * column as f64 / columns as f64;
            let (x, y, z) = (theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            text += &format!("v {x} {y} {z}\nvn {x} {y} {z}\n");
            text += &format!(
                "vt {} {}\n",
                column as f64 / columns as f64,
                1.0 - row as f64 / rows as f64
            );
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column + 1;
            let [a, b, c, d] =
                [a, a + 1, a + columns + 2, a + columns + 1].map(|i| format!("{i}/{i}/{i}"));
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    text
}

/// Packs the scene with these settings and shapes, and plans it.
pub fn planned(settings: &str, rest: &str) -> (PackedScene, Plan) {
    planned_at((48, 36), settings, rest)
}

/// Loads the scene with these settings and shapes and an image of this size.
pub fn loaded_at(size: (u32, u32), settings: &str, rest: &str) -> Loaded {
    let lens = if settings.contains("ppm") || rest.contains("lake") {
        "aperture = 0.1\nfocus = 4.3\n"
    } else {
        ""
    };
    loaded_with(size, settings, &format!("fov = 36.0\n{lens}"), "", rest)
}

/// Packs and plans a scene of [`CAMERAS`].
pub fn planned_with(settings: &str, camera: &str, film: &str) -> (PackedScene, Plan) {
    planned_from(&loaded_with((48, 36), settings, camera, film, BALL))
}

fn loaded_with(
    (width, height): (u32, u32),
    settings: &str,
    camera: &str,
    film: &str,
    rest: &str,
) -> Loaded {
    let text = format!(
        "{HEAD}{camera}\n[film]\nwidth = {width}\nheight = {height}\n{film}\n[render]\n\
         photons = 6000\npasses = 3\n{settings}\n{FLOOR}{rest}"
    );
    let path = assets().join("scene.toml");
    let mut loaded = parse(&path, text.as_bytes())
        .unwrap_or_else(|e| panic!("{:?}\n{text}", miette::Report::new(e)));
    loaded.scene.film.aovs = Aovs::parse("object").unwrap();
    loaded
}

/// Like [`planned`], with an image of another size.
pub fn planned_at(size: (u32, u32), settings: &str, rest: &str) -> (PackedScene, Plan) {
    planned_from(&loaded_at(size, settings, rest))
}

fn planned_from(loaded: &Loaded) -> (PackedScene, Plan) {
    let packed = prepare(&loaded.scene, loaded.scene.film.width, loaded.scene.film.height).unwrap();
    let plan = Plan::probed(&packed, &loaded.settings);
    (packed, plan)
}
