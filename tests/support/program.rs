//! The program, as a user or a script calls it.

use std::path::Path;
use std::process::{Command, Output};

/// The path of the program under test.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_caustica");

/// The program with these arguments, in `folder`, without colours.
pub fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(arguments).current_dir(folder).env("NO_COLOR", "1");
    command
}

/// Runs the program with these arguments.
pub fn caustica(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// Output as text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Standard error as one line, with line breaks and their decoration removed.
pub fn error(output: &Output) -> String {
    text(&output.stderr)
        .split_whitespace()
        .filter(|word| *word != "│")
        .collect::<Vec<_>>()
        .join(" ")
}

/// Runs a command that must end with this exit code and with these words on standard error.
#[track_caller]
pub fn ends(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) -> Output {
    let output = caustica(folder, arguments);
    let error = error(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
    for word in words {
        assert!(error.contains(word), "{arguments:?} should say `{word}`: {error}");
    }
    output
}

/// Runs a command that must succeed and returns its standard output.
#[track_caller]
pub fn good(folder: &Path, arguments: &[&str]) -> String {
    text(&ends(folder, arguments, 0, &[]).stdout)
}

/// Runs a command that must fail with this exit code and these words, and with an empty standard
/// output.
#[track_caller]
pub fn fails(folder: &Path, arguments: &[&str], code: i32, words: &[&str]) {
    let output = ends(folder, arguments, code, words);
    assert_eq!(text(&output.stdout), "", "{arguments:?}");
}

/// The objects on the lines of `--json`.
pub fn json_lines(stdout: &[u8]) -> Vec<serde_json::Value> {
    let read =
        |line: &str| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
    text(stdout).lines().map(read).collect()
}

/// The words of a line.
pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}
