//! Source text that findings quote, without characters that would act on a terminal.

use std::path::Path;
use std::sync::Arc;

use miette::{MietteError, MietteSpanContents, NamedSource, SourceCode, SourceSpan, SpanContents};

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

    /// Path of the file, as in messages.
    pub fn name(&self) -> &str {
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
