//! TOML input: converts bytes to a tree with positions, or to findings. Every stage continues after
//! an error, so that one run shows all errors; only a file that is not TOML stops early.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::diagnostics::{Finding, Report, SceneErrors, SourceFile, nearest_file};
use super::encoding::unmarked;
use super::limits::Allowance;
use super::tree::Node;

/// Reads a file.
///
/// # Errors
/// A file that cannot be read; if it does not exist, the message suggests the nearest name.
pub(super) fn read(path: &Path, allowance: &Allowance) -> Result<Vec<u8>, SceneErrors> {
    allowance.read_scene(path).map_err(|error| {
        let mut report = Report::new(path, SourceFile::new(path, String::new()), allowance.errors);
        let near = || nearest_file(path).filter(|_| error.is_missing());
        let help = error.help().or_else(|| near().map(|near| format!("did you mean {near}?")));
        report.unreadable(format!("cannot read {}: {error}", path.display()), help);
        report.into_errors()
    })
}

/// Parses a file, and returns the result of `meaning` for its tree together with the warnings.
/// `path` names the file in messages.
///
/// # Errors
/// Bytes that are not TOML, an error that `meaning` reports, or no result from `meaning`.
pub(super) fn parse<T>(
    path: &Path,
    bytes: &[u8],
    allowance: &Allowance,
    meaning: impl FnOnce(Node, &mut Report) -> Option<T>,
) -> Result<(T, Vec<Finding>), SceneErrors> {
    let bytes = match unmarked(bytes) {
        Ok(bytes) => bytes,
        Err(foreign) => {
            let mut report = Report::new(path, SourceFile::new(path, String::new()), 1);
            report.unreadable(format!("{}: {foreign}", path.display()), Some(foreign.help()));
            return Err(report.into_errors());
        }
    };
    let text = String::from_utf8_lossy(bytes).into_owned();
    let source = SourceFile::new(path, text.clone());
    let mut report = Report::new(path, source, allowance.errors);
    if let Err(error) = std::str::from_utf8(bytes) {
        let at = error.valid_up_to();
        report.error(at..at + 1, "the file is not UTF-8", "expected UTF-8 text", None);
        return Err(report.into_errors());
    }
    if text.contains('\r') && !text.contains('\n') {
        let end = text.find('\r').unwrap_or(0);
        let help = Some("save it with Unix or Windows line endings".to_owned());
        report.error(
            end..end,
            "the lines end in carriage returns alone",
            "expected a line feed",
            help,
        );
        return Err(report.into_errors());
    }
    let (table, faults) = DeTable::parse_recoverable(&text);
    for fault in &faults {
        let span = fault.span().unwrap_or(0..0);
        let help = Some("the file is not TOML here; other checks run once it is".to_owned());
        report.error(span, fault.message(), "here", help);
    }
    if !report.errors.is_empty() {
        return Err(report.into_errors());
    }
    let span = table.span().start..table.span().start;
    let root = Spanned::new(span, DeValue::Table(table.into_inner()));
    let made = meaning(Node::new(&root), &mut report);
    report.conclude(made)
}
