//! Memory budgets, and renders that are split to fit them.
//!
//! Theory: the estimate of a visible point depends on the photons and on that point only. So tiles
//! that reuse one set of buffers give the bits of the whole image, as do visible points and photons
//! that are traced again for each tile, because random numbers depend on indices only. Smaller
//! batches group the sums of photons differently, in the same way on every engine.

use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::{Engine, EngineError, State};
use caustica::low_level::film::exr_file::Channel;
use caustica::low_level::film::{ErrorMap, Picture};
use caustica::low_level::gpu::{self, GpuEngine};
use caustica::low_level::memory::{Memory, Part, total};
use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::plan::{BufferPlace, Plan, scene_bytes};
use caustica::low_level::scene::settings::{Method, RadiusRule, RenderSettings};
use caustica::low_level::scene::{self, Aovs};

use crate::support::{bits, software};

const SIZE: (u32, u32) = (40, 30);
const PASSES: u32 = 5;
const ON_DEVICE: BufferPlace = BufferPlace::Device { in_main_memory: false };

type Change = fn(&mut RenderSettings);

/// Name of a scene, render settings, change of the settings, and layers.
const CASES: [(&str, &str, Change, &str); 5] = [
    ("cornell", "sppm", |_| (), ""),
    ("caustics", "sppm, all layers", |s| s.indirect_radius = Some(2.0), "all"),
    (
        "cornell",
        "ppm, local, layers",
        |s| (s.method, s.radius_rule) = (Method::Ppm, RadiusRule::Local),
        "radius,depth,caustic",
    ),
    ("cornell", "local", |s| s.radius_rule = RadiusRule::Local, ""),
    ("soft-shadows", "no photons", |s| s.max_bounces = 0, "albedo"),
];

fn planned((name, _, change, aovs): (&str, &str, Change, &str)) -> (PackedScene, Plan) {
    let mut loaded = scene::load(format!("scenes/{name}.toml").as_ref()).unwrap();
    let film = &mut loaded.scene.film;
    (film.width, film.height) = SIZE;
    film.aovs = if aovs.is_empty() { Aovs::default() } else { Aovs::parse(aovs).unwrap() };
    loaded.settings.photons = 4000;
    change(&mut loaded.settings);
    let packed = prepare(&loaded.scene, SIZE.0, SIZE.1).unwrap();
    let plan = Plan::probed(&packed, &loaded.settings).on(&loaded.scene.film);
    (packed, plan)
}

/// The results of a render.
#[derive(Clone, PartialEq)]
struct Given {
    picture: Picture,
    errors: ErrorMap,
    layers: Vec<Channel>,
    state: State,
    photons: u64,
    ends: u64,
    records: u64,
}

fn given(engine: &mut dyn Engine) -> Given {
    let (mut photons, mut ends, mut records) = (0, 0, 0);
    for _ in 0..PASSES {
        let report = engine.pass().unwrap();
        (photons, ends, records) =
            (photons + report.photons, ends + report.ends.total(), records + report.records);
    }
    Given {
        picture: engine.picture().unwrap(),
        errors: engine.errors().unwrap(),
        layers: engine.layers().unwrap(),
        state: engine.save().unwrap(),
        photons,
        ends,
        records,
    }
}

fn on_cpu(packed: &PackedScene, plan: &Plan) -> Given {
    given(&mut CpuEngine::new(packed.clone(), plan.clone()))
}

fn on_driver(packed: &PackedScene, plan: &Plan) -> Given {
    given(&mut GpuEngine::new(&software(), packed, plan.clone()).unwrap())
}

/// Describes the first difference of two results.
fn difference(a: &Given, b: &Given) -> Option<String> {
    let (first, second) = (bits(&a.picture), bits(&b.picture));
    let pairs = first.as_flattened().iter().zip(second.as_flattened());
    let differing = pairs.filter(|(a, b)| a != b).count();
    if differing > 0 {
        return Some(format!("{differing} numbers of the picture"));
    }
    if a.errors != b.errors {
        return Some("the errors".into());
    }
    if let Some((layer, _)) = a.layers.iter().zip(&b.layers).find(|(a, b)| a != b) {
        return Some(format!("the layer {}", layer.name));
    }
    if a.state != b.state {
        return Some("what is held".into());
    }
    let counts = |g: &Given| (g.layers.len(), g.photons, g.ends, g.records);
    (counts(a) != counts(b)).then(|| format!("counts {:?} and {:?}", counts(a), counts(b)))
}

/// Splits the plan into tiles of about a ninth of the image, the last one smaller.
fn tiled(plan: &Plan) -> Plan {
    let tiled = plan.clone().in_tiles(140 * plan.eye_samples);
    assert!(tiled.chunks() > 8 && tiled.chunk(8).1 < tiled.chunk(0).1);
    tiled
}

#[test]
fn tiles_change_no_bit() {
    for case in CASES {
        let (packed, plan) = planned(case);
        let whole = on_cpu(&packed, &plan);
        assert!(whole.picture.rgb.iter().flatten().any(|x| *x > 0.0));
        let tiled = tiled(&plan);
        assert_eq!(
            difference(&whole, &on_cpu(&packed, &tiled)),
            None,
            "{}, tiles on the CPU",
            case.1
        );
        assert_eq!(
            difference(&whole, &on_driver(&packed, &tiled)),
            None,
            "{}, tiles on lavapipe",
            case.1
        );
    }
}

/// Photons are traced again for each tile, also if a batch overflows.
#[test]
fn batches_are_the_same_in_tiles() {
    let (packed, plan) = planned(CASES[0]);
    let whole = on_cpu(&packed, &plan);
    let batched = plan.clone().with_batch(1500);
    assert_eq!((batched.batches(), batched.settings.batch), (3, Some(1500)));
    let in_batches = on_cpu(&packed, &batched);
    // sums differ by rounding only
    assert!(difference(&whole, &in_batches).is_some());
    for (a, b) in whole.picture.rgb.iter().flatten().zip(in_batches.picture.rgb.iter().flatten()) {
        assert!((a - b).abs() <= 1e-5 * a.abs(), "{a} and {b}");
    }
    assert_eq!(difference(&in_batches, &on_cpu(&packed, &tiled(&batched))), None, "on the CPU");
    assert_eq!(difference(&in_batches, &on_driver(&packed, &tiled(&batched))), None, "on lavapipe");
    let (packed, plan) = planned(("cornell", "", |s| s.photons = 12_000, ""));
    let tight = Plan { capacity: 4096, buckets: 4096, ..plan };
    let whole = on_cpu(&packed, &tight);
    assert!(whole.records > 4096 * u64::from(PASSES), "no batch overflows");
    assert_eq!(difference(&whole, &on_cpu(&packed, &tiled(&tight))), None, "overflow on the CPU");
    assert_eq!(
        difference(&whole, &on_driver(&packed, &tiled(&tight))),
        None,
        "overflow on lavapipe"
    );
}

/// Theory: under any budget the plan fits it or is refused, and the bits do not change unless
/// batches have to shrink.
#[test]
fn budgets_are_kept() {
    let mut loaded = scene::load("scenes/cornell.toml".as_ref()).unwrap();
    (loaded.scene.film.width, loaded.scene.film.height) = (256, 192);
    let packed = prepare(&loaded.scene, 256, 192).unwrap();
    let plan = Plan::probed(&packed, &loaded.settings).on(&loaded.scene.film);
    let scene = scene_bytes(&packed.tables);
    for place in
        [BufferPlace::Program { saves: false }, BufferPlace::Program { saves: true }, ON_DEVICE]
    {
        let bytes = |plan: &Plan| total(&plan.memory(scene, place));
        let within = |budget, same_batches| {
            plan.clone().within(
                scene,
                place,
                &Memory { budget: Some(budget), same_batches, ..Memory::default() },
            )
        };
        let most = bytes(&plan);
        let whole = within(most, false).unwrap();
        assert!(!whole.tiled && whole.settings == plan.settings);
        let mut seen = (false, false);
        for percent in (5..100).rev().step_by(5) {
            let budget = most * percent / 100;
            match within(budget, false) {
                Ok(cut) => {
                    assert!(bytes(&cut) <= budget && cut.tiled, "{percent} %");
                    let batches = cut.settings.batch.is_some();
                    assert_eq!(batches, cut.capacity < plan.capacity);
                    // tiles come before smaller batches
                    let tiles_do = within(budget, true);
                    assert_eq!(tiles_do.is_ok(), !batches, "{percent} %");
                    seen = (seen.0 || !batches, seen.1 || batches);
                }
                Err(EngineError::OverBudget(over)) => {
                    assert!(over.needed > budget && over.largest.bytes <= over.needed);
                    let reported = over.to_string();
                    assert!(
                        reported.contains("--size") && reported.contains("--crop"),
                        "{reported}"
                    );
                }
                Err(error) => panic!("{error}"),
            }
        }
        assert_eq!(
            seen,
            (true, true),
            "{place:?}: no budget asks for tiles alone, or none for batches"
        );
        assert!(matches!(within(1, false), Err(EngineError::OverBudget(_))));
        // a plan one byte over the budget is refused
        assert!(within(most - 1, false).unwrap().tiled);
    }
}

/// The message names the largest buffer and the setting that makes it smaller.
#[test]
fn the_setting_to_change_is_named() {
    let refused = |width: u32, height: u32, aovs: &str, change: Change| -> String {
        let mut loaded = scene::load("scenes/cornell.toml".as_ref()).unwrap();
        let film = &mut loaded.scene.film;
        (film.width, film.height) = (width, height);
        film.aovs = if aovs.is_empty() { Aovs::default() } else { Aovs::parse(aovs).unwrap() };
        change(&mut loaded.settings);
        let packed = prepare(&loaded.scene, width, height).unwrap();
        let plan = Plan::probed(&packed, &loaded.settings).on(&loaded.scene.film);
        let memory = Memory { budget: Some(1_000_000), same_batches: true, ..Memory::default() };
        plan.within(scene_bytes(&packed.tables), ON_DEVICE, &memory).unwrap_err().to_string()
    };
    assert!(refused(1920, 1080, "", |_| ()).contains("--crop"));
    assert!(refused(64, 48, "", |s| s.photons = 1 << 20).contains("--batch"));
    let many = refused(640, 480, "", |s| {
        (s.method, s.radius_rule, s.eye_samples) = (Method::Ppm, RadiusRule::Local, 64);
    });
    assert!(many.contains("--eye-samples"), "{many}");
}

/// The stated memory equals the size of the buffers that are created.
#[test]
fn what_is_counted_is_what_is_made() {
    for case in CASES {
        let (packed, plan) = planned(case);
        for plan in [plan.clone(), tiled(&plan)] {
            let made = gpu::sizes(&plan, &packed.tables);
            let of = |names: &[&str]| -> u64 {
                made.iter().filter(|(name, _)| names.contains(name)).map(|(_, bytes)| bytes).sum()
            };
            let parts = plan.memory(0, ON_DEVICE);
            let counted =
                |what: &str| parts.iter().find(|p| p.what == what).map_or(0, |p: &Part| p.bytes);
            assert_eq!(counted("the film, and any copy of it"), 2 * of(&["film"]), "{}", case.1);
            assert_eq!(
                counted("visible points"),
                of(&["visible_points", "gathered"]),
                "{}",
                case.1
            );
            assert_eq!(counted("layers, and any copy"), 2 * of(&["aovs", "parts"]), "{}", case.1);
            assert_eq!(
                counted("radii of visible points, and any copy"),
                2 * of(&["statistics"]),
                "{}",
                case.1
            );
            let grid = ["records", "sorted", "order", "counts", "starts", "block_sums"];
            assert_eq!(counted("photons"), of(&grid), "{}", case.1);
        }
    }
}

/// The comparison detects a changed bit, count and layer.
#[test]
fn planted_differences_are_found() {
    let (packed, plan) = planned(CASES[1]);
    let whole = on_cpu(&packed, &plan);
    assert_eq!(difference(&whole, &on_cpu(&packed, &plan)), None);
    let wrong = |change: fn(&mut Given)| {
        let mut wrong = whole.clone();
        change(&mut wrong);
        difference(&whole, &wrong).is_some()
    };
    assert!(wrong(|g| g.picture.rgb[600][1] = f32::from_bits(g.picture.rgb[600][1].to_bits() ^ 1)));
    assert!(wrong(|g| g.layers[3].plane.values[600] += 1e-9));
    assert!(wrong(|g| g.state.film[3] ^= 1));
    assert!(wrong(|g| g.records += 1));
    // an omitted tile
    let tiles = tiled(&plan);
    let short = Plan { pixels: plan.pixels - 1, ..tiles };
    assert!(difference(&whole, &on_cpu(&packed, &short)).is_some());
}
