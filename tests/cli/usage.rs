//! Exit codes and messages of commands that do not render.
//!
//! Theory: a mistake ends with its own exit code and a message on standard error that names the
//! mistake and the remedy. Standard output stays empty, and no file is written.

use std::fs;
use std::path::PathBuf;
use std::process::Output;

use crate::support::{self, caustica, folder_with, names, text};

const SCENE: &str = r#"
version = 1
[camera]
position = [0.0, 0.0, 5.0]
target = [0.0, 0.0, 0.0]
fov = 40.0
[film]
width = 16
height = 8
[materials.white]
type = "diffuse"
reflectance = 0.5
[[shapes]]
type = "sphere"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "white"
[[lights]]
type = "point"
position = [0.0, 3.0, 3.0]
intensity = [10.0, 10.0, 10.0]
"#;

/// A fresh folder with a valid scene, `ball.toml`.
fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", SCENE)])
}

/// Runs a command in a fresh folder. The exit code must match, standard error must contain all the
/// words, standard output must be empty, and no file may be left.
fn fails(name: &str, arguments: &[&str], code: i32, words: &[&str]) {
    let folder = folder(name);
    support::fails(&folder, arguments, code, words);
    assert_eq!(names(&folder), ["ball.toml"], "{arguments:?}");
}

#[test]
fn wrong_use_is_2() {
    fails("none", &[], 2, &["Usage"]);
    fails("command", &["rendr", "ball.toml"], 2, &["rendr", "render"]);
    fails("option", &["render", "ball.toml", "--pases", "3"], 2, &["--pases", "--passes"]);
    fails("no scene", &["render"], 2, &["<SCENE>"]);
    fails(
        "method",
        &["render", "ball.toml", "--method", "sspm"],
        2,
        &["sspm", "sppm", "ppm", "path"],
    );
    fails("rule", &["render", "ball.toml", "--radius-rule", "x"], 2, &["global", "local", "fixed"]);
    fails("direct", &["render", "ball.toml", "--direct", "x"], 2, &["sampled", "photons"]);
    fails("radius", &["render", "ball.toml", "--radius", "-1"], 2, &["2px", "0.01"]);
    fails("alpha", &["render", "ball.toml", "--alpha", "1.5"], 2, &["up to 1"]);
    fails("passes", &["render", "ball.toml", "--passes", "0"], 2, &["0"]);
    fails("size", &["render", "ball.toml", "--size", "640"], 2, &["640x480"]);
    fails("time", &["render", "ball.toml", "--time", "30"], 2, &["30s"]);
    fails("device", &["render", "ball.toml", "--device", ""], 2, &["--device"]);
    fails(
        "devices",
        &["compare", "ball.toml", "--device", "cpu"],
        2,
        &["two devices", "--device gpu"],
    );
    fails("bits", &["compare", "ball.toml", "--max-relmse", "-1"], 2, &["zero or more"]);
}

#[test]
fn outputs_are_known_before_the_scene_is_read() {
    let known = [".png", ".exr", ".pfm", ".hdr"];
    fails(
        "extension",
        &["render", "missing.toml", "-o", "a.jpg"],
        2,
        &[&["a.jpg"], &known[..]].concat(),
    );
    fails("bare", &["render", "missing.toml", "-o", "picture"], 2, &known);
    fails(
        "twice",
        &["render", "missing.toml", "-o", "a.png", "-o", "a.png"],
        2,
        &["a.png", "more than once"],
    );
    fails(
        "folder",
        &["render", "missing.toml", "-o", "no/a.png"],
        1,
        &["no/a.png", "the folder `no` does not exist", "create"],
    );
    fails(
        "second",
        &["render", "missing.toml", "-o", "a.exr", "-o", "no/a.png"],
        1,
        &["the folder `no` does not exist"],
    );
    fails("map", &["compare", "missing.toml", "-o", "map.exr"], 2, &["map.exr", ".png"]);
    fails(
        "map folder",
        &["compare", "missing.toml", "-o", "no/map.png"],
        1,
        &["the folder `no` does not exist"],
    );
}

#[test]
fn scenes_with_errors_are_1() {
    for command in ["render", "info", "compare"] {
        fails(&format!("missing {command}"), &[command, "missing.toml"], 1, &["missing.toml"]);
    }
    for command in ["render", "info", "compare"] {
        let folder = folder(&format!("bad {command}"));
        fs::write(folder.join("bad.toml"), SCENE.replace("radius = 1.0", "radius = -1.0")).unwrap();
        let output = caustica(&folder, &[command, "bad.toml"]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains("bad.toml:16:") && error.contains("radius = -1.0"), "{error}");
        assert_eq!(names(&folder).len(), 2, "nothing is written");
    }
}

#[test]
fn a_device_that_is_not_there_is_4() {
    fails("device 4", &["render", "ball.toml", "--device", "Voodoo 9"], 4, &["Voodoo 9"]);
    fails(
        "compare 4",
        &["compare", "ball.toml", "--device", "cpu", "--device", "Voodoo 9"],
        4,
        &["there is no device"],
    );
}

#[test]
fn check_tells_good_from_bad() {
    let folder = folder("check");
    fs::write(
        folder.join("bad.toml"),
        SCENE.replace("\"white\"\n[[lights]]", "\"whit\"\n[[lights]]"),
    )
    .unwrap();
    let good = caustica(&folder, &["check", "ball.toml"]);
    assert_eq!((good.status.code(), text(&good.stdout).as_str()), (Some(0), "ball.toml: good\n"));
    assert_eq!(text(&good.stderr), "");
    let mixed = caustica(&folder, &["check", "bad.toml", "ball.toml", "missing.toml"]);
    assert_eq!(mixed.status.code(), Some(1));
    assert_eq!(text(&mixed.stdout), "bad.toml: bad\nball.toml: good\nmissing.toml: bad\n");
    let error = text(&mixed.stderr);
    for word in ["whit", "white", "missing.toml", "2 of 3"] {
        assert!(error.contains(word), "{word}: {error}");
    }
}

#[test]
fn info_tells_what_is_needed_and_what_is_not() {
    let folder = folder("info");
    let output = caustica(&folder, &["info", "ball.toml", "--size", "32x24", "--passes", "7"]);
    let shown = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let line = |start: &str| shown.lines().find(|line| line.starts_with(start)).unwrap_or_default();
    assert!(shown.contains("32 x 24") && shown.contains('7'), "{shown}");
    assert!(
        line("features needed").contains("point") && !line("features needed").contains("glass"),
        "{shown}"
    );
    let left_out: Vec<&str> = line("features left out: ").split([' ', ',']).collect();
    assert!(left_out.contains(&"glass") && !left_out.contains(&"diffuse"), "{shown}");
    assert_eq!(line("triangles"), "", "no table that the scene does without: {shown}");
    // Without a radius the report shows the chosen one and why; path tracing has none.
    let chosen = |output: &Output| {
        text(&output.stdout).lines().filter(|l| l.starts_with("start radius: ")).count()
    };
    assert!(line("start radius: ").contains(" px for diffusely"), "{shown}");
    assert_eq!(chosen(&caustica(&folder, &["info", "ball.toml", "--radius", "2px"])), 0);
    let path = caustica(&folder, &["info", "ball.toml", "--method", "path"]);
    assert_eq!(chosen(&path), 0);
    let path = text(&path.stdout);
    assert!(path.contains("kernels needed: path_trace\n"), "{path}");
    assert!(path.contains("\nfilm ") && !path.contains("\nrecords "), "{path}");
    assert!(shown.contains("\nrecords "), "{shown}");
    let lens = SCENE.replace("fov = 40.0", "fov = 40.0\naperture = 0.1\nfocus = 4.0");
    fs::write(folder.join("lens.toml"), lens).unwrap();
    let shown = text(&caustica(&folder, &["info", "lens.toml"]).stdout);
    assert!(
        shown.lines().any(|line| line.starts_with("features needed") && line.contains("lens")),
        "{shown}"
    );
}

/// The help lists only features that are compiled in.
#[test]
fn help_lists_only_what_works() {
    let folder = folder("help");
    let help = caustica(&folder, &["--help"]);
    assert_eq!(help.status.code(), Some(0));
    let help = text(&help.stdout);
    let with = [
        "render",
        "merge",
        "compare",
        "diff",
        "study",
        "bench",
        "info",
        "check",
        "devices",
        "tessellate",
        "completions",
        "man",
        "preview",
    ];
    for command in with {
        assert!(help.contains(&format!("\n  {command} ")), "{command}: {help}");
        if command == "preview" && !cfg!(feature = "preview") {
            let refused = caustica(&folder, &[command, "a.toml", "--device", "cpu"]);
            assert_eq!(refused.status.code(), Some(2));
            let said = text(&refused.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
            let line = "--features preview -- preview a.toml --device cpu";
            assert!(said.contains(line), "{said}");
            continue;
        }
        let own = caustica(&folder, &[command, "--help"]);
        assert_eq!(own.status.code(), Some(0), "{command}");
        assert!(text(&own.stdout).contains("Usage"), "{command}");
    }
    for code in ["0 ", "1 ", "2 ", "3 ", "4 ", "5 ", "130 "] {
        assert!(help.split("Exit codes:").nth(1).unwrap().contains(code), "{code}");
    }
    let version = caustica(&folder, &["--version"]);
    assert_eq!(text(&version.stdout), format!("caustica {}\n", env!("CARGO_PKG_VERSION")));
}

/// Every example in the help texts runs; renders are made small.
#[test]
fn examples_of_the_help_texts_run() {
    let folder = folder("examples");
    fs::remove_file(folder.join("ball.toml")).unwrap();
    let scenes = format!("{}/scenes/", env!("CARGO_MANIFEST_DIR"));
    let mut run = 0;
    for command in [
        &["--help"][..],
        &["render", "--help"],
        &["info", "--help"],
        &["check", "--help"],
        &["tessellate", "--help"],
    ] {
        let help = text(&caustica(&folder, command).stdout);
        let examples = help.lines().filter_map(|line| line.strip_prefix("  caustica "));
        for example in examples {
            let example = example.replace("scenes/", &scenes);
            let mut arguments: Vec<_> = example.split(' ').collect();
            if arguments[0] == "render" {
                arguments.extend(["--passes", "1", "--photons", "1000"]);
                // examples with a crop or a reproduced image keep the size
                if !["--crop", "--like"].iter().any(|option| example.contains(option)) {
                    arguments.extend(["--size", "16x16"]);
                }
                arguments
                    .extend(["--device", "cpu"].iter().filter(|_| !example.contains("--device")));
            }
            let output = caustica(&folder, &arguments);
            assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
            run += 1;
        }
    }
    assert_eq!(run, 12, "two, seven, one, one and one");
    assert_eq!(
        names(&folder),
        [
            "again.exr",
            "caustics.png",
            "cornell.checkpoint",
            "cornell.exr",
            "cornell.png",
            "layers.exr",
            "picture.exr",
            "picture.png",
            "vase.obj"
        ]
    );
}

/// Theory: numbers that single precision cannot hold are warnings, not errors. `check` counts them
/// and shows number, file, line and column, and `render` repeats them before it renders, including
/// those from the command line.
#[test]
fn limits_are_told() {
    let folder = folder("limits");
    let tiny = SCENE.replace("radius = 1.0", "radius = 1e-6");
    fs::write(folder.join("tiny.toml"), tiny).unwrap();
    let output = caustica(&folder, &["check", "tiny.toml"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(
        text(&output.stdout).contains("tiny.toml: good, 2 warnings"),
        "{}",
        text(&output.stdout)
    );
    let error = text(&output.stderr);
    for word in
        ["shapes[0] is", "tiny.toml:16:10", "expected at least 1e-5", "the camera's distance"]
    {
        assert!(error.contains(word), "{word}: {error}");
    }
    let quick = ["--device", "cpu", "--passes", "1", "--photons", "10", "--quiet"];
    let output =
        caustica(&folder, &[&["render", "ball.toml", "--radius", "1e-7"], &quick[..]].concat());
    assert_eq!(output.status.code(), Some(0));
    assert!(text(&output.stderr).contains("the gather radius is"), "{}", text(&output.stderr));
    let output = caustica(&folder, &[&["render", "ball.toml"], &quick[..]].concat());
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
}
