//! Errors and warnings with their positions in the files.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, NamedSource, SourceCode, SourceSpan,
    SpanContents,
};

use super::diagnostics::Findings;

/// A text file that findings point into; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct SourceFile {
    file: Arc<NamedSource<String>>,
    /// Copy for display, if the text has control characters.
    shown: Option<Arc<NamedSource<String>>>,
}

impl SourceFile {
    pub fn new(path: &Path, text: String) -> Self {
        let name = path.display().to_string();
        let dirty = [&name, &text].iter().any(|text| followed(text).any(is_control));
        let shown = dirty
            .then(|| Arc::new(NamedSource::new(without_control(&name), without_control(&text))));
        Self { file: Arc::new(NamedSource::new(name, text)), shown }
    }

    fn name(&self) -> &str {
        self.file.name()
    }

    pub fn text(&self) -> &str {
        self.file.inner()
    }
}

/// Each character with the next one.
fn followed(text: &str) -> impl Iterator<Item = (char, Option<char>)> {
    text.chars().zip(text.chars().skip(1).map(Some).chain([None]))
}

/// Returns whether a terminal would act on a character: control characters except tabs and line
/// ends, and characters that change the direction of writing.
fn is_control((c, next): (char, Option<char>)) -> bool {
    let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let ends_line = c == '\r' && next == Some('\n');
    turns || c.is_control() && !matches!(c, '\n' | '\t') && !ends_line
}

/// `text` with each control character replaced by a character of the same UTF-8 length, since spans
/// count bytes.
fn without_control(text: &str) -> String {
    let shown = |followed: (char, Option<char>)| match followed.0.len_utf8() {
        _ if !is_control(followed) => followed.0,
        1 => '?',
        2 => '\u{bf}',
        _ => char::REPLACEMENT_CHARACTER,
    };
    followed(text).map(shown).collect()
}

/// Most bytes of a line that are shown around a position.
const MOST_SHOWN: usize = 400;

impl SourceCode for SourceFile {
    /// The lines around a span, or part of a very long line.
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let source = self.shown.as_ref().unwrap_or(&self.file);
        let lines = source.read_span(span, before, after)?;
        if lines.data().len() <= MOST_SHOWN {
            return Ok(lines);
        }
        let (text, at) = (source.inner(), span.offset());
        let boundary =
            |at: usize| (at..).find(|&at| text.is_char_boundary(at)).unwrap_or(text.len());
        let line_start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let line_end = text[at..].find('\n').map_or(text.len(), |length| at + length);
        let start = boundary(at.saturating_sub(MOST_SHOWN / 4).max(line_start));
        let end = boundary((at + span.len().min(MOST_SHOWN / 2) + MOST_SHOWN / 4).min(line_end));
        let line = text[..at].matches('\n').count();
        let (cut, shown) = (SourceSpan::from(start..end), &text.as_bytes()[start..end]);
        let name = source.name().to_owned();
        Ok(Box::new(MietteSpanContents::new_named(name, shown, cut, line, start - line_start, 1)))
    }
}

/// An error or a warning about a scene, with its position. [`miette`] prints it with the offending
/// line and a caret.
#[derive(Clone, Debug)]
pub struct Finding {
    message: String,
    help: Option<String>,
    severity: miette::Severity,
    file: String,
    place: Option<Span>,
    /// True if this is an error in a value of the scene file, not a missing key or an error in
    /// another file.
    about_value: bool,
}

#[derive(Clone, Debug)]
struct Span {
    source: SourceFile,
    span: Range<usize>,
    label: String,
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

/// Most errors of one mesh or material file that are listed.
const MOST_PER_ASSET: usize = 10;
/// Most warnings of one mesh or material file that are listed.
const MOST_WARNINGS_PER_ASSET: usize = 100;

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

/// An error or a warning in a file that a scene names.
#[derive(Debug)]
struct Fault {
    span: Range<usize>,
    message: String,
    expected: String,
}

/// Faults in a file that a scene names: the first ones, and the number of the others.
#[derive(Debug)]
pub(crate) struct Faults {
    listed: Vec<Fault>,
    most: usize,
    more: usize,
}

impl Default for Faults {
    fn default() -> Self {
        Self { listed: Vec::new(), most: MOST_PER_ASSET, more: 0 }
    }
}

impl Faults {
    /// An empty list for warnings, which may concern each key of a material.
    pub fn warnings() -> Self {
        Self { most: MOST_WARNINGS_PER_ASSET, ..Self::default() }
    }

    pub fn push(
        &mut self,
        span: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) {
        if !self.is_full() {
            self.listed.push(Fault { span, message: message.into(), expected: expected.into() });
        } else {
            self.more += 1;
        }
    }

    /// Returns whether no further fault will be listed.
    pub fn is_full(&self) -> bool {
        self.listed.len() == self.most
    }
}

/// Limits of the search for similar names, whose cost grows with their product: the longest name in
/// bytes, and the number of known names.
const LONGEST_COMPARED: usize = 80;
const MOST_COMPARED: usize = 1000;

/// The known name nearest to a misspelt one, if any is close.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.len() > LONGEST_COMPARED {
        return None;
    }
    let lower = name.to_lowercase();
    known
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST_COMPARED)
        .take(MOST_COMPARED)
        .map(|candidate| {
            (strsim::damerau_levenshtein(&lower, &candidate.to_lowercase()), candidate)
        })
        .filter(|&(distance, candidate)| distance <= candidate.chars().count().div_ceil(3))
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// Formats "did you mean `x`?", or returns `otherwise`.
pub(crate) fn did_you_mean<'a>(
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
    otherwise: &str,
) -> String {
    nearest(name, known)
        .map_or_else(|| otherwise.to_owned(), |candidate| format!("did you mean `{candidate}`?"))
}

/// Most names in a list.
const MOST_LISTED: usize = 40;

/// Formats names as "`a`, `b`, `c`".
pub(crate) fn list<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut names = names.into_iter();
    let mut quoted: Vec<_> =
        names.by_ref().take(MOST_LISTED).map(|name| format!("`{name}`")).collect();
    match names.count() {
        0 => {}
        more => quoted.push(format!("{more} more")),
    }
    quoted.join(", ")
}
