//! TOML input: converts bytes to a tree with positions, or to findings. Every stage continues after
//! an error, so that one run shows all errors; only a file that is not TOML stops early.

use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::encoding::unmarked;
use super::limits::Allowance;
use super::report::{Finding, Report, SceneErrors, SourceFile, nearest};
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
        errors(path, report)
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
            return Err(errors(path, report));
        }
    };
    let text = String::from_utf8_lossy(bytes).into_owned();
    let source = SourceFile::new(path, text.clone());
    let mut report = Report::new(path, source, allowance.errors);
    if let Err(error) = std::str::from_utf8(bytes) {
        let at = error.valid_up_to();
        report.error(at..at + 1, "the file is not UTF-8", "expected UTF-8 text", None);
        return Err(errors(path, report));
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
        return Err(errors(path, report));
    }
    let (table, faults) = DeTable::parse_recoverable(&text);
    for fault in &faults {
        let span = fault.span().unwrap_or(0..0);
        let help = Some("the file is not TOML here; other checks run once it is".to_owned());
        report.error(span, fault.message(), "here", help);
    }
    if !report.errors.is_empty() {
        return Err(errors(path, report));
    }
    let span = table.span().start..table.span().start;
    let root = Spanned::new(span, DeValue::Table(table.into_inner()));
    match meaning(Node::new(&root), &mut report) {
        Some(made) if report.errors.is_empty() => Ok((made, report.warnings.told())),
        _ => Err(errors(path, report)),
    }
}

fn errors(path: &Path, report: Report) -> SceneErrors {
    let file = path.display().to_string();
    let (more, mut errors) = (report.errors.more(), report.errors.listed());
    errors.sort_by_cached_key(|error| (error.file() != file, error.line_column()));
    SceneErrors { file, errors, more, warnings: report.warnings.told(), files: report.files }
}

/// The file in the same folder with the nearest name, if any is close.
pub(super) fn nearest_file(path: &Path) -> Option<String> {
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let folder =
        path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut names: Vec<_> = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
        .collect();
    names.sort();
    nearest(&wanted, names.iter().map(String::as_str)).map(str::to_owned)
}
