//! Output to standard output and standard error. A closed pipe, as in
//! `caustica info scene.toml | head`, is not a failure; other write errors of results are.
//!
//! Names and texts may come from untrusted files, so control characters are escaped for terminals.

use std::borrow::Cow;
use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, Write};

use miette::Diagnostic;

use super::Failure;
use super::shown::Shown;

/// Prints a line of results to standard output.
pub fn result(line: impl Display) -> Result<(), Failure> {
    let line = line.to_string();
    let out = io::stdout();
    // programs that read a pipe need unescaped names
    let shown = if out.is_terminal() { printable(&line) } else { Cow::Borrowed(line.as_str()) };
    written(writeln!(&out, "{shown}"))
}

/// Writes bytes to standard output.
pub fn bytes(text: &[u8]) -> Result<(), Failure> {
    let mut out = io::stdout();
    written(out.write_all(text).and_then(|()| out.flush()))
}

fn written(outcome: io::Result<()>) -> Result<(), Failure> {
    match outcome {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::failed(miette::miette!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a one-line message to standard error. Line feeds are escaped, since they come from names.
pub fn message(line: impl Display) {
    to_stderr(&one_line(&line.to_string()));
}

/// Prints a multi-line message to standard error.
pub fn paragraph(lines: impl Display) {
    to_stderr(&printable(&lines.to_string()));
}

/// Prints a diagnostic report to standard error, in color if enabled.
pub fn report(found: &dyn Diagnostic) {
    to_stderr(&Shown::of(found).report());
}

fn to_stderr(line: &str) {
    // a failure of standard error cannot be reported
    let _ = writeln!(io::stderr(), "{line}");
}

/// Returns true if a terminal only displays `c`. Control characters and those that change the text
/// direction do more.
fn is_plain(c: char) -> bool {
    let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    (!c.is_control() && !turns) || matches!(c, '\n' | '\t')
}

/// Escapes control characters in `text`, e.g. as `\\x1b`, except line feeds and tabs.
pub fn printable(text: &str) -> Cow<'_, str> {
    if text.chars().all(is_plain) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            c if is_plain(c) => out.push(c),
            c if (c as u32) < 256 => out.push_str(&format!("\\x{:02x}", c as u32)),
            c => out.push_str(&format!("\\u{{{:x}}}", c as u32)),
        }
    }
    Cow::Owned(out)
}

/// As [`printable`], and escapes line feeds as `\\n`.
pub fn one_line(text: &str) -> String {
    printable(text).replace('\n', "\\n")
}

/// Theory: a terminal interprets C0 and C1 control characters and sequences that begin with one;
/// even colors can hide text.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_become_text() {
        let cases = [
            ("plain, \ttabs\nand Zahlen für π", "plain, \ttabs\nand Zahlen für π"),
            ("\x1b]0;title\x07", "\\x1b]0;title\\x07"),
            ("\x1b[2J\x1b[8mhidden", "\\x1b[2J\\x1b[8mhidden"),
            ("\x1b[", "\\x1b["),
            ("over\rwritten\x08\x7f", "over\\x0dwritten\\x08\\x7f"),
            ("\u{9b}2J \u{202e}gpj", "\\x9b2J \\u{202e}gpj"),
        ];
        for (text, shown) in cases {
            assert_eq!(printable(text), shown);
        }
        assert_eq!(one_line("a\nerror: b\t\x07"), "a\\nerror: b\t\\x07");
    }
}
