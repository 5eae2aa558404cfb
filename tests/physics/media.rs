//! Glass bodies inside, across and next to each other, and bodies that stand exactly on others.

use caustica::low_level::scene::settings::{Direct, Method, RenderSettings};

use super::lab::*;

/// Photon mapping with both kinds of direct light, and path tracing.
fn ways() -> [RenderSettings; 3] {
    let base = RenderSettings { photons: 1 << 13, passes: 16, max_bounces: 100, ..settings(0.05) };
    let path = RenderSettings { method: Method::Path, passes: 128, ..base.clone() };
    [Direct::Sampled, Direct::Photons]
        .map(|direct| RenderSettings { direct, ..base.clone() })
        .into_iter()
        .chain([path])
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

fn camera(position: &str, target: &str, fov: f64) -> String {
    format!(
        "version = 1\n[camera]\nposition = {position}\ntarget = {target}\nfov = {fov:?}\n[film]\n\
         width = 12\n\
         height = 12\n[materials.black]\ntype = \"diffuse\"\nreflectance = 0.0\n[materials.white]\n\
         type = \"diffuse\"\nreflectance = 0.6\n"
    )
}

fn glass(name: &str, ior: f64, more: &str) -> String {
    format!("[materials.{name}]\ntype = \"glass\"\nior = {ior:?}\n{more}\n")
}

fn shape(body: &str, material: &str) -> String {
    format!("[[shapes]]\n{body}\nmaterial = \"{material}\"\n")
}

fn ball(center: &str, radius: f64) -> String {
    format!("type = \"sphere\"\ncenter = {center}\nradius = {radius:?}")
}

fn block(min: &str, max: &str) -> String {
    format!("type = \"box\"\nmin = {min}\nmax = {max}")
}

/// A lamp above, of radiance 5.
fn lamp() -> String {
    shape(
        "type = \"disc\"\ncenter = [0, 6, 0]\nnormal = [0, -1, 0]\nradius = 2.0\nemission = 5.0",
        "black",
    )
}

/// Axis-parallel boxes from `low` to `high` in one mesh.
fn boxes(name: &str, boxes: &[([f64; 3], [f64; 3])]) -> String {
    let mut obj = String::new();
    for (low, high) in boxes {
        for k in 0..8 {
            let c = [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { high[axis] } else { low[axis] });
            obj += &format!("v {} {} {}\n", c[0], c[1], c[2]);
        }
    }
    for k in 0..boxes.len() {
        for face in
            [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]]
        {
            let [a, b, c, d] = face.map(|i| i + 8 * k);
            obj += &format!("f {a} {b} {c} {d}\n");
        }
    }
    format!("type = \"mesh\"\nfile = \"{}\"\nsmooth = false", file(name, obj.as_bytes()))
}

/// Theory: a body with the index of its surroundings is invisible: a ball in water in front of a
/// lamp, and one under the surface of a lake over a floor, whatever shape the surface has, by every
/// method.
#[test]
fn index_matched_bodies_are_invisible() {
    let sheet = |low: f64| {
        let corners = [[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]];
        let v: String = corners.iter().map(|[x, z]| format!("v {x} {low} {z}\n")).collect();
        file("physics-lake.obj", (v + "f 4 3 2 1\n").as_bytes())
    };
    let lake = camera("[0, 3, 4]", "[0, -0.7, 0]", 30.0) + &lamp();
    let floor = shape(
        "type = \"rectangle\"\norigin = [-3, -1.5, 3]\nu = [6, 0, 0]\nv = [0, 0, -6]",
        "white",
    );
    let tank = camera("[0, 0, 6]", "[0, 0, 0]", 15.0)
        + &shape(&(block("[-0.8, -0.8, -1.2]", "[0.8, 0.8, -0.8]") + "\nemission = 1.0"), "black");
    for (name, scene, water) in [
        ("tank", &tank, block("[-1.5, -1.5, -1.5]", "[1.5, 1.5, 1.5]")),
        (
            "plane",
            &(lake.clone() + &floor),
            "type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]".into(),
        ),
        (
            "rectangle",
            &(lake.clone() + &floor),
            "type = \"rectangle\"\norigin = [-3, 0, 3]\nu = [6, 0, 0]\nv = [0, 0, -6]".into(),
        ),
        (
            "sheet",
            &(lake.clone() + &floor),
            format!("type = \"mesh\"\nfile = \"{}\"\nsmooth = false", sheet(0.0)),
        ),
    ] {
        let water = scene.clone() + &glass("water", 1.33, "") + &shape(&water, "water");
        for body in [
            ball("[0.1, -0.75, 0.1]", 0.5),
            boxes("physics-hidden.obj", &[([-0.4, -1.2, -0.4], [0.5, -0.3, 0.4])]),
        ] {
            let with = water.clone() + &glass("body", 1.33, "") + &shape(&body, "body");
            for settings in ways() {
                if name != "tank" && body.contains("mesh") {
                    continue;
                }
                let what = format!("{name}, {:?} {:?}", settings.method, settings.direct);
                let [a, b] = [&water, &with].map(|text| runs(text, &settings).region(|_, _| true));
                assert_same(&what, b, a, 0.08);
            }
        }
    }
}

/// Theory: in a room of radiance 1 everywhere, glass that absorbs nothing shows radiance 1, however
/// bodies lie inside, across and next to each other, and if a mesh intersects itself (the second
/// law).
#[test]
fn overlapping_glass_neither_makes_nor_takes_light() {
    let base = camera("[2.5, 1.5, 3]", "[0, 0, 0]", 22.0)
        + "[environment]\nradiance = 1.0\n"
        + &glass("a", 1.5, "")
        + &glass("b", 1.33, "")
        + &glass("c", 1.8, "priority = 3");
    let across = [([-0.8, -0.8, -0.8], [0.3, 0.3, 0.3]), ([-0.3, -0.3, -0.3], [0.8, 0.8, 0.8])];
    let adjacent = [([-0.8, -0.8, -0.8], [0.1, 0.8, 0.8]), ([0.1, -0.8, -0.8], [0.8, 0.8, 0.8])];
    let can = "type = \"revolution\"\nsegments = [[[0, -0.5], [0.6, -0.5]], [[0.6, -0.5], [0.6, 0.5]], [[0.6, 0.5], [0, 0.5]]]";
    let cases = [
        (
            "balls",
            shape(&ball("[-0.3, 0, 0]", 0.7), "a") + &shape(&ball("[0.3, 0.1, 0]", 0.6), "b"),
        ),
        (
            "held",
            shape(&ball("[0, 0, 0]", 1.0), "a")
                + &shape(&ball("[0.1, 0, 0]", 0.5), "c")
                + &shape(can, "b"),
        ),
        (
            "slabs",
            shape(&block("[-0.9, -0.3, -0.9]", "[0.9, 0.1, 0.9]"), "a")
                + &shape(&block("[-0.9, -0.1, -0.9]", "[0.9, 0.3, 0.9]"), "b"),
        ),
        (
            "adjacent",
            shape(&block("[-0.9, -0.3, -0.9]", "[0.9, 0.0, 0.9]"), "a")
                + &shape(&block("[-0.9, 0.0, -0.9]", "[0.9, 0.3, 0.9]"), "c"),
        ),
        ("one mesh across itself", shape(&boxes("physics-across.obj", &across), "a")),
        ("one mesh next to itself", shape(&boxes("physics-adjacent.obj", &adjacent), "a")),
        (
            "mesh and ball",
            shape(&boxes("physics-across.obj", &across), "b")
                + &shape(&ball("[0.2, 0.2, 0.2]", 0.4), "a"),
        ),
    ];
    for (name, shapes) in cases {
        for method in [Method::Path, Method::Sppm] {
            let settings = RenderSettings {
                method,
                passes: 32,
                photons: 1,
                max_bounces: 200,
                ..settings(0.02)
            };
            let found = runs(&(base.clone() + &shapes), &settings).region(|_, _| true);
            assert_agrees(&format!("{name}, {method:?}"), found, 1.0, 0.01);
        }
    }
}

/// Theory: with index 1 a chord transmits exp(-(s1 d1 + s2 d2)), with its lengths d1 and d2 in the
/// two media. Where a ball overlaps a slab, the overlap belongs to the ball (it is smaller), or to
/// the slab if its priority is higher. The chord is 1 long in the ball and 0.8 in the slab, of
/// which 0.3 overlap.
#[test]
fn the_medium_of_an_overlap() {
    for (priority, [in_slab, in_ball]) in [(-1, [0.5f64, 1.0]), (0, [0.5, 1.0]), (1, [0.8, 0.7])] {
        let text = camera("[0, 0, 3]", "[0, 0, 0]", 0.2)
            + "[environment]\nradiance = 1.0\n"
            + &glass("slab", 1.0, &format!("absorption = 0.9\npriority = {priority}"))
            + &glass("ball", 1.0, "absorption = 0.4")
            + &shape(&block("[-4, -4, -0.8]", "[4, 4, 0]"), "slab")
            + &shape(&ball("[0, 0, 0.2]", 0.5), "ball");
        let truth = (-0.9 * in_slab - 0.4 * in_ball).exp();
        for method in [Method::Path, Method::Sppm] {
            let settings = RenderSettings { method, photons: 1, passes: 32, ..settings(0.02) };
            let found = runs(&text, &settings).region(|_, _| true);
            assert_agrees(&format!("priority {priority}, {method:?}"), found, truth, 0.01);
        }
    }
}

/// Theory: a camera below the surface of a lake is in the water, whatever shape the surface has: it
/// sees exp(-s d) of a lamp at distance d.
#[test]
fn cameras_under_open_surfaces() {
    for water in [
        "type = \"plane\"\npoint = [0, 1, 0]\nnormal = [0, 1, 0]",
        "type = \"rectangle\"\norigin = [-5, 1, 5]\nu = [10, 0, 0]\nv = [0, 0, -10]",
        "type = \"disc\"\ncenter = [0, 1, 0]\nnormal = [0, 1, 0]\nradius = 5",
        "type = \"revolution\"\nsegments = [[[5, 1], [0, 1]]]",
    ] {
        let text = camera("[0, 0, 2]", "[0, 0, 0]", 0.5)
            + &glass("water", 1.33, "absorption = 0.6")
            + &shape(water, "water")
            + &shape(
                "type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 1]\nradius = 2\n\
                 emission = 1.0",
                "black",
            );
        for method in [Method::Path, Method::Sppm] {
            let settings = RenderSettings { method, photons: 1, passes: 8, ..settings(0.02) };
            let found = runs(&text, &settings).region(|_, _| true);
            assert_agrees(&format!("{water}, {method:?}"), found, (-1.2f64).exp(), 0.01);
        }
    }
}

/// Theory: a lamp that crosses the surface of water emits as before, each half into its own medium.
/// Photons and paths agree.
#[test]
fn lamps_astride() {
    let base = camera("[0.5, 0, 3]", "[0.5, 0, 0]", 30.0)
        + &glass("water", 1.0, "absorption = 1.0")
        + &shape(&block("[-2, -2, -2]", "[4, 0.05, 2]"), "water")
        + &shape(
            "type = \"disc\"\ncenter = [0.3, 0, 0]\nnormal = [1, 0, 0.3]\nradius = 0.5",
            "white",
        );
    let part = |low: f64, high: f64| {
        let height = high - low;
        shape(
            &format!(
                "type = \"rectangle\"\norigin = [1, {low:?}, -0.1]\nu = [0, 0, 0.2]\n\
                 v = [0, {height:?}, 0]\n\
                 emission = 10.0"
            ),
            "black",
        )
    };
    let (whole, cut) = (part(-0.8, 0.8), part(-0.8, 0.05) + &part(0.05, 0.8));
    for settings in ways() {
        let passes =
            if settings.method == Method::Path { 8 * settings.passes } else { settings.passes };
        let settings = RenderSettings { passes, ..settings };
        let [a, b] = [&whole, &cut].map(|lamps| runs(&(base.clone() + lamps), &settings));
        // on the right the lamp itself is visible
        for (half, rows) in [("upper", 0..6), ("lower", 6..12)] {
            let what = format!("{half} half, {:?} {:?}", settings.method, settings.direct);
            let [a, b] = [&a, &b].map(|runs| runs.region(|x, y| x < 8 && rows.contains(&y)));
            assert_same(&what, a, b, 0.15);
        }
    }
}

/// Theory: a body of index 1 that stands exactly on something is invisible. All pairs of shapes.
#[test]
fn what_stands_on_a_floor() {
    let can = "type = \"revolution\"\nsegments = [[[0, 0], [0.5, 0]], [[0.5, 0], [0.5, 0.6]], [[0.5, 0.6], [0, 0.6]]]\ntransform = { rotate = { axis = [0, 1, 0], degrees = 25 }, translate = [0.03, 0.0, 0.07] }";
    let bodies = [
        block("[-0.5, 0, -0.43]", "[0.5, 0.6, 0.5]"),
        boxes("physics-stands.obj", &[([-0.5, 0.0, -0.43], [0.5, 0.6, 0.5])]),
        can.to_owned(),
        "type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 0.6".to_owned(),
        "type = \"rectangle\"\norigin = [-0.5, 0, 0.43]\nu = [1, 0, 0]\nv = [0, 0, -1]".to_owned(),
    ];
    let floors = [
        "type = \"rectangle\"\norigin = [-4, 0, 4]\nu = [8, 0, 0]\nv = [0, 0, -8]".to_owned(),
        "type = \"disc\"\ncenter = [0.3, 0, 0.1]\nnormal = [0, 1, 0]\nradius = 4.0".to_owned(),
        "type = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 1, 0]".to_owned(),
        block("[-4, -1, -4]", "[4, 0, 4]"),
        boxes("physics-floor.obj", &[([-4.0, -1.0, -4.0], [4.0, 0.0, 4.0])]),
        "type = \"revolution\"\nsegments = [[[0, -1], [4, -1]], [[4, -1], [4, 0]], [[4, 0], [0, 0]]]"
            .to_owned(),
    ];
    for floor in &floors {
        let base = camera("[1.2, 2, 3]", "[0, 0.1, 0]", 12.0)
            + &glass("air", 1.0, "")
            + &shape(floor, "white")
            + &shape(&(ball("[0.5, 3, 0.5]", 0.5) + "\nemission = 10.0"), "black");
        for settings in ways() {
            let passes = if settings.method == Method::Path {
                4 * settings.passes
            } else {
                settings.passes / 4
            };
            let settings = RenderSettings { passes, photons: 1 << 12, ..settings };
            if settings.direct == Direct::Photons
                || settings.method == Method::Path && *floor != floors[0]
            {
                continue;
            }
            let alone = runs(
                &(base.clone()
                    + "[[shapes]]\ntype = \"sphere\"\ncenter = [0, 90, 0]\nradius = 0.1\n\
                       material = \"air\"\n"),
                &settings,
            );
            for body in &bodies {
                let with = runs(&(base.clone() + &shape(body, "air")), &settings);
                let what =
                    format!("{body} on {floor}, {:?} {:?}", settings.method, settings.direct);
                let [a, b] = [&with, &alone].map(|runs| runs.region(|_, _| true));
                assert_same(&what, a, b, 0.08);
            }
        }
    }
}

/// Theory: a lamp in the plane of a ceiling has its own radiance from corner to corner, and lights
/// the floor like one a little below the ceiling, by photons and by paths.
#[test]
fn lamps_in_ceilings() {
    let lamps = |y: f64| {
        [
            format!("type = \"rectangle\"\norigin = [-1, {y:?}, -1]\nu = [2, 0, 0]\nv = [0, 0, 2]"),
            format!("type = \"disc\"\ncenter = [0, {y:?}, 0]\nnormal = [0, -1, 0]\nradius = 1.0"),
            boxes(&format!("physics-lamp-{y}.obj"), &[([-1.0, y, -1.0], [1.0, y + 0.3, 1.0])]),
            block(&format!("[-1, {y:?}, -1]"), &format!("[1, {:?}, 1]", y + 0.3)),
        ]
    };
    let ceilings = [
        "type = \"rectangle\"\norigin = [-3, 2, -3]\nu = [6, 0, 0]\nv = [0, 0, 6]".to_owned(),
        "type = \"plane\"\npoint = [0, 2, 0]\nnormal = [0, -1, 0]".to_owned(),
        block("[-3, 2, -3]", "[3, 2.5, 3]"),
        boxes("physics-ceiling.obj", &[([-3.0, 2.0, -3.0], [3.0, 2.5, 3.0])]),
    ];
    let floor =
        shape("type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3.0", "white");
    let emission = "\nemission = 4.0";
    for ceiling in &ceilings {
        for (lamp, lower) in lamps(2.0).iter().zip(&lamps(1.999)) {
            let scene = |camera: String, lamp: &str| {
                camera
                    + &floor
                    + &shape(ceiling, "black")
                    + &shape(&(lamp.to_owned() + emission), "black")
            };
            let up = scene(camera("[0, 0.5, 0.01]", "[0, 2, 0]", 40.0), lamp);
            let path = RenderSettings { method: Method::Path, passes: 4, ..settings(0.05) };
            let seen = runs(&up, &path).region(|_, _| true);
            assert_agrees(&format!("{lamp} seen in {ceiling}"), seen, 4.0, 0.01);
            for settings in ways() {
                if settings.direct == Direct::Photons || *ceiling != ceilings[0] {
                    continue;
                }
                let down = |lamp: &str| scene(camera("[0.1, 1.5, 0.1]", "[0, 0, 0]", 40.0), lamp);
                let what =
                    format!("{lamp} in {ceiling}, {:?} {:?}", settings.method, settings.direct);
                let [a, b] =
                    [lamp, lower].map(|lamp| runs(&down(lamp), &settings).region(|_, _| true));
                assert_same(&what, a, b, 0.08);
            }
        }
    }
}

/// Theory: light that passes only hidden faces, of overlapping bodies of index 1, arrives as if
/// they did not exist. Shadow rays end at them, so photons must bring it.
#[test]
fn light_through_hidden_faces() {
    let base = camera("[0, 1.5, 0.01]", "[0, 0, 0]", 30.0)
        + &lamp()
        + &glass("air", 1.0, "")
        + &shape("type = \"disc\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nradius = 3.0", "white");
    let hidden = shape(&block("[-9, 3, -9]", "[9, 3.4, 9]"), "air")
        + &shape(&block("[-9, 3.2, -9]", "[9, 3.6, 9]"), "air");
    for direct in [Direct::Sampled, Direct::Photons] {
        let settings = RenderSettings { direct, photons: 1 << 14, passes: 8, ..settings(0.1) };
        let [a, b] = [base.clone() + &hidden, base.clone()]
            .map(|text| runs(&text, &settings).region(|_, _| true));
        assert_same(&format!("{direct:?}"), a, b, 0.08);
    }
}
