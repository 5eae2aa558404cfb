//! Conventions of command-line programs: completions, manual pages, colours, logs, JSON events, and
//! independence of the source folder.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use crate::support::{PROGRAM, command, folder, json_lines, repository, shipped, software, text};
use serde_json::Value;

const COMMANDS: [&str; 12] = [
    "render",
    "merge",
    "compare",
    "diff",
    "study",
    "info",
    "bench",
    "check",
    "devices",
    "tessellate",
    "completions",
    "man",
];

/// Runs in `folder` with these environment variables and no others that affect colours.
fn with(folder: &Path, variables: &[(&str, &str)], arguments: &[&str]) -> Output {
    let mut command = command(folder, arguments);
    for name in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE", "FORCE_COLOR"] {
        command.env_remove(name);
    }
    command.envs(variables.iter().copied()).output().unwrap()
}

/// Runs a command that must succeed and returns its standard output.
fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = with(folder, &[], arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

/// Parses events; every line must be a JSON object with the name of an event.
fn events(stdout: &str) -> Vec<Value> {
    let events = json_lines(stdout.as_bytes());
    assert!(events.iter().all(|event| event["event"].is_string()), "{stdout}");
    events
}

fn names(events: &[Value]) -> Vec<&str> {
    events.iter().filter_map(|event| event["event"].as_str()).collect()
}

/// Theory: completion scripts are generated from the parser, so each contains every command and an
/// option of `render`. Where bash is installed it accepts its own script and rejects the same
/// script truncated inside a block.
#[test]
fn completions() {
    let folder = folder("completions");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = done(&folder, &["completions", shell]);
        for word in COMMANDS.iter().chain(&["target-error"]) {
            assert!(script.contains(word), "{shell} knows no {word}");
        }
    }
    let script = done(&folder, &["completions", "bash"]);
    let half = script.rfind("esac").unwrap();
    for (name, script, good) in [("whole", &script[..], true), ("half", &script[..half], false)] {
        fs::write(folder.join(name), script).unwrap();
        if let Ok(output) = Command::new("bash").arg("-n").arg(folder.join(name)).output() {
            assert_eq!(output.status.success(), good, "{name}: {}", text(&output.stderr));
        }
    }
    assert_eq!(with(&folder, &[], &["completions", "tcsh"]).status.code(), Some(2));
}

/// Theory: a manual page has a title, a name, a synopsis and options, and every command has one.
#[test]
fn manual_pages() {
    let folder = folder("man");
    let page = done(&folder, &["man"]);
    let listed = done(&folder, &["man", "."]);
    assert_eq!(
        listed.lines().count(),
        page.matches("(1)").count() + 1,
        "one for each that the program's own names"
    );
    assert_eq!(fs::read_to_string(folder.join("caustica.1")).unwrap(), page);
    for command in COMMANDS {
        assert!(page.contains(&format!("caustica\\-{command}(1)")), "{command}");
        let page = fs::read_to_string(folder.join(format!("caustica-{command}.1"))).unwrap();
        assert!(page.contains(&format!(".TH caustica-{command} 1")), "{command}");
        for section in ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS"] {
            assert!(page.contains(&format!(".SH {section}\n")), "{command}: {section}");
        }
    }
    let render = folder.join("caustica-render.1");
    if let Ok(output) = Command::new("groff").args(["-ww", "-man", "-Tascii"]).arg(&render).output()
    {
        assert_eq!((output.status.success(), text(&output.stderr)), (true, String::new()));
        assert!(text(&output.stdout).contains("Render a scene to images"));
    }
    let output = with(&folder, &[], &["man", "missing"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("missing"), "{}", text(&output.stderr));
}

/// Theory: standard error is not a terminal here, so output is coloured only if `CLICOLOR_FORCE` is
/// set. A non-empty `NO_COLOR` overrides it.
#[test]
fn colours() {
    let folder = folder("colours");
    let forced = ("CLICOLOR_FORCE", "1");
    for arguments in [&["check", "missing.toml"][..], &["rendr"]] {
        let coloured = |variables: &[(&str, &str)]| {
            let output = with(&folder, variables, arguments);
            assert!(!output.stderr.is_empty());
            output.stderr.contains(&0x1b)
        };
        assert!(!coloured(&[]), "{arguments:?}");
        assert!(coloured(&[forced]), "{arguments:?}");
        assert!(coloured(&[forced, ("NO_COLOR", "")]), "{arguments:?}");
        assert!(!coloured(&[forced, ("NO_COLOR", "1")]), "{arguments:?}");
        assert!(!coloured(&[forced, ("NO_COLOR", "0")]), "{arguments:?}");
    }
}

/// Theory: logs are off by default and go to standard error. Each level includes the one before,
/// and logging does not change the events on standard output.
#[test]
fn logs() {
    let folder = folder("logs");
    let file = shipped("cornell.toml");
    let run = |more: &[&str]| {
        let small =
            ["--size", "8x8", "--photons", "500", "--passes", "2", "--device", "cpu", "--json"];
        let output = with(&folder, &[], &[&["render", &file], &small[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        (text(&output.stdout), text(&output.stderr))
    };
    let (quiet, none) = run(&[]);
    assert_eq!(none, "");
    let (_, stages) = run(&["-v"]);
    for stage in ["parse", "pack", "kd-tree", "maps", "pilots", "probe", "passes"] {
        let line =
            stages.lines().find(|line| line.contains(&format!("caustica::stage: {stage}: ")));
        assert!(line.is_some_and(|line| line.ends_with(" s")), "{stage}: {stages}");
    }
    assert!(stages.contains("cpu [cpu]") && stages.contains("(asked for)"), "{stages}");
    assert!(!stages.contains("pass 2"), "{stages}");
    let (reported, all) = run(&["-vv"]);
    assert!(
        all.contains("pass 1: ") && all.contains("pass 2: ") && all.contains("kd-tree"),
        "{all}"
    );
    assert_eq!(names(&events(&reported)), names(&events(&quiet)));

    let output = with(&folder, &[], &["-v", "devices"]);
    assert_eq!(
        output.status.code(),
        Some(0),
        "-v may stand before the command: {}",
        text(&output.stderr)
    );
}

/// Theory: with `--json` standard output contains only events, the last of which is the result.
/// docs/command-line.md documents every event.
#[test]
fn every_long_command_has_events() {
    let folder = folder("events");
    let file = shipped("cornell.toml");
    let docs = fs::read_to_string(repository("docs/command-line.md")).unwrap();
    let ends = |arguments: &[&str], expected: &[&str]| {
        let events = events(&done(&folder, &[arguments, &["--json"]].concat()));
        let mut names = names(&events);
        assert!(names.iter().all(|name| docs.contains(&format!("| `{name}` |"))), "{names:?}");
        names.dedup();
        assert_eq!(names, expected, "{arguments:?}");
        events.last().unwrap().clone()
    };
    let small = ["--size", "8x8", "--photons", "500", "--passes", "2"];
    let part = |range: &str, checkpoint: &str| {
        let arguments =
            ["render", &file, "--passes", range, "--checkpoint", checkpoint, "-o", "part.pfm"];
        let done = ends(
            &[&arguments[..], &small[..4], &["--device", "cpu"]].concat(),
            &["start", "progress", "checkpoint", "done"],
        );
        assert_eq!(done["outputs"][0], "part.pfm");
    };
    part("0..2", "a.checkpoint");
    part("2..4", "b.checkpoint");
    let merged = ends(&["merge", "b.checkpoint", "a.checkpoint", "-o", "all.pfm"], &["merged"]);
    assert_eq!(
        (&merged["first_pass"], &merged["end"], &merged["passes"]),
        (&0.into(), &4.into(), &4.into())
    );
    assert!(merged["error"].as_f64().is_some_and(|error| error > 0.0), "{merged}");
    assert!(folder.join("all.pfm").exists());

    let two = ["--device", "cpu", "--device", "cpu"];
    ends(
        &[&["compare", &file], &small[..], &two].concat(),
        &["start", "progress", "start", "progress", "comparison"],
    );
    ends(&["diff", "all.pfm", "part.pfm"], &["difference"]);
    let bench = ["bench", &file, "--warm-up", "1", "--device", "cpu"];
    ends(&[&bench[..], &small].concat(), &["measuring", "bench"]);
    let last = ends(
        &[&["info", &file, "--measure", "--device", "cpu"], &small[..]].concat(),
        &["info", "measured"],
    );
    assert!(last["pass_seconds"].as_f64().is_some_and(|seconds| seconds > 0.0), "{last}");
    ends(&["check", &file], &["checked"]);
    assert_eq!(
        ends(&["devices"], &["devices"])["devices"].as_array().map(Vec::is_empty),
        Some(false)
    );
    let study = [
        "study",
        &file,
        "--budget",
        "2s",
        "--seeds",
        "2",
        "--vary",
        "photons=200,400",
        "--device",
        "cpu",
    ];
    let events = events(&done(&folder, &[&study[..], &["--size", "8x8", "--json"]].concat()));
    assert!(
        names(&events).iter().all(|name| docs.contains(&format!("| `{name}` |"))),
        "{:?}",
        names(&events)
    );
    assert_eq!((names(&events).first(), names(&events).last()), (Some(&"start"), Some(&"done")));
}

/// Theory: an error event contains the location that the text message shows.
#[test]
fn errors_as_events() {
    let folder = folder("errors");
    fs::write(
        folder.join("bad.toml"),
        "version = 1\n[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\nfov = 400\n",
    )
    .unwrap();
    let output = with(&folder, &[], &["check", "bad.toml", &shipped("cornell.toml"), "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let events = events(&text(&output.stdout));
    assert_eq!((&events[0]["good"], &events[1]["good"]), (&false.into(), &true.into()));
    let error = &events[0]["errors"][0];
    assert_eq!(
        (&error["file"], &error["line"], &error["column"]),
        (&"bad.toml".into(), &5.into(), &7.into())
    );
}

/// Theory: the program embeds its shaders. A copy of it renders the same image from an empty
/// folder.
#[test]
fn needs_no_folder() {
    software();
    let folder = folder("elsewhere");
    let program = folder.join(format!("copy{}", std::env::consts::EXE_SUFFIX));
    fs::copy(PROGRAM, &program).unwrap();
    let file = shipped("cornell.toml");
    let render = |program: &Path, device: &str, output: &str| {
        let arguments = [
            "render",
            &file,
            "--size",
            "16x16",
            "--photons",
            "1000",
            "--passes",
            "1",
            "--device",
            device,
        ];
        let run = Command::new(program)
            .args(arguments)
            .args(["-o", output])
            .current_dir(&folder)
            .output()
            .unwrap();
        assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
        fs::read(folder.join(output)).unwrap()
    };
    let copied = render(&program, "software", "a.pfm");
    assert_eq!(copied, render(Path::new(PROGRAM), "software", "b.pfm"));
    assert_eq!(copied, render(&program, "cpu", "c.pfm"));
}
