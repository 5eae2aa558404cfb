//! Checkpoints on the command line: refusals with reasons, messages, and merging.

use std::fs;

use caustica::low_level::checkpoint::{read, write};
use caustica::low_level::film::file::read_exr;

use super::{MESH, SCENE, fails, folder, good};

#[test]
fn other_renders_are_refused_with_the_reason() {
    let folder = folder("refused");
    let line = "render ball.toml --quiet";
    good(&folder, &format!("{line} --device cpu --passes 4 --checkpoint a.checkpoint -o a.exr"));
    let on_cpu = format!("{line} --device cpu --resume a.checkpoint -o b.exr");
    let refused = |more: &str, words: &[&str]| {
        let words = [
            &["a.checkpoint: the checkpoint belongs to a different render", "drop --resume"],
            words,
        ]
        .concat();
        let device = if more.contains("--device") { "" } else { "--device cpu" };
        fails(
            &folder,
            &format!("{line} {device} --resume a.checkpoint -o b.exr {more}"),
            1,
            &words,
        );
        assert!(!folder.join("b.exr").exists());
    };
    refused("--seed 5", &["`seed`: expected 5, found 0"]);
    refused("--photons 1501", &["`photons`: expected 1501, found 1500"]);
    refused("--method ppm", &["`method`: expected \"ppm\", found \"sppm\""]);
    refused(
        "--radius 0.25 --alpha 0.5",
        &["`radius`: expected {\"units\":0.25}, found {", "`alpha`: expected 0.5"],
    );
    refused("--size 20x16", &["size: expected 20 x 16, found 24 x 16"]);
    refused("--crop 1,2,9,10", &["crop: expected 1,2,9,10, found the whole image"]);
    refused("--aov depth", &["layers: expected depth, found none"]);
    refused("--device cpu-f64", &["precision: expected 64 bits, found 32"]);
    refused("--passes 2..9", &["first pass: expected 2, found 0"]);
    // the scene file: a changed shape, then a changed mesh file
    let moved = SCENE.replace("center = [0.0, 0.7, 0.0]", "center = [0.0, 0.8, 0.0]");
    fs::write(folder.join("ball.toml"), moved).unwrap();
    refused(
        "",
        &[
            "scene (",
            "shapes",
            "expected `center = [0.0, 0.8, 0.0]`, found `center = [0.0, 0.7, 0.0]`",
        ],
    );
    fs::write(folder.join("ball.toml"), SCENE.as_str()).unwrap();
    fs::write(folder.join("wall.obj"), MESH.replace("0 2 -1.5", "0 1.9 -1.5")).unwrap();
    refused("", &["scene (", "shapes", "a mesh, image or profile that it uses differs"]);
    fs::write(folder.join("wall.obj"), MESH).unwrap();
    // a checkpoint of another version
    let file = folder.join("a.checkpoint");
    let sound = read(&file).unwrap();
    assert!(sound.origin.version.starts_with(concat!(env!("CARGO_PKG_VERSION"), ", kernels ")));
    let mut other = sound.clone();
    other.origin.version = "0.0.9".into();
    write(&file, &other).unwrap();
    refused("", &["caustica version: expected", "found 0.0.9"]);
    write(&file, &sound).unwrap();
    fails(
        &folder,
        &format!("{on_cpu} --passes 3"),
        1,
        &["contains passes 0..4", "before pass 3", "--passes 4"],
    );
    // comments, the number of passes and development do not affect the state and are accepted
    let reported = SCENE
        .replace("version = 1", "# a comment\nversion = 1")
        .replace("height = 16", "height = 16\nexposure = 1.0");
    fs::write(folder.join("ball.toml"), reported).unwrap();
    good(&folder, &format!("{on_cpu} --passes 5"));
}

#[test]
fn what_is_no_use_is_told_before_the_work() {
    let folder = folder("useless");
    let line = "render ball.toml --device cpu --quiet";
    fails(&folder, &format!("{line} --resume a.checkpoint"), 1, &["a.checkpoint: cannot be read"]);
    fs::write(folder.join("note.txt"), "hello").unwrap();
    fails(
        &folder,
        &format!("{line} --resume note.txt"),
        1,
        &["note.txt: not a checkpoint", "--checkpoint"],
    );
    fails(
        &folder,
        &format!("{line} --checkpoint note.txt"),
        2,
        &["note.txt: the file already exists", "--resume"],
    );
    fails(&folder, &format!("{line} --checkpoint a.png"), 1, &["belongs to images", ".checkpoint"]);
    fails(
        &folder,
        &format!("{line} --checkpoint no/a.checkpoint"),
        1,
        &["no/a.checkpoint: cannot be written"],
    );
    fails(&folder, &format!("{line} --checkpoint ."), 1, &["cannot be written"]);
    fails(&folder, &format!("{line} --checkpoint-every 1s"), 2, &["--checkpoint <FILE>"]);
    fails(&folder, &format!("{line} --checkpoint a --checkpoint-every 1"), 2, &["30s"]);
    for bad in ["5..5", "6..5", "..5", "5..", "0", "a..b"] {
        fails(&folder, &format!("{line} --passes {bad}"), 2, &["0..500"]);
    }
    fails(
        &folder,
        &format!("{line} --passes 2..5 --radius-rule local"),
        2,
        &["local radius rule", "--resume", "global"],
    );
    fails(
        &folder,
        "compare ball.toml --device cpu --device cpu --passes 2..5",
        2,
        &["starts at pass 0"],
    );
    fails(&folder, "info ball.toml --passes 2..5", 2, &["starts at pass 0"]);
    good(&folder, "info ball.toml --passes 0..5");
    // a truncated checkpoint
    good(&folder, &format!("{line} --passes 2 --checkpoint a.checkpoint -o a.exr"));
    let bytes = fs::read(folder.join("a.checkpoint")).unwrap();
    fs::write(folder.join("cut.checkpoint"), &bytes[..bytes.len() / 2]).unwrap();
    let half = (bytes.len() / 2).to_string();
    fails(
        &folder,
        &format!("{line} --resume cut.checkpoint"),
        1,
        &["should have", &half, "truncated"],
    );
    fails(&folder, "merge cut.checkpoint -o b.exr", 1, &["cut.checkpoint", "should have", &half]);
}

/// Theory: a finished render can be extended to more passes, on another device and with the same
/// bits. If no pass is left, the image is written again. The JSON events report each of these.
#[test]
fn a_finished_render_goes_on() {
    let folder = folder("further");
    let line = "render ball.toml --json";
    let keep = "--checkpoint a.checkpoint";
    good(&folder, &format!("{line} --device cpu --passes 9 -o whole.exr"));
    let first = good(
        &folder,
        &format!("{line} --device cpu --passes 5 {keep} --checkpoint-every 1h -o a.exr"),
    );
    let events = |lines: &str, name: &str| -> Vec<serde_json::Value> {
        let lines =
            lines.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
        lines.filter(|line| line["event"] == name).collect()
    };
    let kept = events(&first, "checkpoint");
    assert_eq!(kept.len(), 1, "one at the end: {first}");
    assert_eq!((&kept[0]["file"], &kept[0]["passes"]), (&"a.checkpoint".into(), &5.into()));
    let again =
        good(&folder, &format!("{line} --device cpu --passes 5 --resume a.checkpoint -o b.exr"));
    assert_eq!(events(&again, "resume")[0]["passes"], 5);
    assert_eq!(events(&again, "done")[0]["photons"], events(&first, "done")[0]["photons"]);
    assert!(fs::read(folder.join("a.exr")).unwrap() == fs::read(folder.join("b.exr")).unwrap());
    let more = good(
        &folder,
        &format!(
            "{line} --device software --passes 9 --resume a.checkpoint {keep} --checkpoint-every 1ms -o c.exr"
        ),
    );
    assert_eq!(events(&more, "done")[0]["passes"], 9);
    assert_eq!(events(&more, "checkpoint").last().unwrap()["passes"], 9);
    let channels = |file: &str| read_exr(&folder.join(file)).unwrap().channels;
    assert!(channels("c.exr") == channels("whole.exr"));
    assert_eq!(read(&folder.join("a.checkpoint")).unwrap().state.passes, 9);
    // the calibration passes of a preset are not rendered again
    let preset = format!("{line} --device cpu --quality draft");
    let begun = good(&folder, &format!("{preset} --passes 3 --checkpoint b.checkpoint -o d.exr"));
    assert_eq!(events(&begun, "calibration").len(), 1);
    let resumed = good(&folder, &format!("{preset} --passes 4 --resume b.checkpoint -o d.exr"));
    assert_eq!(
        (events(&resumed, "calibration").len(), &events(&resumed, "done")[0]["passes"]),
        (0, &4.into())
    );
}

/// Theory: 0..9 is 0..4 merged with 4..9, on any devices, as an image or as a checkpoint, and the
/// attributes say so. Merging one checkpoint alone gives its own image byte for byte.
#[test]
fn ranges_merge() {
    let folder = folder("merge");
    let range = |passes: &str, name: &str, device: &str| {
        let line = format!("render ball.toml --device {device} --quiet --passes {passes}");
        good(&folder, &format!("{line} --checkpoint {name}.checkpoint -o {name}.exr"));
    };
    range("9", "whole", "cpu");
    range("0..4", "a", "cpu");
    range("4..9", "b", "software");
    range("9..11", "c", "cpu");
    range("12..13", "d", "cpu");
    let merge = |files: &str, output: &str| good(&folder, &format!("merge {files} -o {output}"));
    assert_eq!(
        merge("b.checkpoint a.checkpoint", "ab.exr -o ab.checkpoint -o ab.png"),
        "ab.exr\nab.checkpoint\nab.png\n"
    );
    let [whole, ab] = ["whole.exr", "ab.exr"].map(|file| read_exr(&folder.join(file)).unwrap());
    let far = |name: &str| {
        let pairs = whole.channels[name].iter().zip(&ab.channels[name]);
        let largest = whole.channels[name].iter().fold(0f32, |m, x| m.max(x.abs()));
        pairs.map(|(x, y)| (x - y).abs()).fold(0f32, f32::max) / largest
    };
    for name in ["R", "G", "B", "Variance.Y", "Bias.Y"] {
        assert!(far(name) < 1e-5, "{name}: {}", far(name));
    }
    assert!(far("R") > 0.0 || far("Variance.Y") > 0.0, "two ways of rounding");
    assert_eq!(
        (&ab.attributes["caustica.passes_done"], &ab.attributes["caustica.passes"]),
        (&"9".into(), &"9".into())
    );
    assert!(
        ab.attributes["caustica.device"].starts_with("cpu + "),
        "{}",
        ab.attributes["caustica.device"]
    );
    let b = read_exr(&folder.join("b.exr")).unwrap();
    assert_eq!(
        (&b.attributes["caustica.first_pass"], &b.attributes["caustica.passes_done"]),
        (&"4".into(), &"5".into())
    );
    merge("whole.checkpoint", "same.exr");
    // an image written by `render` has further attributes
    let [same, whole] = ["same.exr", "whole.exr"].map(|file| read_exr(&folder.join(file)).unwrap());
    assert!(same.channels == whole.channels);
    for (name, value) in &same.attributes {
        assert_eq!(Some(value), whole.attributes.get(name), "{name}");
    }
    merge("ab.checkpoint c.checkpoint", "abc.exr");
    merge("a.checkpoint c.checkpoint b.checkpoint", "cab.exr");
    assert!(fs::read(folder.join("abc.exr")).unwrap() == fs::read(folder.join("cab.exr")).unwrap());

    let wrong = |files: &str, output: &str, code: i32, words: &[&str]| {
        fails(&folder, &format!("merge {files} -o {output}"), code, words);
    };
    wrong("a.checkpoint c.checkpoint", "x.exr", 1, &["passes 4..9 are missing", "--passes 4..9"]);
    wrong("ab.checkpoint b.checkpoint", "x.exr", 1, &["passes 4..9 are in both"]);
    wrong("c.checkpoint d.checkpoint", "x.exr", 1, &["passes 11..12 are missing"]);
    wrong("a.checkpoint a.exr", "x.exr", 1, &["a.exr: not a checkpoint"]);
    wrong("a.checkpoint", "x.tif", 2, &["x.tif", ".checkpoint"]);
    wrong("a.checkpoint", "no/x.exr", 1, &["the folder `no` does not exist"]);
    wrong("a.checkpoint", "no/x.checkpoint", 1, &["no/x.checkpoint"]);
    range("4..9 --seed 3", "seed", "cpu");
    wrong("a.checkpoint seed.checkpoint", "x.exr", 1, &["`seed`: expected 0, found 3"]);
    let on = "render ball.toml --device cpu --quiet --passes 12 --resume ab.checkpoint";
    fails(
        &folder,
        &format!("{on} -o x.exr"),
        1,
        &["ab.checkpoint: a merged checkpoint", "passes from 9 on"],
    );
    assert!(!folder.join("x.exr").exists());
}

/// Theory: a target error ends a render after the same pass wherever the render was interrupted.
#[test]
fn an_error_aimed_at_is_met_in_the_same_pass() {
    let folder = folder("target");
    let line = "render ball.toml --device cpu --quiet --target-error 8%";
    good(&folder, &format!("{line} -o whole.exr"));
    let passes = read_exr(&folder.join("whole.exr")).unwrap().attributes["caustica.passes_done"]
        .parse::<u32>()
        .unwrap();
    assert!((8..200).contains(&passes), "stops on its way: {passes}");
    for stop in [1, 3, passes / 2, passes - 1, passes] {
        let keep = format!("--passes {stop} --checkpoint {stop}.checkpoint");
        good(&folder, &format!("render ball.toml --device cpu --quiet {keep} -o a.exr"));
        good(&folder, &format!("{line} --resume {stop}.checkpoint -o a.exr"));
        let [a, whole] = ["a.exr", "whole.exr"].map(|file| read_exr(&folder.join(file)).unwrap());
        assert_eq!(a.attributes["caustica.passes_done"], passes.to_string(), "{stop}");
        assert!(a.channels == whole.channels, "{stop}");
    }
}

#[test]
fn the_help_tells_of_it() {
    let folder = folder("help");
    let help = good(&folder, "render --help");
    for word in [
        "--checkpoint <FILE>",
        "--checkpoint-every <TIME>",
        "--resume <FILE>",
        "docs/checkpoints.md",
    ] {
        assert!(help.contains(word), "{word}: {help}");
    }
    // the examples of merge run unchanged except for their size
    let scenes = format!("{}/scenes/", env!("CARGO_MANIFEST_DIR"));
    let help = good(&folder, "merge --help");
    let examples: Vec<_> =
        help.lines().filter_map(|line| line.strip_prefix("  caustica ")).collect();
    assert_eq!(examples.len(), 3);
    for example in examples {
        let small = if example.starts_with("render") {
            "--size 8x8 --photons 100 --device cpu -o a.png"
        } else {
            ""
        };
        good(&folder, &format!("{} {small}", example.replace("scenes/", &scenes)));
    }
    assert!(folder.join("cornell.exr").exists());
}
