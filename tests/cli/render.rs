//! `caustica render` on the CPU engine.
//!
//! Theory: a script sees the files, the exit code and the JSON lines. Equal commands give equal
//! bytes, and an interrupted render leaves an image of complete passes.

use std::fs;
use std::path::PathBuf;
use std::process::Output;
use std::sync::LazyLock;

use crate::support::{DISC, LAMP, ball, caustica, error, folder_with, json_lines, text};
use caustica::low_level::film::{file, read};

static SCENE: LazyLock<String> =
    LazyLock::new(|| ball((32, 24), "passes = 3\nphotons = 2000", &[DISC, LAMP]));

fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE)])
}

#[test]
fn writes_what_is_asked_for_and_says_where() {
    let folder = folder("outputs");
    let output = caustica(
        &folder,
        &["render", "ball.toml", "--device", "cpu", "-o", "a.exr", "-o", "b.png"],
    );
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{error}");
    assert_eq!(text(&output.stdout), "a.exr\nb.png\n");
    for word in ["ball:", "asked for", "3/3 passes", "photons", "rays/s", "radius", "left"] {
        assert!(error.contains(word), "{word}: {error}");
    }
    let exr = file::read_exr(&folder.join("a.exr")).unwrap();
    assert_eq!((exr.width, exr.height), (32, 24));
    assert_eq!(exr.attributes["caustica.passes_done"], "3");
    assert_eq!(exr.attributes["caustica.photons"], "2000");
    assert_eq!(exr.attributes["caustica.scene_text"], *SCENE);
    let mean = exr.channels["G"].iter().sum::<f32>() / (32.0 * 24.0);
    assert!(mean > 1e-3, "the picture is not black: {mean}");
    // Without -o the file has the scene's name and lies in the current folder; --quiet prints
    // nothing.
    let output = caustica(&folder, &["render", "ball.toml", "--device", "cpu", "--quiet"]);
    assert_eq!((text(&output.stdout).as_str(), text(&output.stderr).as_str()), ("ball.png\n", ""));
    assert!(folder.join("ball.png").exists());
}

#[test]
fn options_replace_the_file_and_equal_commands_give_equal_bytes() {
    let folder = folder("options");
    let render = |output: &str, seed: &str| {
        let options = [
            "--size",
            "20x10",
            "--passes",
            "2",
            "--photons",
            "1500",
            "--seed",
            seed,
            "--radius",
            "0.1",
        ];
        let run = ["render", "ball.toml", "--device", "cpu", "--quiet", "-o", output];
        assert_eq!(caustica(&folder, &[&run[..], &options].concat()).status.code(), Some(0));
        fs::read(folder.join(output)).unwrap()
    };
    let first = render("a.exr", "5");
    assert!(render("b.exr", "5") == first);
    // PFM holds pixels only, so the difference is not the seed's attribute.
    assert!(render("c.pfm", "6") != render("d.pfm", "5"), "the seed counts");
    let exr = file::read_exr(&folder.join("a.exr")).unwrap();
    assert_eq!((exr.width, exr.height), (20, 10));
    assert_eq!(exr.attributes["caustica.radius"], "{\"units\":0.1}");
}

#[test]
fn json_tells_start_progress_and_end() {
    let folder = folder("json");
    let output =
        caustica(&folder, &["render", "ball.toml", "--device", "cpu", "--json", "-o", "a.pfm"]);
    assert_eq!(text(&output.stderr), "");
    let lines = json_lines(&output.stdout);
    let events: Vec<&str> = lines.iter().map(|line| line["event"].as_str().unwrap()).collect();
    assert_eq!((events.first(), events.last()), (Some(&"start"), Some(&"done")));
    assert!(
        events[1..events.len() - 1].iter().all(|event| *event == "progress") && events.len() > 2,
        "{events:?}"
    );
    let done = lines.last().unwrap();
    assert_eq!(
        (&done["passes"], &done["ended"], &done["outputs"]),
        (&3.into(), &"passes".into(), &["a.pfm"].into())
    );
    assert_eq!(done["photons"], 6000);
}

#[test]
fn time_ends_a_render() {
    let folder = folder("time");
    let options = ["--device", "cpu", "--json", "--time", "300ms", "-o", "a.pfm"];
    let output = caustica(&folder, &[&["render", "ball.toml"][..], &options].concat());
    assert_eq!(output.status.code(), Some(0));
    let done = json_lines(&output.stdout).pop().unwrap();
    assert_eq!(done["ended"], "time");
    assert!(
        done["passes"].as_u64().unwrap() >= 1 && done["elapsed"].as_f64().unwrap() >= 0.3,
        "{done}"
    );
}

/// Theory: the error is estimated after the same passes in every run, so a target error ends a
/// render after the same pass.
#[test]
fn an_error_aimed_at_ends_a_render() {
    let folder = folder("target_error");
    let aimed = |target: &str, output: &str| {
        let options = ["--device", "cpu", "--json", "--target-error", target, "-o", output];
        let output = caustica(&folder, &[&["render", "ball.toml"][..], &options].concat());
        (output.status.code(), text(&output.stderr), json_lines(&output.stdout))
    };
    let (code, error, lines) = aimed("20%", "a.exr");
    assert_eq!(code, Some(0), "{error}");
    let done = lines.last().unwrap();
    assert_eq!(done["ended"], "target_error");
    let (passes, stated) = (done["passes"].as_u64().unwrap(), done["error"].as_f64().unwrap());
    assert!(passes >= 4 && stated <= 0.2 && stated > 0.0, "{done}");
    let legs = ["error_noise", "error_bias"].map(|leg| done[leg].as_f64().unwrap());
    assert!(legs[0] > 0.0 && legs[0].hypot(legs[1]) <= stated, "{done}");
    let progress: Vec<_> = lines.iter().filter(|line| line["event"] == "progress").collect();
    assert!(
        progress
            .iter()
            .all(|line| line["error"].is_null() == (line["passes"].as_u64().unwrap() < 4))
    );
    // the file has layers in addition to the image
    let exr = file::read_exr(&folder.join("a.exr")).unwrap();
    assert!(exr.channels["Variance.Y"].iter().all(|variance| *variance >= 0.0));
    assert!(exr.channels["Bias.Y"].iter().any(|bias| *bias != 0.0));
    assert_eq!(read(&folder.join("a.exr")).unwrap(), exr.picture("").unwrap());
    // the same target as a number, then a smaller one
    aimed("0.2", "b.exr");
    assert!(fs::read(folder.join("a.exr")).unwrap() == fs::read(folder.join("b.exr")).unwrap());
    let (_, _, lines) = aimed("0.05", "c.pfm");
    assert!(lines.last().unwrap()["passes"].as_u64().unwrap() > passes);
    // with too few passes for an estimate no error is reported and no layers are written
    let output =
        caustica(&folder, &["render", "ball.toml", "--device", "cpu", "--json", "-o", "d.exr"]);
    assert!(json_lines(&output.stdout).pop().unwrap()["error"].is_null());
    assert_eq!(file::read_exr(&folder.join("d.exr")).unwrap().channels.len(), 3);
    for wrong in ["0", "0%", "-1%", "-0.5", "nan", "200%", "2", "much"] {
        let (code, error, _) = aimed(wrong, "e.exr");
        assert_eq!(code, Some(2), "{wrong}: {error}");
        assert!(error.contains("e.g. 2% or 0.02"), "{wrong}: {error}");
    }
}

#[test]
fn compare_holds_its_thresholds() {
    let folder = folder("compare");
    let compare = |more: &[&str]| {
        let run = ["compare", "ball.toml", "--device", "cpu", "--device", "cpu", "--quiet"];
        caustica(&folder, &[&run[..], more].concat())
    };
    let same = compare(&["--bits", "--max-relmse", "0", "--max-mean-ratio", "0", "-o", "map.png"]);
    assert_eq!(same.status.code(), Some(0), "{}", text(&same.stderr));
    assert!(
        text(&same.stdout).contains("pixels that differ    0 of 768"),
        "{}",
        text(&same.stdout)
    );
    assert!(text(&same.stdout).ends_with("map.png\n") && folder.join("map.png").exists());
    // f32 against f64: different bits, the same image
    let rounded = |bound: &[&str]| {
        let run = ["compare", "ball.toml", "--device", "cpu", "--device", "cpu-f64", "--quiet"];
        caustica(&folder, &[&run[..], bound].concat())
    };
    for (bound, code) in [
        (&["--bits"][..], 3),
        (&["--max-relmse", "0"], 3),
        (&["--max-mean-ratio", "0"], 3),
        (&["--max-relmse", "0.01", "--max-mean-ratio", "0.01"], 0),
    ] {
        let output = rounded(bound);
        assert_eq!(output.status.code(), Some(code), "{bound:?}: {}", text(&output.stderr));
        assert_eq!(
            text(&output.stderr).contains("over the threshold"),
            code == 3,
            "{}",
            text(&output.stderr)
        );
    }
}

/// Theory: a preset is a set of settings, and its calibration uses passes of the render itself. So
/// the same settings without a preset give the same bytes. Options override single settings.
#[test]
fn presets_promise_and_keep_their_passes() {
    let folder = folder("quality");
    let render = |options: &[&str]| {
        let run = ["render", "ball.toml", "--device", "cpu", "--json"];
        let output = caustica(&folder, &[&run[..], options].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        json_lines(&output.stdout)
    };
    let draft = render(&["--quality", "draft", "-o", "draft.pfm"]);
    let of = |lines: &[serde_json::Value], event: &str| {
        lines.iter().find(|line| line["event"] == event).cloned().unwrap_or_default()
    };
    let (settings, reported) = (of(&draft, "start")["settings"].clone(), of(&draft, "calibration"));
    // One photon per pixel of 32 x 24, and a radius in numbers.
    assert_eq!((&settings["photons"], &settings["passes"]), (&768.into(), &4.into()));
    let pixels = settings["radius"]["pixels"].as_f64().unwrap();
    assert!(
        of(&draft, "start")["radius_why"].as_str().unwrap().starts_with(&format!("{pixels} px, "))
    );
    assert_eq!((&reported["quality"], &reported["passes"]), (&"draft".into(), &4.into()));
    let error = |key: &str| reported["expected_relMSE"][key].as_f64().unwrap();
    assert!(
        0.0 < error("low") && error("low") <= error("rel_mse") && error("rel_mse") <= error("high")
    );
    assert!(error("high") < reported["one_pass_relMSE"].as_f64().unwrap(), "{reported}");
    assert!(reported["expected_seconds"].as_f64().unwrap() > 0.0);
    assert_eq!(of(&draft, "done")["passes"], 4, "the calibration's passes are among them");
    let radius = format!("{pixels}px");
    let indirect = settings["indirect_radius"].to_string();
    let discs = ["--radius", &radius, "--indirect-radius", &indirect];
    let by_hand = [&["--photons", "768", "--passes", "4", "-o", "hand.pfm"][..], &discs].concat();
    assert_eq!(of(&render(&by_hand), "calibration"), serde_json::Value::Null);
    assert!(
        fs::read(folder.join("draft.pfm")).unwrap() == fs::read(folder.join("hand.pfm")).unwrap()
    );
    // Options override the preset, which overrides the scene; the preset knows the size that
    // options set.
    let changed = render(&[
        "--quality",
        "preview",
        "--passes",
        "3",
        "--alpha",
        "0.5",
        "--radius",
        "2px",
        "--size",
        "16x10",
        "-o",
        "c.pfm",
    ]);
    let settings = &of(&changed, "start")["settings"];
    assert_eq!((&settings["passes"], &settings["photons"]), (&3.into(), &160.into()));
    assert_eq!((&settings["alpha"], &settings["radius"]["pixels"]), (&0.5.into(), &2.0.into()));
    assert_eq!(of(&changed, "start")["radius_why"], serde_json::Value::Null);
    assert_eq!(of(&changed, "calibration")["passes"], 3);
    // The same as text.
    let output =
        caustica(&folder, &["render", "ball.toml", "--device", "cpu", "--quality", "draft"]);
    let error = text(&output.stderr);
    for word in [
        "start radius",
        "px for diffusely scattered light (",
        "draft: 4 passes of 768 photons",
        "expected",
        "% (",
        "relMSE",
        "4/4 passes",
    ] {
        assert!(error.contains(word), "{word}: {error}");
    }
    let output = caustica(&folder, &["render", "ball.toml", "--quality", "finl"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("'final'"), "{}", text(&output.stderr));
}

/// An interrupt during the passes gives exit code 130 and an image of complete passes, fewer than
/// requested.
#[cfg(unix)]
#[test]
fn interrupts_save_the_picture() {
    use crate::support::{Running, interruptible, signal};
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    use std::time::Duration;

    let folder = folder("interrupt");
    let options = ["--device", "cpu", "--json", "--passes", "1000000", "-o", "a.exr"];
    let mut child = Running::start(
        interruptible(&folder, &[&["render", "ball.toml"][..], &options].concat())
            .stdout(Stdio::piped())
            .stderr(Stdio::null()),
    );
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    // After the first progress line the render is under way.
    let first_progress =
        lines.by_ref().map(Result::unwrap).find(|line| line.contains("\"progress\""));
    assert!(first_progress.is_some());
    std::thread::sleep(Duration::from_millis(100));
    signal(&child, "INT");
    let last = lines.map(Result::unwrap).last().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let done: serde_json::Value = serde_json::from_str(&last).unwrap();
    assert_eq!((&done["event"], &done["ended"]), (&"done".into(), &"interrupted".into()));
    let exr = file::read_exr(&folder.join("a.exr")).unwrap();
    assert_eq!(exr.attributes["caustica.passes_done"], done["passes"].to_string());
    assert!(done["passes"].as_u64().unwrap() < 1_000_000);
    assert_eq!(read(&folder.join("a.exr")).unwrap().not_finite(), 0);
}

/// Theory: a sound image rejects no samples, and --strict changes nothing. If a pixel is too bright
/// for f32, the image is written all the same, the cause is reported, and --strict gives exit code
/// 1.
#[test]
fn what_is_left_out_is_told() {
    let folder = folder("strict");
    let sound =
        caustica(&folder, &["render", "ball.toml", "--device", "cpu", "--json", "--strict"]);
    assert_eq!(sound.status.code(), Some(0), "{}", text(&sound.stderr));
    let causes = ["eye_path", "direct_light", "photons", "estimate", "too_bright"];
    let rejected = |output: &Output| {
        let done = json_lines(&output.stdout).pop().unwrap();
        causes.map(|cause| done["rejected"][cause].as_u64().unwrap())
    };
    assert_eq!(rejected(&sound), [0; 5]);

    // I / d^2 = 1e40 below the light
    let bright = SCENE.replace("center = [0.0, 3.0, 1.0]", "center = [0.0, 3.0, -9.0]")
        + "[[lights]]\ntype = \"point\"\nposition = [1.0, 1e-5, 1.0]\nintensity = 1e30\n";
    let bright = bright.replace(
        "position = [0.0, 1.0, 5.0]\ntarget = [0.0, 0.5, 0.0]\nfov = 40.0",
        "position = [1.2, 1.0, 1.0]\ntarget = [1.0, 0.0, 1.0]\nfov = 0.001",
    );
    fs::write(folder.join("bright.toml"), bright).unwrap();
    let reported = caustica(&folder, &["render", "bright.toml", "--device", "cpu", "-o", "a.exr"]);
    assert_eq!(reported.status.code(), Some(0), "{}", text(&reported.stderr));
    assert!(
        text(&reported.stderr).contains("pixels too bright for 32-bit floats"),
        "{}",
        text(&reported.stderr)
    );
    let strict = caustica(
        &folder,
        &["render", "bright.toml", "--device", "cpu", "-o", "b.exr", "--json", "--strict"],
    );
    assert_eq!(strict.status.code(), Some(1));
    assert!(text(&strict.stderr).contains("--strict"), "{}", text(&strict.stderr));
    assert!(rejected(&strict)[4] > 0);
    assert_eq!(read(&folder.join("b.exr")).unwrap().not_finite(), 0);
}

/// A missed target error is reported; where the target may be unreachable, the command requires a
/// limit.
#[test]
fn a_target_out_of_reach() {
    let folder = folder("target");
    let render = |options: &[&str]| {
        let output =
            caustica(&folder, &[&["render", "ball.toml", "--device", "cpu"][..], options].concat());
        (output.status.code(), error(&output))
    };
    let (code, error) = render(&["--target-error", "0.1%", "--passes", "5"]);
    assert!(
        code == Some(0) && error.contains("the target error of 0.10 % was not reached"),
        "{error}"
    );
    let (code, error) = render(&["--target-error", "100%", "--passes", "500"]);
    assert!(code == Some(0) && !error.contains("is not reached"), "{error}");
    for (option, value, instead) in
        [("--radius-rule", "fixed", "--radius-rule global"), ("--method", "ppm", "--method sppm")]
    {
        let (code, error) = render(&["--target-error", "1%", option, value]);
        assert!(code == Some(2) && error.contains("--passes or --time"), "{error}");
        assert!(error.contains(instead), "{error}");
        let (code, error) = render(&["--target-error", "1%", option, value, "--passes", "4"]);
        assert!(code == Some(0), "{error}");
    }
}
