//! Colors of reports on standard error. clap applies the same rules to usage and help.

use std::ffi::OsString;
use std::io::IsTerminal;

use miette::{MietteHandlerOpts, ReportHandler};

/// Formatter for reports of errors and warnings.
pub fn handler() -> impl ReportHandler {
    let colored = on_errors();
    MietteHandlerOpts::new().color(colored).terminal_links(false).build()
}

/// Returns true if output on standard error is colored.
pub fn on_errors() -> bool {
    colored(|name| std::env::var_os(name), std::io::stderr().is_terminal())
}

/// A nonempty `NO_COLOR` disables colors (<https://no-color.org>). `CLICOLOR_FORCE` enables them
/// even without a terminal (<https://bixense.com/clicolors>). Otherwise a terminal gets colors
/// unless `TERM` is `dumb` or `CLICOLOR` is `0`.
fn colored(variable: impl Fn(&str) -> Option<OsString>, terminal: bool) -> bool {
    let set = |name| variable(name).is_some_and(|value| !value.is_empty());
    let is = |name, word: &str| variable(name).is_some_and(|value| value == word);
    if set("NO_COLOR") {
        false
    } else if set("CLICOLOR_FORCE") && !is("CLICOLOR_FORCE", "0") {
        true
    } else {
        terminal && !is("TERM", "dumb") && !is("CLICOLOR", "0")
    }
}

/// Theory: the specifications of the variables.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_decides() {
        let with = |set: &[(&str, &str)], terminal| {
            let find = |name: &str| {
                set.iter().find(|(key, _)| *key == name).map(|(_, v)| OsString::from(v))
            };
            colored(find, terminal)
        };
        assert!(with(&[], true) && !with(&[], false));
        for value in ["1", "0", "no", " "] {
            assert!(!with(&[("NO_COLOR", value)], true), "{value}");
            assert!(!with(&[("NO_COLOR", value), ("CLICOLOR_FORCE", "1")], true), "{value}");
        }
        assert!(with(&[("NO_COLOR", "")], true), "empty counts as unset");
        assert!(with(&[("CLICOLOR_FORCE", "1")], false));
        assert!(
            !with(&[("CLICOLOR_FORCE", "0")], false) && !with(&[("CLICOLOR_FORCE", "")], false)
        );
        assert!(!with(&[("TERM", "dumb")], true) && with(&[("TERM", "xterm")], true));
        assert!(!with(&[("CLICOLOR", "0")], true));
    }
}
