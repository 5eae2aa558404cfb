//! An MTL file: where each of its materials stands, and the findings in it.

use std::ops::Range;
use std::path::PathBuf;

use super::lines::{Text, statements};
use crate::scene::diagnostics::Faults;
use crate::scene::numbers::Rounded;

/// An MTL file.
#[derive(Debug)]
pub(super) struct Library {
    pub path: PathBuf,
    pub text: Text,
    pub entries: Vec<Entry>,
    pub faults: Faults,
    pub warnings: Faults,
    pub rounded: Rounded,
}

/// Byte ranges of a material in its file.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub name: Range<usize>,
    pub body: Range<usize>,
}

impl Library {
    /// Finds the materials of a file.
    pub fn new(path: PathBuf, text: Text) -> Self {
        let (mut entries, mut warnings) = (Vec::<Entry>::new(), Faults::warnings());
        let lines = text.lines();
        let mut stray = None;
        for statement in statements(lines, 0..lines.len()) {
            let (name, span) = statement.name();
            let begin = statement.at.start;
            if statement.keyword != "newmtl" {
                if entries.is_empty() {
                    stray = stray.or(Some(statement.at));
                }
                continue;
            }
            if let Some(last) = entries.last_mut() {
                last.body.end = lines[..begin].rfind('\n').map_or(0, |end| end + 1);
            }
            if name.is_empty() {
                warnings.push(statement.at, "`newmtl` has no name", "expected a name");
            }
            entries.push(Entry { name: span, body: line_end(lines, begin)..lines.len() });
        }
        if let Some(at) = stray {
            warnings.push(
                at,
                "a statement before any `newmtl` is not used",
                "expected `newmtl` above",
            );
        }
        Self {
            path,
            text,
            entries,
            faults: Faults::default(),
            warnings,
            rounded: Rounded::default(),
        }
    }

    /// Name of a material.
    pub fn name(&self, entry: usize) -> &str {
        &self.text.lines()[self.entries[entry].name.clone()]
    }

    /// Takes the errors and warnings, and leaves none.
    pub fn take_findings(&mut self) -> (Faults, Faults) {
        if let Some((at, message)) = std::mem::take(&mut self.rounded).take() {
            self.warnings.push(at, message, "read as the limit");
        }
        (
            std::mem::take(&mut self.faults),
            std::mem::replace(&mut self.warnings, Faults::warnings()),
        )
    }
}

fn line_end(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |length| at + length + 1)
}
