//! Environment variables that affect the choice of a device, and output of drivers on standard
//! error.

use std::fs;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::folder;
use crate::support::{
    command, ended, ends, error, json_lines, signal, software, spawn, text, until, words,
};

/// The program as it runs on a server: without a desktop and without the variable that silences
/// Mesa's device-select layer.
fn bare(folder: &Path, line: &str) -> Command {
    let mut command = command(folder, &words(line));
    for name in ["NODEVICE_SELECT", "XDG_RUNTIME_DIR", "WAYLAND_DISPLAY", "DISPLAY"] {
        command.env_remove(name);
    }
    command
}

/// Theory: only the program writes to standard error. Drivers and their layers print no complaint
/// about a machine without a desktop.
#[test]
fn drivers_are_quiet_without_a_desktop() {
    software();
    let folder = folder("quiet");
    let render = "render ball.toml --device software -o a.png";
    for line in
        ["devices", "devices --json", render, &format!("{render} --json"), &format!("{render} -v")]
    {
        for runtime in [None, Some(""), Some("relative")] {
            let mut command = bare(&folder, line);
            runtime.into_iter().for_each(|value| {
                command.env("XDG_RUNTIME_DIR", value);
            });
            let output = ended(spawn(command));
            let error = error(&output);
            assert_eq!(output.status.code(), Some(0), "{line}: {error}");
            assert!(!error.contains("XDG_RUNTIME_DIR"), "{line}: {error}");
            assert!(line.starts_with("render") || error.is_empty(), "{line}: {error}");
            assert!(!output.stdout.is_empty(), "{line}");
        }
    }
}

/// Theory: the program re-executes itself only to disable the layer. The process keeps its number,
/// name, arguments, working folder and ignored signals.
#[test]
fn the_process_stays_what_it_was() {
    software();
    let folder = folder("again");
    let line = "render ball.toml --device software --quiet --passes 1000000 --time 60s -o a.png";
    let mut command = bare(&folder, line);
    command.arg0("./my-caustica");
    let mut child = spawn(command);
    let process = PathBuf::from(format!("/proc/{}", child.id()));
    let variables = || fs::read(process.join("environ")).unwrap_or_default();
    until("quiet", || String::from_utf8_lossy(&variables()).contains("NODEVICE_SELECT=1"));
    let arguments = fs::read_to_string(process.join("cmdline")).unwrap();
    let expected: Vec<_> = ["./my-caustica"].into_iter().chain(words(line)).collect();
    assert_eq!(arguments.split_terminator('\0').collect::<Vec<_>>(), expected);
    assert_eq!(fs::read_link(process.join("cwd")).unwrap(), folder.canonicalize().unwrap());
    assert_eq!(fs::read_to_string(process.join("comm")).unwrap().trim(), "caustica");
    // TERM: the test suite may have been started with INT or HUP ignored
    until("ready", || super::signals::catches_signal(&child, 15));
    assert!(child.try_wait().unwrap().is_none());
    signal(&child, "TERM");
    assert_eq!(ended(child).status.code(), Some(130));
    // a CPU render needs no driver, and with a desktop the layer stays enabled
    for (line, runtime) in
        [(line.replace("software", "cpu"), None), (line.to_owned(), Some("/run"))]
    {
        let mut command = bare(&folder, &line);
        runtime.into_iter().for_each(|value| {
            command.env("XDG_RUNTIME_DIR", value);
        });
        let child = spawn(command);
        until("ready", || super::signals::catches_signal(&child, 15));
        let variables = fs::read(format!("/proc/{}/environ", child.id())).unwrap();
        signal(&child, "TERM");
        assert!(!String::from_utf8_lossy(&variables).contains("NODEVICE_SELECT"), "{line}");
        assert_eq!(ended(child).status.code(), Some(130), "{line}");
    }
}

/// Output and error of the program with an environment variable set.
fn output_of(
    folder: &Path,
    line: &str,
    (variable, value): (&str, &str),
    code: i32,
) -> (String, String) {
    let mut command = command(folder, &words(line));
    let output = ended(spawn({
        command.env(variable, value);
        command
    }));
    assert_eq!(output.status.code(), Some(code), "{variable}={value} {line}: {}", error(&output));
    (text(&output.stdout), error(&output))
}

/// Theory: if a variable hides an adapter or has a meaningless value, every command that selects a
/// device names it with its value, the hidden adapters and the remedy. A variable that hides
/// nothing is not mentioned.
#[test]
fn variables_that_hide_devices_are_named() {
    software();
    let folder = folder("hidden");
    let all = json_lines(ends(&folder, &["devices", "--json"], 0, &[]).stdout.as_slice()).remove(0);
    let named = |device: &serde_json::Value| device["kind"] == "software";
    let device = all["devices"].as_array().unwrap().iter().find(|device| named(device)).unwrap();
    let device = device["name"].as_str().unwrap().to_owned();
    let render = "render ball.toml --passes 1 --quiet -o a.png";
    let hiding =
        [("WGPU_BACKEND", "dx12"), ("WGPU_BACKEND", "vulcan"), ("WGPU_ADAPTER_NAME", "nonesuch")];
    for (variable, value) in hiding {
        let set = (variable, value);
        let remedy = format!("unset {variable}");
        let expected = [&format!("{variable}={value}"), &device, &remedy];
        let named = |error: &str| expected.iter().all(|word| error.contains(word.as_str()));
        for line in ["devices", &format!("{render} --device auto"), &format!("{render} --json")] {
            let (_, error) = output_of(&folder, line, set, 0);
            assert!(named(&error) && error.matches("warning").count() == 1, "{line}: {error}");
            assert_eq!(
                error.contains("no graphics interface by `vulcan`"),
                value == "vulcan",
                "{error}"
            );
        }
        let (stdout, _) = output_of(&folder, "devices --json", set, 0);
        let hidden = &json_lines(stdout.as_bytes())[0]["hidden"][0];
        assert_eq!((&hidden["variable"], &hidden["value"]), (&variable.into(), &value.into()));
        assert_eq!(hidden["devices"][0], device.as_str());
        for wanted in ["software", "llvmpipe", "gpu"] {
            let (_, error) = output_of(&folder, &format!("{render} --device {wanted}"), set, 4);
            assert!(named(&error), "{wanted}: {error}");
        }
        // the CPU is available whatever is hidden
        assert_eq!(output_of(&folder, &format!("{render} --device cpu"), set, 0).1, "");
    }
    for set in [("WGPU_BACKEND", "vulkan"), ("WGPU_BACKEND", ""), ("WGPU_ADAPTER_NAME", "LLVMpipe")]
    {
        for line in ["devices", &format!("{render} --device software")] {
            assert_eq!(output_of(&folder, line, set, 0).1, "", "{set:?}");
        }
    }
    let (_, error) = output_of(&folder, "devices", ("WGPU_BACKEND", "vulkan,vulcan"), 0);
    assert!(
        error.contains("`vulcan`")
            && error.contains("correct or unset")
            && !error.contains("hides")
    );
}
