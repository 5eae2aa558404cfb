//! `caustica study`: exit codes, files, and repeated calls.
//!
//! Theory: a study is the set of its renders, one for each configuration and seed. However often it
//! is interrupted, the same command ends with the same set. Finished renders are kept, and equal
//! seeds give equal images, so their errors are equal to the last digit.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::support::{DISC, GLOBE, ball, caustica, ends, error, folder_with, names, text};
use serde_json::Value;

static SCENE: LazyLock<String> = LazyLock::new(|| ball((32, 24), "photons = 2000", &[DISC, GLOBE]));

const SMALL: [&str; 12] = [
    "study",
    "ball.toml",
    "-o",
    "out",
    "--device",
    "cpu",
    "--budget",
    "4s",
    "--vary",
    "method=sppm,path",
    "--vary",
    "radius=4px",
];

fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE)])
}

fn json(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// Finished renders: (configuration, seed) to the first picture's (relMSE, seconds).
fn runs(folder: &Path) -> BTreeMap<(u64, u64), (f64, f64)> {
    let study = json(&folder.join("out/study.json"));
    let runs = study["results"]["runs"].as_array().unwrap().clone();
    let entry = |run: &Value| {
        let first = &run["points"][0];
        let key = (run["config"].as_u64().unwrap(), run["seed"].as_u64().unwrap());
        (key, (first["rel_mse"].as_f64().unwrap(), first["seconds"].as_f64().unwrap()))
    };
    let map: BTreeMap<_, _> = runs.iter().map(entry).collect();
    assert_eq!(map.len(), runs.len(), "no render is there twice");
    map
}

#[test]
fn a_small_study_writes_what_it_promises() {
    let folder = folder("small");
    let output = caustica(&folder, &SMALL);
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    for word in ["3 settings, 3 seeds", "9/9", "truth", "left"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    let said = text(&output.stdout);
    assert!(said.contains("For a preview in") && said.contains("For a final image"), "{said}");
    assert!(said.ends_with("report.html\n"), "{said}");
    // CSV: the same number of fields in each line, and one line for each image.
    let csv = fs::read_to_string(folder.join("out/study.csv")).unwrap();
    let fields = |line: &str| line.split('"').step_by(2).collect::<String>().matches(',').count();
    let head = csv.lines().next().unwrap();
    assert!(csv.lines().all(|line| fields(line) == fields(head)), "{csv}");
    let study = json(&folder.join("out/study.json"));
    let pictures: usize = study["results"]["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["points"].as_array().unwrap().len())
        .sum();
    assert_eq!(csv.lines().count(), 1 + pictures);
    // All three configurations have variance and bias, and their errors fall.
    for curve in study["parts"][0]["curves"].as_array().unwrap() {
        let points = curve["points"].as_array().unwrap();
        assert!(
            points.len() > 2 && points[0]["split"]["variance"].as_f64().unwrap() > 0.0,
            "{curve}"
        );
        let error = |i: usize| points[i]["rel_mse"]["mean"].as_f64().unwrap();
        assert!(error(points.len() - 1) < error(0), "{curve}");
    }
    // The page is self-contained: no address outside, no script.
    let page = fs::read_to_string(folder.join("out/report.html")).unwrap();
    for outside in ["http", "src=\"/", "<script", "<link", "url(", "@import", "NaN"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("data:image/png;base64,") && page.contains("prefers-color-scheme:dark"));
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    assert!(names(&folder.join("out/unfinished")).is_empty(), "pictures are gone");
    // The same command again finds nothing to do.
    let before = runs(&folder);
    let again = caustica(&folder, &[&SMALL[..], &["--json"]].concat());
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    let events: Vec<Value> =
        text(&again.stdout).lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let names: Vec<&str> = events.iter().map(|event| event["event"].as_str().unwrap()).collect();
    assert_eq!(names, ["start", "done"]);
    assert_eq!((events[1]["runs"].as_u64(), runs(&folder)), (Some(9), before));
}

#[cfg(unix)]
#[test]
fn an_interrupted_study_goes_on_to_the_same_end() {
    use crate::support::{Running, interruptible, signal};
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;

    let whole = folder("whole");
    assert_eq!(caustica(&whole, &SMALL).status.code(), Some(0));
    let folder = folder("interrupted");
    let mut child = Running::start(
        interruptible(&folder, &[&SMALL[..], &["--json"]].concat())
            .stdout(Stdio::piped())
            .stderr(Stdio::null()),
    );
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let second = lines.by_ref().map(Result::unwrap).filter(|line| line.contains("\"run\"")).nth(1);
    assert!(second.is_some());
    signal(&child, "INT");
    let last = lines.map(Result::unwrap).last().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{last}");
    assert!(last.contains("\"complete\":false"), "{last}");
    let kept = runs(&folder);
    assert!((2..9).contains(&kept.len()), "{}", kept.len());
    assert!(
        fs::read_to_string(folder.join("out/report.html")).unwrap().contains("Interrupted after")
    );

    assert_eq!(caustica(&folder, &SMALL).status.code(), Some(0));
    let ended = runs(&folder);
    assert_eq!(ended.keys().collect::<Vec<_>>(), runs(&whole).keys().collect::<Vec<_>>());
    // Finished renders were kept: their times are equal to the last digit.
    assert!(kept.iter().all(|(key, run)| ended[key] == *run));
    let study = json(&folder.join("out/study.json"));
    assert!(!study["results"]["products"].as_array().unwrap().is_empty());
}

#[test]
fn what_does_not_belong_is_refused() {
    let folder = folder("refused");
    let refused = |arguments: &[&str], code: i32, word: &str| {
        ends(&folder, arguments, code, &[word]);
    };
    let study = ["study", "ball.toml", "-o", "out", "--device", "cpu", "--budget", "2s", "--quiet"];
    let with = |more: &[&'static str]| [&study[..], more].concat();
    refused(&with(&["--grid", "radios=1px"]), 2, "did you mean `radius`");
    refused(&with(&["--grid", "alpha=2"]), 2, "above 0 and up to 1");
    refused(&with(&["--crop", "0,0,99,9"]), 2, "extends beyond the image");
    refused(&with(&["--truth-time", "5s"]), 2, "takes the whole budget");
    refused(&with(&["--grid", "device=cpu,Voodoo2"]), 4, "there is no device `Voodoo2`");
    refused(&with(&["--truth", "missing.exr"]), 1, "missing.exr");
    assert!(!folder.join("out").exists(), "nothing was begun");
    // A reference of another size is refused.
    let truth = [
        "render",
        "ball.toml",
        "--device",
        "cpu",
        "--quiet",
        "--passes",
        "1",
        "--size",
        "20x10",
        "-o",
        "t.exr",
    ];
    assert_eq!(caustica(&folder, &truth).status.code(), Some(0));
    refused(
        &with(&["--truth", "t.exr", "--size", "32x24", "-o", "other"]),
        2,
        "cannot be used multiple times",
    );
    let small = with(&["--seeds", "1", "--vary", "radius=2px", "--size", "32x24"]);
    refused(&[&small[..], &["--truth", "t.exr"]].concat(), 1, "sizes differ");
    fs::remove_dir_all(folder.join("out")).unwrap();
    // The folder of one study is refused for another.
    assert_eq!(caustica(&folder, &small).status.code(), Some(0));
    refused(
        &with(&["--seeds", "2", "--vary", "radius=2px", "--size", "32x24"]),
        2,
        "contains a study with 1 seeds",
    );
    refused(
        &with(&["--seeds", "1", "--vary", "radius=3px", "--size", "32x24"]),
        2,
        "a different grid",
    );
    fs::write(folder.join("ball.toml"), SCENE.replace("ior = 1.5", "ior = 1.4")).unwrap();
    refused(&small, 2, "a different text of this scene");
    fs::create_dir(folder.join("mine")).unwrap();
    fs::write(folder.join("mine/letter"), "dear").unwrap();
    let mine: Vec<&str> =
        small.iter().map(|word| if *word == "out" { "mine" } else { word }).collect();
    refused(&mine, 2, "something other than a study");
    assert_eq!(fs::read_to_string(folder.join("mine/letter")).unwrap(), "dear");
}

/// Each lamp size has its own reference, and a disc lamp cannot become a point.
#[test]
fn lamps_shrink() {
    let folder = folder("lamps");
    let study = [
        "study",
        "ball.toml",
        "-o",
        "out",
        "--device",
        "cpu",
        "--budget",
        "4s",
        "--seeds",
        "2",
        "--quiet",
    ];
    let grid = ["--grid", "lamp_area=1,1e-4,point", "--grid", "method=sppm,path"];
    let output = caustica(&folder, &[&study[..], &grid].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let study_json = json(&folder.join("out/study.json"));
    assert_eq!(study_json["parts"].as_array().unwrap().len(), 3);
    assert!(
        fs::read_to_string(folder.join("out/report.html"))
            .unwrap()
            .contains("Effect of the lamp area")
    );
    assert!(folder.join("out/charts/lamps.svg").exists());
    let flat = SCENE.replace(
        "type = \"sphere\"\ncenter = [0.0, 3.0, 1.0]\nradius = 0.3",
        "type = \"disc\"\ncenter = [0.0, 3.0, 1.0]\nnormal = [0.0, -1.0, 0.0]\nradius = 0.3",
    );
    fs::write(folder.join("ball.toml"), flat).unwrap();
    let other: Vec<&str> =
        study.iter().map(|word| if *word == "out" { "flat" } else { word }).collect();
    let output = caustica(&folder, &[&other[..], &grid].concat());
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("spherical"), "{}", text(&output.stderr));
}

/// Tessellation of surfaces of revolution is a study axis with one reference, the exact surfaces. A
/// scene without such surfaces is refused at once.
#[test]
fn revolutions_become_meshes() {
    let folder = folder("revolutions");
    let study = [
        "study",
        "ball.toml",
        "-o",
        "out",
        "--device",
        "cpu",
        "--budget",
        "4s",
        "--seeds",
        "2",
        "--quiet",
    ];
    let vary = ["--vary", "revolutions=exact,16", "--vary", "newton_tolerance=1e-2"];
    let output = caustica(&folder, &[&study[..], &vary].concat());
    assert_eq!(output.status.code(), Some(2));
    let error = error(&output);
    assert!(error.contains("the scene has no surface of revolution"), "{error}");
    let with = SCENE.clone()
        + "[[shapes]]\ntype = \"revolution\"\nprofile = [[0.0, 0.0], [0.6, 0.3], [0.0, 1.0]]\n\
           material = \"white\"\n";
    fs::write(folder.join("ball.toml"), with).unwrap();
    let other: Vec<&str> =
        study.iter().map(|word| if *word == "out" { "with" } else { word }).collect();
    let output = caustica(&folder, &[&other[..], &vary].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let study_json = json(&folder.join("with/study.json"));
    let labels: Vec<&str> =
        study_json["labels"].as_array().unwrap().iter().map(|l| l.as_str().unwrap()).collect();
    assert_eq!(labels, ["scene settings", "meshes of 16 sectors", "Newton tolerance 1e-2"]);
    assert_eq!(study_json["parts"].as_array().unwrap().len(), 1, "one truth");
    let csv = fs::read_to_string(folder.join("with/study.csv")).unwrap();
    assert!(
        csv.lines().next().unwrap().contains("revolutions,newton_tolerance")
            && csv.contains(",16,least,")
    );
}

/// Reports the time that omitted features save; omitting them changes no bit.
#[test]
fn info_measures_what_is_left_out() {
    let folder = folder("measure");
    let output = caustica(&folder, &["info", "ball.toml", "--measure", "--device", "cpu"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&output.stdout);
    let rows: Vec<&str> = said
        .lines()
        .filter(|line| line.starts_with("+ ") || line.starts_with("as it is"))
        .collect();
    assert!(rows.len() > 5 && rows.iter().all(|row| row.ends_with("yes")), "{said}");
    for word in ["+ metal", "+ revolution", "+ all of these"] {
        assert!(rows.iter().any(|row| row.starts_with(word)), "{word}: {said}");
    }
    assert!(!said.contains("+ glass"), "it has that: {said}");
    let nothing = caustica(
        &folder,
        &["info", "ball.toml", "--measure", "--device", "cpu", "--method", "path"],
    );
    assert_eq!(nothing.status.code(), Some(2));
}
