//! Parses TOML into a tree with positions. Parsing continues after an error, so that one run shows
//! all of them, but only a file without such errors has a tree.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::scene::diagnostics::Report;

/// The root table of a file, whose text is `text`; `None` if it is not TOML, which is reported.
pub(super) fn parse<'t>(text: &'t str, report: &mut Report) -> Option<Spanned<DeValue<'t>>> {
    if text.contains('\r') && !text.contains('\n') {
        let end = text.find('\r').unwrap_or(0);
        let message = "the lines end in carriage returns alone";
        let help = Some("save it with Unix or Windows line endings".to_owned());
        report.error(end..end, message, "expected a line feed", help);
        return None;
    }
    let (table, faults) = DeTable::parse_recoverable(text);
    for fault in &faults {
        let span = fault.span().unwrap_or(0..0);
        let help = Some("the file is not TOML here; other checks run once it is".to_owned());
        report.error(span, fault.message(), "here", help);
    }
    if !report.errors.is_empty() {
        return None;
    }
    let span = table.span().start..table.span().start;
    Some(Spanned::new(span, DeValue::Table(table.into_inner())))
}
