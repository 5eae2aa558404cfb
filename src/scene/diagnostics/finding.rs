//! A single error or warning, and all errors of a load.

use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

use miette::{Diagnostic, LabeledSpan, SourceCode};

use super::source::SourceFile;

/// An error or a warning about a scene, with its position. [`miette`] prints it with the offending
/// line and a caret.
#[derive(Clone, Debug)]
pub struct Finding {
    pub(super) message: String,
    pub(super) help: Option<String>,
    pub(super) severity: miette::Severity,
    pub(super) file: String,
    pub(super) place: Option<Span>,
    /// True if this is an error in a value of the scene file, not a missing key or an error in
    /// another file.
    pub(super) about_value: bool,
}

/// A marked part of a source text.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub(super) source: SourceFile,
    pub(super) span: Range<usize>,
    pub(super) label: String,
}

impl Finding {
    /// The problem, in one line.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The expected content, printed at the caret.
    pub fn label(&self) -> &str {
        self.place.as_ref().map_or("", |place| &place.label)
    }

    /// Remedy, if there is one.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Path of the file that contains the problem.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Key for removing duplicates. Two errors in one value have the same key: they state the same
    /// problem, or the later one follows from the earlier.
    pub(super) fn subject(&self) -> (String, Option<Range<usize>>, Option<String>) {
        let span = self.place.as_ref().map(|place| place.span.clone());
        (self.file.clone(), span, (!self.about_value).then(|| self.message.clone()))
    }

    /// A warning that states the number of unlisted warnings.
    pub(super) fn unlisted(count: usize) -> Finding {
        Finding {
            message: format!("{count} more warnings are not shown"),
            help: None,
            severity: miette::Severity::Warning,
            file: String::new(),
            place: None,
            about_value: false,
        }
    }

    /// Line and column, from 1, the column in characters; `None` if the file itself cannot be read.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        let place = self.place.as_ref()?;
        let before = place.source.text().get(..place.span.start)?;
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.matches('\n').count() + 1;
        Some((line, before[line_start..].chars().count() + 1))
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Finding {}

impl Diagnostic for Finding {
    fn severity(&self) -> Option<miette::Severity> {
        Some(self.severity)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_ref().map(|place| &place.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref()?;
        let label =
            LabeledSpan::new_primary_with_span(Some(place.label.clone()), place.span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}

/// All errors in a scene file and the files that it names.
#[derive(Debug, thiserror::Error)]
#[error("{file}: {}", self.count())]
pub struct SceneErrors {
    /// Path of the scene file.
    pub file: String,
    /// At least one error, in file order; the first ones that were found.
    pub errors: Vec<Finding>,
    /// Number of further errors.
    pub more: usize,
    /// Warnings about the scene.
    pub warnings: Vec<Finding>,
    /// Files that were requested before the failure, whether or not they exist, without the scene
    /// file.
    pub files: Vec<PathBuf>,
}

impl SceneErrors {
    fn count(&self) -> String {
        match (self.errors.len(), self.more) {
            (1, 0) => "1 error".to_owned(),
            (listed, 0) => format!("{listed} errors"),
            (listed, more) => format!("{} errors, of which {listed} are listed", listed + more),
        }
    }
}

impl Diagnostic for SceneErrors {
    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        let errors = self.errors.iter().map(|error| error as &dyn Diagnostic);
        let warnings = self.warnings.iter().map(|warning| warning as &dyn Diagnostic);
        Some(Box::new(errors.chain(warnings)))
    }
}
