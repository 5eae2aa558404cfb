//! Control characters in messages on a terminal.

use std::fs;
use std::path::Path;

use super::{SCENE, folder};
use crate::support::{command, text};

/// Sets the title, clears the screen, hides text, rings the bell, returns, starts a C1 sequence,
/// and reverses text.
const HARM: [&str; 7] =
    ["\x1b]0;PWNED\x07", "\x1b[2J", "\x1b[8m", "\x07", "a\rb", "\u{9b}2J", "\u{202e}txt"];

/// Whether a report may use this code: a colour, bold, faint, italic or underlined text, or a
/// reset.
fn is_color(code: &str) -> bool {
    code.parse::<u32>().is_ok_and(|code| !(5..=8).contains(&code))
}

/// The control and direction characters of an output, except for the colours of reports.
fn acts(output: &str) -> Vec<char> {
    let mut rest = String::new();
    let mut parts = output.split("\x1b[");
    rest.extend(parts.next());
    for part in parts {
        match part.split_once('m') {
            Some((codes, after)) if codes.split(';').all(is_color) => rest.push_str(after),
            _ => rest.extend(["\x1b[", part]),
        }
    }
    let turns =
        |c: &char| ('\u{202a}'..='\u{202e}').contains(c) || ('\u{2066}'..='\u{2069}').contains(c);
    rest.chars().filter(|c| (c.is_control() && *c != '\n') || turns(c)).collect()
}

/// Runs with and without colours. Standard error must contain `reported` and no character that a
/// terminal would act on.
#[track_caller]
fn harmless(folder: &Path, arguments: &[&str], reported: &str) {
    for colors in [false, true] {
        let mut command = command(folder, arguments);
        if colors {
            command.env_remove("NO_COLOR").env("CLICOLOR_FORCE", "1");
        }
        let output = command.output().unwrap();
        let error = text(&output.stderr);
        assert!(error.contains(reported), "{arguments:?} should say {reported:?}: {error:?}");
        assert_eq!(acts(&error), Vec::<char>::new(), "{arguments:?}: {error:?}");
        assert!(colors || !error.contains('\x1b'), "{arguments:?}: {error:?}");
    }
}

/// Theory: a terminal acts on control characters, so the program escapes them in everything that it
/// quotes: lines of files, file names, names in files and arguments, with colours and without.
#[test]
fn control_characters_are_shown() {
    let folder = folder("control");
    let mesh = "[[shapes]]\ntype = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"white\"\n";
    fs::write(folder.join("mesh.toml"), format!("{}\n{mesh}", *SCENE)).unwrap();
    for (number, harm) in HARM.iter().enumerate() {
        fs::write(
            folder.join("m.obj"),
            format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n{harm} 1 2\n"),
        )
        .unwrap();
        harmless(&folder, &["check", "mesh.toml"], "m.obj");
        // a comment next to an error, an unknown name, a long name
        let neighbor =
            format!("{}\nshape = 3 # {harm}\n", SCENE.replace("[film]", "[film]\nwidht = 3"));
        fs::write(folder.join("neighbor.toml"), neighbor).unwrap();
        harmless(&folder, &["check", "neighbor.toml"], "neighbor.toml");
        let escaped: String = harm.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect();
        let unknown = SCENE.replace("material = \"", &format!("material = \"{escaped}"));
        fs::write(folder.join("unknown.toml"), unknown).unwrap();
        harmless(&folder, &["check", "unknown.toml"], "material");
        // file names, in messages and above a quoted line
        let named = format!("{harm}{number}.toml");
        harmless(&folder, &["check", &named], "cannot");
        fs::write(folder.join(&named), "version = 1\nfild = 3\n").unwrap();
        harmless(&folder, &["check", &named], "fild");
        fs::write(folder.join(&named), SCENE.as_str()).unwrap();
        let line = ["render", &named, "--device", "cpu", "-o", "a.png", "-v"];
        harmless(&folder, &line, "start radius");
        harmless(&folder, &["diff", &format!("{harm}.exr"), "b.exr"], ".exr");
        // arguments
        harmless(&folder, &["render", "ball.toml", &format!("--{harm}")], "unexpected argument");
        harmless(&folder, &["render", "ball.toml", "--device", harm], "device");
        harmless(&folder, &["render", "ball.toml", "--size", harm], "--size");
    }
}

/// Theory: a line feed in a name is shown as an escape, so no name can look like a separate
/// message.
#[test]
fn line_feeds_in_names_are_shown() {
    let folder = folder("feeds");
    let harm = "a\nwarning: b";
    let shown = "a\\nwarning: b";
    let says = |arguments: &[&str]| {
        let output = command(&folder, arguments).output().unwrap();
        let error = text(&output.stderr);
        let lines =
            error.lines().map(|line| line.trim_start_matches([' ', '│', '×', '⚠', '╭', '─', '[']));
        let forged: Vec<_> = lines.filter(|line| line.starts_with("warning: b")).collect();
        assert!(forged.is_empty(), "{arguments:?}: {error}");
        error.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let unknown = SCENE.replace("material = \"white\"", "material = \"a\\nwarning: b\"");
    assert_ne!(unknown, *SCENE);
    fs::write(folder.join("unknown.toml"), unknown).unwrap();
    assert!(says(&["check", "unknown.toml"]).contains(shown));
    let named = format!("{harm}.toml");
    assert!(says(&["check", &named]).contains(shown));
    fs::write(folder.join(&named), SCENE.as_str()).unwrap();
    let line = ["render", &named, "--device", "cpu", "-o", "a.png"];
    assert!(says(&line).contains(shown));
    let picture = format!("{harm}.png");
    assert!(
        says(&["render", "ball.toml", "--device", "cpu", "-o", &format!("no/{picture}")])
            .contains(shown)
    );
    assert!(says(&["diff", &format!("{harm}.exr"), "b.exr"]).contains(shown));
}

/// Theory: the caret points at the right column after a replaced character, which has the same
/// width.
#[test]
fn carets_stand_where_they_did() {
    let folder = folder("carets");
    let line = |start: &str| {
        let scene = SCENE
            .replace("[film]", &format!("[film]\naov = [\"depth\", \"{start}\", \"nothing\"]"));
        fs::write(folder.join("s.toml"), scene).unwrap();
        let output = command(&folder, &["info", "s.toml"]).output().unwrap();
        let error = text(&output.stderr);
        // the line and the carets under `nothing`
        let lines: Vec<_> = error.lines().collect();
        let at = lines.iter().rposition(|line| line.contains("\"nothing\"")).unwrap();
        (lines[at].to_owned(), lines[at + 1].to_owned())
    };
    let (shown, carets) = line("\u{9b}x");
    assert!(shown.contains("\"\u{bf}x\"") && carets.contains('┬'), "{shown}\n{carets}");
    assert_eq!((shown, carets), line("\u{bf}x"));
}
