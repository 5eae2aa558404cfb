//! Collects the findings of one load.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::faults::Faults;
use super::finding::{Finding, SceneErrors, Span};
use super::findings::Findings;
use super::similar::did_you_mean;
use super::source::SourceFile;

/// Collects the findings of one load.
#[derive(Debug)]
pub(crate) struct Report {
    /// The scene file.
    pub source: SourceFile,
    path: String,
    pub errors: Findings,
    pub warnings: Findings,
    /// Files that the scene file names, and files that those name.
    pub files: Vec<PathBuf>,
}

impl Report {
    /// An empty report that lists at most `most` errors and `most` warnings.
    pub fn new(path: &Path, source: SourceFile, most: u64) -> Self {
        let [errors, warnings] = [Findings::new(most), Findings::new(most)];
        Self { source, path: path.display().to_string(), errors, warnings, files: Vec::new() }
    }

    /// Adds an error in the scene file; `label` states the expected content, `help` the remedy.
    pub fn error(
        &mut self,
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
        help: Option<String>,
    ) {
        let mut finding =
            self.finding(miette::Severity::Error, span, message.into(), label.into(), help);
        finding.about_value = true;
        self.errors.push(finding);
    }

    /// Adds an error about a key that a table of the scene file lacks; a table may lack several.
    pub fn missing(
        &mut self,
        span: Range<usize>,
        message: String,
        label: String,
        help: Option<String>,
    ) {
        let finding = self.finding(miette::Severity::Error, span, message, label, help);
        self.errors.push(finding);
    }

    /// Creates a warning about the scene file without adding it.
    pub fn warning(&self, span: Range<usize>, message: String, label: String) -> Finding {
        self.finding(miette::Severity::Warning, span, message, label, None)
    }

    /// Adds a warning about the scene file.
    pub fn warn(
        &mut self,
        span: Range<usize>,
        message: impl Into<String>,
        label: impl Into<String>,
    ) {
        let finding = self.warning(span, message.into(), label.into());
        self.warnings.push(finding);
    }

    /// Adds an error about a scene file that cannot be read at all.
    pub fn unreadable(&mut self, message: String, help: Option<String>) {
        self.errors.push(Finding {
            message,
            help,
            severity: miette::Severity::Error,
            file: self.path.clone(),
            place: None,
            about_value: false,
        });
    }

    /// Adds errors in a file that the scene file names at `named_at`.
    pub fn asset_errors(&mut self, named_at: Range<usize>, source: &SourceFile, faults: Faults) {
        for error in self.asset_findings(miette::Severity::Error, named_at, source, faults) {
            self.errors.push(error);
        }
    }

    /// Adds warnings about a file that the scene file names at `named_at`.
    pub fn asset_warnings(&mut self, named_at: Range<usize>, source: &SourceFile, faults: Faults) {
        for warning in self.asset_findings(miette::Severity::Warning, named_at, source, faults) {
            self.warnings.push(warning);
        }
    }

    fn asset_findings(
        &self,
        severity: miette::Severity,
        named_at: Range<usize>,
        source: &SourceFile,
        faults: Faults,
    ) -> Vec<Finding> {
        let what = if severity == miette::Severity::Error { "errors" } else { "warnings" };
        let (line, _) = self.line_column(named_at);
        let file = source.name().to_owned();
        let last = faults.listed.len().saturating_sub(1);
        let findings = faults.listed.into_iter().enumerate().map(|(index, fault)| {
            let help = match faults.more {
                more @ 1.. if index == last => {
                    format!("{more} more {what} in {file} are not shown")
                }
                _ => format!("{file} is named in {} at line {line}", self.path),
            };
            Finding {
                message: fault.message,
                help: Some(help),
                severity,
                file: file.clone(),
                place: Some(Span {
                    source: source.clone(),
                    span: fault.span,
                    label: fault.expected,
                }),
                about_value: false,
            }
        });
        findings.collect()
    }

    /// Ends a load: what was made with the warnings, or all errors in file order if there is an
    /// error or nothing was made.
    pub fn conclude<T>(self, made: Option<T>) -> Result<(T, Vec<Finding>), SceneErrors> {
        match made {
            Some(made) if self.errors.is_empty() => Ok((made, self.warnings.with_remainder())),
            _ => Err(self.into_errors()),
        }
    }

    /// All errors, in file order.
    pub fn into_errors(self) -> SceneErrors {
        let file = self.path;
        let (more, mut errors) = (self.errors.more(), self.errors.listed());
        errors.sort_by_cached_key(|error| (error.file() != file, error.line_column()));
        SceneErrors {
            file,
            errors,
            more,
            warnings: self.warnings.with_remainder(),
            files: self.files,
        }
    }

    /// Like [`did_you_mean`], but returns `otherwise` when the list of errors is full.
    pub fn did_you_mean<'a>(
        &self,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
        otherwise: &str,
    ) -> String {
        if self.errors.is_full() {
            otherwise.to_owned()
        } else {
            did_you_mean(name, known, otherwise)
        }
    }

    fn line_column(&self, span: Range<usize>) -> (usize, usize) {
        self.finding(miette::Severity::Error, span, String::new(), String::new(), None)
            .line_column()
            .unwrap_or((1, 1))
    }

    fn finding(
        &self,
        severity: miette::Severity,
        span: Range<usize>,
        message: String,
        label: String,
        help: Option<String>,
    ) -> Finding {
        Finding {
            message,
            help,
            severity,
            file: self.path.clone(),
            place: Some(Span { source: self.source.clone(), span: self.drawable(span), label }),
            about_value: false,
        }
    }

    /// Cuts a span down to its first line, which a caret can mark.
    fn drawable(&self, span: Range<usize>) -> Range<usize> {
        let text = self.source.text();
        let start = span.start.min(text.len());
        let end = span.end.clamp(start, text.len());
        let first = text.get(start..end).unwrap_or("");
        let line = first.split(['\r', '\n']).next().unwrap_or("");
        start..start + line.len()
    }
}
