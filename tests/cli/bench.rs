//! `caustica bench` on a tiny scene.
//!
//! Theory: the figures in the JSON report are consistent on every device: the kernels' seconds and
//! the rest add up to the timed pass, shares add up to 1, a rate times its time is the stated
//! amount of work, and the CPU and the software driver do the same work. The times themselves are
//! not tested.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::support::{caustica, folder_with, good, json_lines, software, text};
use caustica::low_level::film::{Picture, pfm};
use serde_json::Value;

const SCENE: &str = r#"
version = 1
[camera]
position = [0.0, 1.0, 5.0]
target = [0.0, 0.5, 0.0]
fov = 40.0
[film]
width = 24
height = 16
[render]
photons = 3000
[materials.white]
type = "diffuse"
reflectance = 0.8
[[shapes]]
type = "disc"
center = [0.0, 0.0, 0.0]
normal = [0.0, 1.0, 0.0]
radius = 3.0
material = "white"
[[shapes]]
type = "disc"
center = [0.0, 4.0, 0.0]
normal = [0.0, -1.0, 0.0]
radius = 6.0
material = "white"
[[shapes]]
type = "sphere"
center = [0.0, 0.7, 0.0]
radius = 0.5
material = "white"
[[lights]]
type = "point"
position = [0.0, 3.0, 3.0]
intensity = [10.0, 10.0, 10.0]
"#;

fn folder(name: &str) -> PathBuf {
    let folder = folder_with(name, &[("ball.toml", SCENE)]);
    fs::write(folder.join("dark.pfm"), pfm::encode(&Picture::from_fn(24, 16, |_, _| [0.0; 3])))
        .unwrap();
    folder
}

fn bench(folder: &Path, arguments: &[&str]) -> Output {
    caustica(folder, &[&["bench"], arguments].concat())
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    report(good(folder, &[&["bench"], arguments].concat()).as_bytes())
}

/// Returns the last event.
fn report(stdout: &[u8]) -> Value {
    json_lines(stdout).pop().unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Lists inconsistencies in a device's figures.
fn faults(device: &Value, rounds: f64) -> Vec<String> {
    let mut list = Vec::new();
    let mut hold = |what: &str, holds: bool| {
        if !holds {
            list.push(what.to_owned());
        }
    };
    let kernels = device["kernels"].as_object().unwrap();
    let work = &device["work"];
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-6 * b.abs().max(1e-9);
    let shares: f64 = kernels.values().map(|kernel| number(&kernel["share"])).sum();
    hold("shares make up one", close(shares, 1.0));
    for spread in kernels
        .values()
        .map(|kernel| &kernel["seconds"])
        .chain([&device["pass"], &device["timed_pass"]])
    {
        let [least, median, most] = ["least", "median", "most"].map(|key| number(&spread[key]));
        hold(
            "the median lies between the extremes",
            0.0 <= least && least <= median && median <= most,
        );
        hold("every round is counted", number(&spread["count"]) == rounds);
    }
    let least: f64 = kernels.values().map(|kernel| number(&kernel["seconds"]["least"])).sum();
    hold("kernels are parts of the pass", least <= number(&device["timed_pass"]["most"]) * 1.001);
    hold(
        "the rest is what is left",
        number(&device["rest"]["least"]) <= number(&device["timed_pass"]["most"]),
    );
    for (kernel, rate, count) in [
        ("eye_trace", "rays_per_second", "eye_rays"),
        ("photon_trace", "photons_per_second", "photons"),
        ("photon_trace", "rays_per_second", "photon_rays"),
        ("gather", "gathers_per_second", "gathers"),
        ("gather", "photons_per_second", "gathered"),
    ] {
        let figures = &kernels[kernel];
        let counted = number(&figures["rates"][rate]) * number(&figures["seconds"]["median"]);
        hold(&format!("{kernel} does so many {count}"), close(counted, number(&work[count])));
    }
    for kernel in ["grid_count", "grid_scan", "grid_scatter", "grid_sort", "resolve"] {
        let bytes = kernels[kernel]["rates"].get("bytes_per_second").map(number);
        if kernel == "resolve" || device["kind"] != "cpu" {
            hold(&format!("{kernel} moves bytes"), bytes.is_some_and(|bytes| bytes > 0.0));
        } else {
            hold(&format!("the bytes of {kernel} are not known"), bytes.is_none());
        }
    }
    let paths = number(&device["rates"]["paths_per_second"]) * number(&device["pass"]["median"]);
    hold(
        "paths are photons and eye paths",
        close(paths, number(&work["photons"]) + number(&work["eye_paths"])),
    );
    let buffers = device["memory"]["buffers"].as_object().unwrap();
    let film = number(&buffers["film"])
        + number(&buffers["visible_points"])
        + number(&buffers["gathered"]);
    hold("bytes of a pixel", close(film, 384.0 * number(&device["memory"]["per_pixel"])));
    list
}

#[test]
fn figures_agree_with_themselves_and_between_devices() {
    let folder = folder("figures");
    let _ = software();
    let report = json(
        &folder,
        &[
            "ball.toml",
            "--device",
            "cpu",
            "--device",
            "software",
            "--passes",
            "2",
            "--slice",
            "50ms",
            "--slice",
            "none",
            "--json",
        ],
    );
    for (key, expected) in
        [("event", "bench"), ("version", env!("CARGO_PKG_VERSION")), ("scene", "ball")]
    {
        assert_eq!(report[key], expected);
    }
    assert!(report["machine"]["os"].is_string() && number(&report["machine"]["threads"]) >= 1.0);
    assert_eq!(report["settings"]["photons"], 3000);
    let devices = report["devices"].as_array().unwrap();
    assert_eq!(devices.iter().map(|d| &d["kind"]).collect::<Vec<_>>(), ["cpu", "software"]);
    for device in devices {
        let list = faults(device, 2.0);
        assert!(list.is_empty(), "{list:#?}\n{device:#}");
        let mut planted = device.clone();
        planted["kernels"]["gather"]["share"] = 0.9.into();
        planted["work"]["photons"] = 3001.into();
        assert!(faults(&planted, 2.0).len() >= 3, "{planted:#}");
        assert!(!faults(device, 3.0).is_empty());
    }
    let [cpu, driver] = [&devices[0], &devices[1]];
    assert_eq!(cpu["work"], driver["work"]);
    assert!(
        cpu["compile"].as_object().unwrap().is_empty()
            && cpu["slices"].as_array().unwrap().is_empty()
    );
    for kernel in driver["kernels"].as_object().unwrap().keys() {
        assert!(number(&driver["compile"][kernel]["checking"]) > 0.0, "{kernel}");
    }
    let slices = driver["slices"].as_array().unwrap();
    assert_eq!(slices.iter().map(|s| s["slice"].as_f64()).collect::<Vec<_>>(), [Some(0.05), None]);
    for slice in slices {
        assert!(number(&slice["submissions"]) >= 1.0 && number(&slice["longest"]) > 0.0, "{slice}");
        assert!(!slice["longest_kernels"].as_array().unwrap().is_empty(), "{slice}");
    }
    assert_eq!(slices[1]["loss"], 0.0);
}

#[test]
fn people_get_a_table() {
    let folder = folder("table");
    let output = bench(
        &folder,
        &["--device", "cpu", "--size", "16x16", "--photons", "500", "--passes", "1"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let table = text(&output.stdout);
    for word in [
        "cornell, 16 x 16 pixels, 500 photons",
        "eye_trace",
        "gather",
        "all kernels",
        "a pass takes",
        "bytes per pixel",
    ] {
        assert!(table.contains(word), "no `{word}` in\n{table}");
    }
}

/// Compared with a black reference the error never falls below the relative error of the lit scene
/// itself.
#[test]
fn time_to_error() {
    let folder = folder("error");
    let common = [
        "ball.toml",
        "--device",
        "cpu",
        "--passes",
        "4",
        "--truth",
        "dark.pfm",
        "--region",
        "floor=0,12,24,16",
    ];
    let reached = json(&folder, &[&common[..], &["--max-relMSE", "1e6", "--json"]].concat());
    let approaches = reached["devices"][0]["to_error"].as_array().unwrap();
    assert_eq!(
        approaches.iter().map(|a| &a["region"]).collect::<Vec<_>>(),
        [&Value::Null, &"floor".into()]
    );
    assert!(number(&approaches[0]["reached_seconds"]) > 0.0);
    assert_eq!(approaches[0]["series"].as_array().unwrap().len(), 1);
    assert_eq!(approaches[1]["reached_seconds"], Value::Null);

    let output = bench(&folder, &[&common[..], &["--max-relMSE", "floor=1e-9", "--json"]].concat());
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("not reached: relMSE of floor"),
        "{}",
        text(&output.stderr)
    );
    let missed: Value = report(&output.stdout);
    let series = missed["devices"][0]["to_error"][1]["series"].as_array().unwrap();
    assert_eq!(
        series.iter().map(|p| number(&p["passes"])).collect::<Vec<_>>(),
        [1.0, 2.0, 3.0, 4.0]
    );
    let noise = json(&folder, &[&common[..], &["--truth-noise", "0.5", "--json"]].concat());
    let whole =
        |report: &Value| number(&report["devices"][0]["to_error"][0]["series"][0]["rel_mse"]);
    assert!((whole(&missed) - whole(&noise) - 0.5).abs() < 1e-9);
}

#[test]
fn mistakes_are_told_before_the_work() {
    let folder = folder("mistakes");
    let fails = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = bench(&folder, arguments);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        for word in words {
            assert!(error.contains(word), "{arguments:?} should say `{word}`: {error}");
        }
    };
    fails(&["no.toml"], 1, &["no.toml"]);
    fails(&["ball.toml", "--device", "toaster"], 4, &["toaster"]);
    fails(&["ball.toml", "--slice", "fast"], 2, &["500ms", "or none"]);
    fails(&["ball.toml", "--warm-up", "0"], 2, &["--warm-up"]);
    fails(&["ball.toml", "--max-relMSE", "0.1"], 2, &["--truth"]);
    let truth = ["ball.toml", "--device", "cpu", "--truth", "dark.pfm"];
    let with = |more: &[&'static str]| [&truth[..], more].concat();
    fails(&with(&["--max-relMSE", "lamp=0.1"]), 2, &["lamp", "--region"]);
    fails(
        &with(&["--max-relMSE", "0.1", "--max-relMSE", "0.2"]),
        2,
        &["whole image", "one for each"],
    );
    fails(&with(&["--region", "a=0,0,9,9", "--region", "a=1,1,9,9"]), 2, &["two regions"]);
    fails(&with(&["--region", "a=0,0,25,9"]), 2, &["beyond the image", "24 columns"]);
    fails(&with(&["--size", "8x8"]), 1, &["8x8", "24x16", "--size"]);
    fails(
        &["ball.toml", "--device", "software", "--method", "path"],
        2,
        &["path tracing", "--device cpu"],
    );
}
