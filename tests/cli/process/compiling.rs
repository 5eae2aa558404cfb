//! Progress while a driver compiles kernels, which takes lavapipe many seconds without its cache.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::folder;
use crate::support::{PROGRAM, command, ended, json_lines, software, spawn, text, words};

/// The program without Mesa's shader cache.
fn cold(folder: &Path, line: &str) -> Command {
    let mut command = command(folder, &words(line));
    command.env("MESA_SHADER_CACHE_DISABLE", "true");
    command
}

/// Arguments that render a scene with large kernels.
const RENDER: &str = concat!(
    "render ",
    env!("CARGO_MANIFEST_DIR"),
    "/scenes/caustics.toml --size 16x16 --photons 1000 --device software --passes 1 -o a.png"
);

/// Arguments that render a scene whose kernels compile in a few seconds.
const SMALL: &str = concat!(
    "render ",
    env!("CARGO_MANIFEST_DIR"),
    "/scenes/cornell.toml --size 16x16 --photons 1000 --device software --passes 1 -o a.png"
);

/// Theory: a user who waits longer than a second sees why. The log names the kernel that is
/// being compiled and how many are done, --quiet prints nothing, and --json prints events and
/// nothing on standard error.
#[test]
fn a_compilation_is_shown() {
    software();
    let folder = folder("shown");
    let begun = Instant::now();
    let mut child = spawn(cold(&folder, RENDER));
    let mut error = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    error.read_line(&mut line).unwrap();
    let first = begun.elapsed();
    let mut rest = String::new();
    error.read_to_string(&mut rest).unwrap();
    assert_eq!(ended(child).status.code(), Some(0), "{line}{rest}");
    let whole = begun.elapsed();
    assert!(
        whole > Duration::from_secs(2),
        "nothing is compiled, so this tests nothing: {whole:?}"
    );
    assert!(
        first < whole / 2 && first < Duration::from_secs(3),
        "after {first:?} of {whole:?}: {line}"
    );
    let shown = line.starts_with("compiling for ") && line.contains(" kernels done, ");
    assert!(shown && line.contains(": ") && !rest.contains("\r"), "{line}{rest}");

    let output = ended(spawn(cold(&folder, &format!("{SMALL} --quiet"))));
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));

    let output = ended(spawn(cold(&folder, &format!("{SMALL} --json"))));
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
    let events = json_lines(&output.stdout);
    let compiling: Vec<_> =
        events.iter().take_while(|event| event["event"] == "compiling").collect();
    assert!(!compiling.is_empty(), "{events:?}");
    assert!(events.iter().skip(compiling.len()).all(|event| event["event"] != "compiling"));
    for event in &compiling {
        assert!(
            event["done"].as_u64() < event["of"].as_u64() && event["elapsed"].as_f64() > Some(0.0)
        );
        assert!(event["kernel"].is_string() && event["device"].is_string(), "{event}");
    }
}

/// Theory: a terminal shows a live line, which is redrawn often and erased at the end.
#[test]
fn a_terminal_has_a_live_line() {
    software();
    let folder = folder("live");
    // util-linux's `script` runs the program on a terminal
    let line = format!("{} {SMALL}", PROGRAM);
    let mut command = Command::new("script");
    command.args(["--quiet", "--return", "--command", &line, "/dev/null"]).current_dir(&folder);
    command.env("MESA_SHADER_CACHE_DISABLE", "true").env("TERM", "xterm").stdin(Stdio::null());
    let output = ended(spawn(command));
    let shown = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{shown}");
    assert!(shown.matches("compiling for ").count() > 5, "{shown:?}");
    let after = shown.rsplit("compiling for ").next().unwrap();
    assert!(after.contains("\x1b[2K"), "the line stays: {after:?}");
}
