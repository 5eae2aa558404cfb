//! The CPU engine and the software driver give the same bits.
//! Theory: both carry out the same operations in the same order on numbers that lavapipe rounds as Rust does, so every
//! bit of every picture and every count of every pass is equal; one operation that differs shows somewhere in a scene
//! that uses it, so the scenes together use every feature.

mod software;

use bytemuck::{bytes_of, pod_collect_to_vec};
use caustica::cpu::CpuEngine;
use caustica::engine::{Engine, PassReport};
use caustica::features;
use caustica::film::estimate::LEAST_PASSES;
use caustica::film::exr_file::Channel;
use caustica::film::{ErrorMap, Picture};
use caustica::gpu::GpuEngine;
use caustica::kernels::eye_trace::eye_trace;
use caustica::kernels::photon_trace::photon_trace;
use caustica::kernels::records::{PhotonRecord, VisiblePoint};
use caustica::pack::{Packed, pack};
use caustica::plan::{Kernel, Plan};
use caustica::scene::{Aovs, Film, ToneMap, parse};
use caustica::settings::RenderSettings;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const HEAD: &str = r#"
version = 1
[camera]
position = [0.2, 1.3, 4.5]
target = [0.0, 0.6, 0.0]
fov = 36.0
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

/// Name, render settings, and the rest of the scene.
const SCENES: [(&str, &str, &str); 9] = [
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
];

/// The folder with the files that scenes name.
fn assets() -> &'static Path {
    static FOLDER: std::sync::OnceLock<PathBuf> = std::sync::OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("engines");
        std::fs::create_dir_all(&folder).unwrap();
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
        std::fs::write(folder.join("ball.obj"), ball(12, 8)).unwrap();
        folder
    })
}

/// A sphere as a mesh with normals and uv.
fn ball(columns: u32, rows: u32) -> String {
    let mut text = String::new();
    for row in 0..=rows {
        let theta = std::f64::consts::PI * row as f64 / rows as f64;
        for column in 0..=columns {
            let phi = std::f64::consts::TAU * column as f64 / columns as f64;
            let (x, y, z) = (theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin());
            text += &format!("v {x} {y} {z}\nvn {x} {y} {z}\n");
            text += &format!("vt {} {}\n", column as f64 / columns as f64, 1.0 - row as f64 / rows as f64);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column + 1;
            let [a, b, c, d] = [a, a + 1, a + columns + 2, a + columns + 1].map(|i| format!("{i}/{i}/{i}"));
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    text
}

fn planned(settings: &str, rest: &str) -> (Packed, Plan) {
    planned_at((48, 36), settings, rest)
}

fn planned_at((width, height): (u32, u32), settings: &str, rest: &str) -> (Packed, Plan) {
    let film = format!("[film]\nwidth = {width}\nheight = {height}");
    let lens = if settings.contains("ppm") { "aperture = 0.1\nfocus = 4.3\n" } else { "" };
    let text = format!("{HEAD}{lens}{film}\n[render]\nphotons = 6000\npasses = 3\n{settings}\n{FLOOR}{rest}");
    let path = assets().join("scene.toml");
    let mut loaded =
        parse(&path, text.as_bytes()).unwrap_or_else(|e| panic!("{:?}\n{text}", miette::Report::new(e)));
    loaded.scene.film.aovs = Aovs::parse("object").unwrap();
    let packed = pack(&loaded.scene, loaded.scene.film.width, loaded.scene.film.height).unwrap();
    let plan = Plan::new(&packed, &loaded.settings);
    (packed, plan)
}

fn photons(photons: u32, plan: &Plan) -> RenderSettings {
    RenderSettings { photons, ..plan.settings.clone() }
}

/// Reports, picture, the picture's errors, and what is found beside radiance.
type Rendered = (Vec<PassReport>, Picture, ErrorMap, Vec<Channel>);

/// Four passes, the fewest that have an estimate of their error.
fn rendered(mut engine: impl Engine) -> Rendered {
    let reports = (0..LEAST_PASSES).map(|_| engine.pass().unwrap()).collect();
    (reports, engine.picture().unwrap(), engine.errors().unwrap(), engine.layers().unwrap())
}

fn on_cpu(packed: &Packed, plan: &Plan) -> Rendered {
    rendered(CpuEngine::new(packed.clone(), plan.clone()))
}

fn on_driver(packed: &Packed, plan: &Plan) -> Rendered {
    rendered(GpuEngine::new(&software::software(), packed, plan.clone()).unwrap())
}

/// How two renders differ, if they do.
fn difference(a: &Rendered, b: &Rendered) -> Option<String> {
    if a.0 != b.0 {
        return Some(format!("reports {:?} and {:?}", a.0, b.0));
    }
    let bits = |p: &Picture| p.rgb.iter().map(|c| c.map(f32::to_bits)).collect::<Vec<_>>();
    let (first, second) = (bits(&a.1), bits(&b.1));
    let wrong: Vec<usize> = (0..first.len()).filter(|i| first[*i] != second[*i]).collect();
    let Some(&i) = wrong.first() else {
        let unlike = a.2.pixels.iter().zip(&b.2.pixels).find(|(a, b)| a != b);
        let errors = unlike.map(|(a, b)| format!("errors {a:?} and {b:?}"));
        let unlike = a.3.iter().zip(&b.3).find(|(a, b)| a != b);
        return errors.or(unlike.map(|(layer, _)| format!("the layer {}", layer.name)));
    };
    Some(format!(
        "{} of {} pixels, the first {:?} and {:?}",
        wrong.len(),
        first.len(),
        a.1.rgb[i],
        b.1.rgb[i]
    ))
}

/// Which visible point and which photon record differ first: tells the kernel that is at fault.
fn explain(packed: &Packed, plan: &Plan) -> String {
    let mut engine = GpuEngine::new(&software::software(), packed, plan.clone()).unwrap();
    (0..LEAST_PASSES).map(|pass| explain_pass(packed, plan, &mut engine, pass)).collect()
}

fn explain_pass(packed: &Packed, plan: &Plan, engine: &mut GpuEngine, pass: u32) -> String {
    engine.pass().unwrap();
    let sampled = plan.features.has("sampled");
    let mut text = String::new();
    for step in plan.steps(pass, plan.batch_photons) {
        let d = &step.dispatch;
        if step.kernel == Kernel::EyeTrace {
            let theirs: Vec<VisiblePoint> =
                pod_collect_to_vec(&engine.content("visible_points", step.chunk).unwrap());
            let ours: Vec<_> = (0..d.end).map(|id| eye_trace(&packed.scene, d, sampled, id).0).collect();
            let differing =
                (0..).zip(ours.iter().zip(&theirs)).find(|(_, (a, b))| bytes_of(*a) != bytes_of(*b));
            text += &format!("\n  pass {pass}, visible point: {differing:?}");
        }
        if step.kernel == Kernel::PhotonTrace {
            let mut ours = Vec::new();
            for id in 0..d.end {
                photon_trace(&packed.scene, d, sampled, id, |r| ours.push(r));
            }
            let mut theirs: Vec<PhotonRecord> = pod_collect_to_vec(&engine.content("records", 0).unwrap());
            theirs.truncate(ours.len());
            theirs.sort_by_key(|r| r.key);
            let differing = ours.iter().zip(&theirs).find(|(a, b)| bytes_of(*a) != bytes_of(*b));
            text += &format!("\n  pass {pass}, record: {differing:?}");
        }
    }
    text
}

#[test]
fn engines_agree_to_the_bit() {
    let mut used = BTreeSet::new();
    let mut faults = Vec::new();
    for (name, settings, rest) in SCENES {
        let (packed, plan) = planned(settings, rest);
        let aovs = Aovs::parse("all").unwrap();
        let (width, height) = (48, 36);
        let film = Film { width, height, exposure: 0.0, tonemap: ToneMap::Srgb, aovs, window: None };
        let plan = plan.on(&film);
        used.extend(plan.features.names());
        let cpu = on_cpu(&packed, &plan);
        assert!(cpu.1.rgb.iter().flatten().all(|x| x.is_finite()), "{name}");
        let light = cpu.1.rgb.iter().flatten().sum::<f32>() / cpu.1.rgb.len() as f32;
        assert!(
            light > 1e-3 && cpu.0.iter().all(|r| r.records > 20),
            "{name}: nothing to compare, {:?}",
            cpu.0
        );
        if let Some(text) = difference(&cpu, &on_driver(&packed, &plan)) {
            faults.push(format!("{name}: {text}{}", explain(&packed, &plan)));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let unused: Vec<_> = features::ALL.into_iter().filter(|name| !used.contains(name)).collect();
    assert!(unused.is_empty(), "no scene uses {unused:?}");
}

/// Chunks of visible points, a batch that overflows the records' buffers, and many batches change nothing between
/// engines; chunks change nothing at all.
#[test]
fn engines_agree_when_work_is_cut() {
    let (_, settings, rest) = SCENES[4];
    let (packed, plan) = planned(settings, rest);
    let whole = on_cpu(&packed, &plan);
    let chunked = Plan { chunk_points: 600, ..plan.clone() };
    assert!(chunked.chunks() > 10);
    assert_eq!(difference(&whole, &on_driver(&packed, &chunked)), None, "chunks");
    let batched = Plan { batch_photons: 1000, ..plan.clone() };
    assert_eq!(difference(&on_cpu(&packed, &batched), &on_driver(&packed, &batched)), None, "batches");
    // a batch of all photons leaves more records than fit
    let (packed, plan) = planned("direct = \"photons\"", SCENES[0].2);
    let tight =
        Plan { capacity: 4096, buckets: 4096, batch_photons: 9000, settings: photons(9000, &plan), ..plan };
    let overflowing = on_cpu(&packed, &tight);
    assert!(overflowing.0.iter().all(|r| r.records > 4096), "no batch overflows: {:?}", overflowing.0);
    assert_eq!(difference(&overflowing, &on_driver(&packed, &tight)), None, "overflow");
}

/// Mesa's software driver stops an invocation's loops after 65535 rounds. A pass whose visible points each sum over
/// more photons is then found in smaller batches: the same records, and the same sums up to their grouping.
#[test]
fn long_gathers_are_whole() {
    let settings = "direct = \"photons\"\nradius = { units = 3.0 }\nradius_rule = \"fixed\"";
    let rest = "[[lights]]\ntype = \"spot\"\nposition = [0.0, 2.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n\
                intensity = [9.0, 5.0, 3.0]\nangle = 2.0\n";
    let (packed, plan) = planned_at((8, 6), settings, rest);
    let settings = photons(150_000, &plan);
    let plan = Plan { capacity: 1 << 18, buckets: 1 << 18, batch_photons: 150_000, settings, ..plan };
    let (ours, theirs) = (on_cpu(&packed, &plan), on_driver(&packed, &plan));
    assert_eq!(ours.0, theirs.0);
    let rgb = |p: &Picture| p.rgb.iter().flatten().copied().collect::<Vec<_>>();
    for (a, b) in rgb(&ours.1).into_iter().zip(rgb(&theirs.1)) {
        assert!((a - b).abs() <= 1e-4 * a, "{a} and {b}");
    }
    // also where only the batches before the last are too long
    for batch_photons in [20_000, 35_000, 40_000] {
        let cut = Plan { batch_photons, ..plan.clone() };
        let (ours, theirs) = (on_cpu(&packed, &cut), on_driver(&packed, &cut));
        assert_eq!(ours.0, theirs.0);
        for (a, b) in rgb(&ours.1).into_iter().zip(rgb(&theirs.1)) {
            assert!((a - b).abs() <= 1e-4 * a, "{batch_photons} a batch: {a} and {b}");
        }
    }
    let cut = Plan { batch_photons: 20_000, ..plan };
    assert_eq!(
        difference(&on_cpu(&packed, &cut), &on_driver(&packed, &cut)),
        None,
        "batches that need no cutting"
    );
}

/// A pixel that is off by one bit, and a count that is off by one, are noticed.
#[test]
fn planted_differences_are_found() {
    let (_, settings, rest) = SCENES[3];
    let (packed, plan) = planned(settings, rest);
    let right = on_cpu(&packed, &plan);
    assert_eq!(difference(&right, &on_cpu(&packed, &plan)), None);
    let mut wrong = right.clone();
    let green = &mut wrong.1.rgb[777][1];
    *green = f32::from_bits(green.to_bits() ^ 1);
    assert!(difference(&right, &wrong).is_some());
    let mut wrong = right.clone();
    wrong.2.pixels[777].variance += 1e-9;
    assert!(difference(&right, &wrong).is_some());
    let with_layers = on_cpu(&packed, &Plan { aovs: Aovs::parse("normal").unwrap(), ..plan });
    assert_eq!(difference(&right, &with_layers), None, "what is found beside radiance changes no bit of it");
    let mut wrong = with_layers.clone();
    wrong.3[2].plane.values[777] += 1e-9;
    assert!(difference(&with_layers, &wrong).is_some());
    let mut wrong = right.clone();
    wrong.0[2].records += 1;
    assert!(difference(&right, &wrong).is_some());
}
