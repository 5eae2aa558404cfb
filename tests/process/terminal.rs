//! What reaches a terminal.

use std::fs;
use std::path::Path;

use super::support::{command, text};
use super::{SCENE, folder};

/// A title, a cleared screen, hidden text, a bell, a return, a C1 sequence, and text from right to left.
const HARM: [&str; 7] = ["\x1b]0;PWNED\x07", "\x1b[2J", "\x1b[8m", "\x07", "a\rb", "\u{9b}2J", "\u{202e}txt"];

/// What a terminal would act on in what a command says, but for the colours of reports.
fn acts(output: &str) -> Vec<char> {
    let mut rest = output.to_owned();
    for color in ["0", "1", "2", "4", "31", "32", "33", "34", "35", "36", "37"] {
        rest = rest.replace(&format!("\x1b[{color}m"), "");
    }
    while let Some(at) = rest.find("\x1b[38;") {
        let end = rest[at..].find('m').unwrap();
        rest.replace_range(at..=at + end, "");
    }
    let turns = |c: &char| ('\u{202a}'..='\u{202e}').contains(c) || ('\u{2066}'..='\u{2069}').contains(c);
    rest.chars().filter(|c| (c.is_control() && *c != '\n') || turns(c)).collect()
}

/// Runs with and without colours; standard error must name the trouble and do nothing to the terminal.
#[track_caller]
fn harmless(folder: &Path, arguments: &[&str], told: &str) {
    for colors in [false, true] {
        let mut command = command(folder, arguments);
        if colors {
            command.env_remove("NO_COLOR").env("CLICOLOR_FORCE", "1");
        }
        let output = command.output().unwrap();
        let error = text(&output.stderr);
        assert!(error.contains(told), "{arguments:?} should say {told:?}: {error:?}");
        assert_eq!(acts(&error), Vec::<char>::new(), "{arguments:?}: {error:?}");
        assert!(colors || !error.contains('\x1b'), "{arguments:?}: {error:?}");
        // hidden text is a colour to a terminal, and comes from no report
        assert!(!error.contains("\x1b[8m"), "{arguments:?}: {error:?}");
    }
}

/// Theory: a terminal acts on control characters. None comes from what the program quotes: lines of files,
/// their names, names in them, arguments; with colours and without.
#[test]
fn control_characters_are_shown() {
    let folder = folder("control");
    let mesh = "[[shapes]]\ntype = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"white\"\n";
    fs::write(folder.join("mesh.toml"), format!("{}\n{mesh}", *SCENE)).unwrap();
    for (number, harm) in HARM.iter().enumerate() {
        let shown = harm.trim_start_matches(|c: char| !c.is_ascii_alphanumeric() && c != '[' && c != ']');
        fs::write(folder.join("m.obj"), format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n{harm} 1 2\n")).unwrap();
        harmless(&folder, &["check", "mesh.toml"], "m.obj");
        // a comment of a scene beside an error, a name that is not known, one that is long
        let beside = format!("{}\nshape = 3 # {harm}\n", SCENE.replace("[film]", "[film]\nwidht = 3"));
        fs::write(folder.join("beside.toml"), beside).unwrap();
        harmless(&folder, &["check", "beside.toml"], "widht");
        let escaped: String = harm.chars().map(|c| format!("\\u{:04x}", u32::from(c))).collect();
        let unknown = SCENE.replace("material = \"", &format!("material = \"{escaped}"));
        fs::write(folder.join("unknown.toml"), unknown).unwrap();
        harmless(&folder, &["check", "unknown.toml"], "material");
        // names of files, in messages and at the head of a quoted line
        let named = format!("{harm}{number}.toml");
        harmless(&folder, &["check", &named], "cannot");
        fs::write(folder.join(&named), "version = 1\nfild = 3\n").unwrap();
        harmless(&folder, &["check", &named], "fild");
        fs::write(folder.join(&named), SCENE.as_str()).unwrap();
        let line = ["render", &named, "--device", "cpu", "-o", "a.png", "-v"];
        harmless(&folder, &line, if shown.is_empty() { ":" } else { shown });
        harmless(&folder, &["diff", &format!("{harm}.exr"), "b.exr"], ".exr");
        // arguments
        harmless(&folder, &["render", "ball.toml", &format!("--{harm}")], "unexpected argument");
        harmless(&folder, &["render", "ball.toml", "--device", harm], "device");
        harmless(&folder, &["render", "ball.toml", "--size", harm], "--size");
    }
}

/// Theory: the caret stands under what it means, also after a character that is replaced, which is as long.
#[test]
fn carets_stand_where_they_did() {
    let folder = folder("carets");
    let line = |start: &str| {
        let scene = SCENE.replace("[film]", &format!("[film]\nwidht = {{ a = \"{start}\", b = 1 }}"));
        fs::write(folder.join("s.toml"), scene).unwrap();
        let output = command(&folder, &["info", "s.toml"]).output().unwrap();
        text(&output.stderr)
    };
    assert_eq!(line("\u{7f}x"), line("?x"));
}
