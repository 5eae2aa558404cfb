//! Diagnostic reports with escaped control characters and line feeds, which may come from quoted
//! names. Quoted lines of files are already free of them (`scene::diagnostics`).

use std::error::Error;
use std::fmt;

use miette::{Diagnostic, LabeledSpan, ReportHandler, Severity, SourceCode};

use super::colors;
use super::output::one_line;

/// A diagnostic with escaped control characters.
pub struct Shown<'a> {
    found: &'a dyn Diagnostic,
    words: Words,
    related: Vec<Shown<'a>>,
}

/// Messages of an error and of its causes.
#[derive(Debug)]
struct Words {
    text: String,
    cause: Option<Box<Words>>,
}

impl Words {
    fn of(error: &dyn Error) -> Self {
        let cause = error.source().map(|cause| Box::new(Self::of(cause)));
        Self { text: one_line(&error.to_string()), cause }
    }
}

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Error for Words {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_ref().map(|cause| &**cause as &dyn Error)
    }
}

impl<'a> Shown<'a> {
    /// Wraps a diagnostic.
    pub fn of(found: &'a dyn Diagnostic) -> Self {
        let cause = found.source().map(|cause| Box::new(Words::of(cause)));
        let words = Words { text: one_line(&found.to_string()), cause };
        Self {
            found,
            words,
            related: found.related().into_iter().flatten().map(Self::of).collect(),
        }
    }

    /// Formats the report, in color if enabled.
    pub fn report(&self) -> String {
        struct Whole<'a, 'b>(&'b Shown<'a>);
        impl fmt::Display for Whole<'_, '_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                colors::handler().debug(self.0, f)
            }
        }
        Whole(self).to_string()
    }
}

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.words.fmt(f)
    }
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.words.fmt(f)
    }
}

impl Error for Shown<'_> {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.words.source()
    }
}

impl Diagnostic for Shown<'_> {
    fn severity(&self) -> Option<Severity> {
        self.found.severity()
    }

    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.found.help().map(|help| Box::new(one_line(&help.to_string())) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.found.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let labels = self.found.labels()?.map(|label| {
            let words = label.label().map(one_line);
            match label.primary() {
                true => LabeledSpan::new_primary_with_span(words, *label.inner()),
                false => LabeledSpan::new_with_span(words, *label.inner()),
            }
        });
        Some(Box::new(labels))
    }

    fn related<'b>(&'b self) -> Option<Box<dyn Iterator<Item = &'b dyn Diagnostic> + 'b>> {
        let related = self.related.iter().map(|shown| shown as &dyn Diagnostic);
        (!self.related.is_empty()).then(|| Box::new(related) as Box<dyn Iterator<Item = _>>)
    }
}
