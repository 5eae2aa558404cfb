//! The CPU engine and the GPU engine on the software driver give the same bits.
//!
//! Theory: both execute the same operations in the same order, and lavapipe rounds as Rust does. So
//! every bit of every image and every count of every pass is equal. A differing operation shows
//! somewhere in a scene that uses it, so the scenes together use every feature.

use crate::scenes::{CAMERAS, SCENES, planned, planned_at, planned_with};
use crate::support::{bits, software};
use bytemuck::{bytes_of, pod_collect_to_vec};
use caustica::low_level::cpu::CpuEngine;
use caustica::low_level::engine::{Engine, PassReport};
use caustica::low_level::film::estimate::LEAST_PASSES;
use caustica::low_level::film::exr_file::Channel;
use caustica::low_level::film::{ErrorMap, Picture};
use caustica::low_level::gpu::GpuEngine;
use caustica::low_level::kernels::eye_trace::eye_trace;
use caustica::low_level::kernels::photon_trace::photon_trace;
use caustica::low_level::kernels::records::{PhotonRecord, VisiblePoint};
use caustica::low_level::materials::Bsdf;
use caustica::low_level::pack::PackedScene;
use caustica::low_level::plan::features::Feature;
use caustica::low_level::plan::{Buffer, Plan, Stage};
use caustica::low_level::scene::settings::RenderSettings;
use caustica::low_level::scene::{Aovs, Film, ToneMap};
use std::collections::BTreeSet;

pub fn photons(photons: u32, plan: &Plan) -> RenderSettings {
    RenderSettings { photons, ..plan.settings.clone() }
}

/// Pass reports, image, its error map, and its layers.
type Rendered = (Vec<PassReport>, Picture, ErrorMap, Vec<Channel>);

/// Renders four passes, the fewest with an error estimate.
fn rendered(mut engine: impl Engine) -> Rendered {
    let reports = (0..LEAST_PASSES).map(|_| engine.pass().unwrap()).collect();
    (reports, engine.picture().unwrap(), engine.errors().unwrap(), engine.layers().unwrap())
}

fn on_cpu(packed: &PackedScene, plan: &Plan) -> Rendered {
    rendered(CpuEngine::new(packed.clone(), plan.clone()))
}

fn on_driver(packed: &PackedScene, plan: &Plan) -> Rendered {
    rendered(GpuEngine::new(&software(), packed, plan.clone()).unwrap())
}

/// Describes how two renders differ, if they do.
fn difference(a: &Rendered, b: &Rendered) -> Option<String> {
    if a.0 != b.0 {
        return Some(format!("reports {:?} and {:?}", a.0, b.0));
    }
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

/// Describes the first visible point and the first photon record that differ, which identifies the
/// faulty kernel.
fn explain(packed: &PackedScene, plan: &Plan) -> String {
    let mut engine = GpuEngine::new(&software(), packed, plan.clone()).unwrap();
    (0..LEAST_PASSES).map(|pass| explain_pass(packed, plan, &mut engine, pass)).collect()
}

fn explain_pass(packed: &PackedScene, plan: &Plan, engine: &mut GpuEngine, pass: u32) -> String {
    engine.pass().unwrap();
    let sampled = plan.features.has(Feature::Sampled);
    let mut text = String::new();
    for step in plan.steps(pass) {
        let d = &step.dispatch;
        if step.stage == Stage::EyeTrace {
            let theirs: Vec<VisiblePoint> =
                pod_collect_to_vec(&engine.content(Buffer::VisiblePoints, step.chunk).unwrap());
            let ours: Vec<_> =
                (0..d.end).map(|id| eye_trace(&packed.tables, d, sampled, id).0).collect();
            let differing = (0..)
                .zip(ours.iter().zip(&theirs))
                .find(|(_, (a, b))| bytes_of(*a) != bytes_of(*b));
            text += &format!("\n  pass {pass}, visible point: {differing:?}");
        }
        if step.stage == Stage::PhotonTrace {
            let mut ours = Vec::new();
            for id in 0..d.end {
                photon_trace(&packed.tables, d, sampled, id, |r| ours.push(r));
            }
            let mut theirs: Vec<PhotonRecord> =
                pod_collect_to_vec(&engine.content(Buffer::Records, 0).unwrap());
            theirs.truncate(ours.len());
            theirs.sort_by_key(|r| r.key);
            let differing = ours.iter().zip(&theirs).find(|(a, b)| bytes_of(*a) != bytes_of(*b));
            text += &format!("\n  pass {pass}, record: {differing:?}");
        }
    }
    text
}

/// Renders a scene with all layers on both engines, and describes how the results differ.
fn disagreement(name: &str, packed: &PackedScene, plan: Plan) -> Option<String> {
    let aovs = Aovs::parse("all").unwrap();
    let (width, height) = (48, 36);
    let film = Film { width, height, tonemap: ToneMap::Srgb, aovs, ..Film::default() };
    let plan = plan.on(&film);
    let cpu = on_cpu(packed, &plan);
    assert!(cpu.1.rgb.iter().flatten().all(|x| x.is_finite()), "{name}");
    let light = cpu.1.rgb.iter().flatten().sum::<f32>() / cpu.1.rgb.len() as f32;
    assert!(
        light > 1e-3 && cpu.0.iter().all(|r| r.records > 20),
        "{name}: nothing to compare, {:?}",
        cpu.0
    );
    let text = difference(&cpu, &on_driver(packed, &plan))?;
    Some(format!("{name}: {text}{}", explain(packed, &plan)))
}

#[test]
fn engines_agree_to_the_bit() {
    let mut used = BTreeSet::new();
    let mut faults = Vec::new();
    for (name, settings, rest) in SCENES {
        let (packed, plan) = planned(settings, rest);
        let layers = Film { aovs: Aovs::parse("all").unwrap(), ..Film::default() };
        used.extend(plan.clone().on(&layers).features.iter());
        faults.extend(disagreement(name, &packed, plan));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    for (_, settings, camera, film) in CAMERAS {
        used.extend(planned_with(settings, camera, film).1.features.iter());
    }
    // `engines_agree_on_every_material` tests the materials
    let needed = Feature::all().filter(|feature| !matches!(feature, Feature::Material(_)));
    let unused: Vec<_> = needed.filter(|feature| !used.contains(feature)).collect();
    assert!(unused.is_empty(), "no scene uses {unused:?}");
}

/// The same for every projection and pixel filter.
#[test]
fn engines_agree_on_every_camera() {
    let faults = CAMERAS.iter().filter_map(|(name, settings, camera, film)| {
        let (packed, plan) = planned_with(settings, camera, film);
        disagreement(name, &packed, plan)
    });
    assert_eq!(faults.collect::<Vec<_>>().join("\n"), "");
}

/// The same for every example of every material, which replaces the material of the floor and of a
/// body.
#[test]
fn engines_agree_on_every_material() {
    let (_, settings, rest) =
        SCENES.iter().find(|(name, ..)| name.contains("smooth mesh")).unwrap();
    let (packed, plan) = planned(settings, rest);
    for bsdf in Bsdf::ALL {
        for (k, example) in bsdf.examples().enumerate() {
            let mut packed = packed.clone();
            for material in packed.tables.materials.iter_mut().filter(|m| m.kind != 0) {
                *material = example;
            }
            packed.tables.materials[0] = example;
            let plan = Plan::probed(&packed, &plan.settings);
            let difference = difference(&on_cpu(&packed, &plan), &on_driver(&packed, &plan));
            assert!(difference.is_none(), "{} {k}: {difference:?}", bsdf.name());
        }
    }
}

/// Theory: patches are deferred if a set has a bit for each of them, and otherwise searched leaf by
/// leaf. Both engines do the same in both cases.
#[test]
fn engines_agree_on_many_patches() {
    let beads = |count: u32| {
        let bead = |i: u32| {
            let (x, y, z) = (i % 5, i / 25, i / 5 % 5);
            format!(
                "[[shapes]]\ntype = \"revolution\"\nmaterial = \"white\"\n\
                 profile = [[0.0, 0.0], [0.2, 0.0], [0.1, 0.3], [0.0, 0.3]]\n\
                 transform = {{ translate = [{}, {}, {}] }}\n",
                0.4 * f64::from(x) - 0.8,
                0.4 * f64::from(y),
                0.5 * f64::from(z) - 1.0
            )
        };
        let lamp = "[[lights]]\ntype = \"point\"\nposition = [0.3, 2.5, 1.0]\nintensity = 3.0\n";
        (0..count).map(bead).collect::<String>() + lamp
    };
    for (count, set) in [(4, true), (9, true), (12, false)] {
        let (packed, plan) = planned_at((24, 16), "", &beads(count));
        let patches = packed.tables.patches.len();
        assert_eq!(plan.features.has(Feature::PatchSet), set, "{patches} patches");
        let ours = on_cpu(&packed, &plan);
        assert_eq!(difference(&ours, &on_driver(&packed, &plan)), None, "{patches} patches");
    }
}

/// Theory: chunks of visible points, a batch that overflows the record buffers, and many batches
/// leave the engines equal. Chunks change no bit at all.
#[test]
fn engines_agree_when_work_is_cut() {
    let (_, settings, rest) = SCENES[4];
    let (packed, plan) = planned(settings, rest);
    let whole = on_cpu(&packed, &plan);
    let chunked = Plan { chunk_points: 600, ..plan.clone() };
    assert!(chunked.chunks() > 10);
    assert_eq!(difference(&whole, &on_driver(&packed, &chunked)), None, "chunks");
    let batched = Plan { batch_photons: 1000, ..plan.clone() };
    assert_eq!(
        difference(&on_cpu(&packed, &batched), &on_driver(&packed, &batched)),
        None,
        "batches"
    );
    // a batch of all photons stores more records than fit
    let (packed, plan) = planned("direct = \"photons\"", SCENES[0].2);
    let tight = Plan {
        capacity: 4096,
        buckets: 4096,
        batch_photons: 9000,
        settings: photons(9000, &plan),
        ..plan
    };
    let overflowing = on_cpu(&packed, &tight);
    assert!(
        overflowing.0.iter().all(|r| r.records > 4096),
        "no batch overflows: {:?}",
        overflowing.0
    );
    assert_eq!(difference(&overflowing, &on_driver(&packed, &tight)), None, "overflow");
}

/// Theory: Mesa's software driver stops a loop after 65535 iterations. A pass whose visible points
/// each gather more photons is split into smaller batches, with the same records and the same sums
/// up to their grouping.
#[test]
fn long_gathers_are_whole() {
    let settings = "direct = \"photons\"\nradius = { units = 3.0 }\nradius_rule = \"fixed\"";
    let rest = "[[lights]]\ntype = \"spot\"\nposition = [0.0, 2.0, 0.0]\ntarget = [0.0, 0.0, 0.0]\n\
                intensity = [9.0, 5.0, 3.0]\nangle = 2.0\n";
    let (packed, plan) = planned_at((4, 3), settings, rest);
    let settings = photons(150_000, &plan);
    let plan =
        Plan { capacity: 1 << 18, buckets: 1 << 18, batch_photons: 150_000, settings, ..plan };
    let (ours, theirs) = (on_cpu(&packed, &plan), on_driver(&packed, &plan));
    assert_eq!(ours.0, theirs.0);
    let rgb = |p: &Picture| p.rgb.iter().flatten().copied().collect::<Vec<_>>();
    for (a, b) in rgb(&ours.1).into_iter().zip(rgb(&theirs.1)) {
        assert!((a - b).abs() <= 1e-4 * a, "{a} and {b}");
    }
    // also if only earlier batches are too long
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

/// The comparison detects a pixel that differs in one bit, and a count that differs by one.
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
    assert_eq!(
        difference(&right, &with_layers),
        None,
        "what is found in addition to radiance changes no bit of it"
    );
    let mut wrong = with_layers.clone();
    wrong.3[2].plane.values[777] += 1e-9;
    assert!(difference(&with_layers, &wrong).is_some());
    let mut wrong = right.clone();
    wrong.0[2].records += 1;
    assert!(difference(&right, &wrong).is_some());
}
