//! Positions of a scene's parts in its file, for warnings about their combination.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::diagnostics::{Finding, Report, SourceFile};
use super::parts::Part;

/// Byte ranges in a scene file, by path and key.
#[derive(Clone, Debug)]
pub struct Spans {
    path: PathBuf,
    source: SourceFile,
    /// Keys such as `shapes[3]` and `shapes[3].radius`.
    spans: HashMap<String, Range<usize>>,
    /// Path of each shape of the scene; several shapes may come from one mesh.
    pub shapes: Vec<String>,
    /// Path of each material of the scene, up to those from mesh files, which come last and have
    /// none.
    pub materials: Vec<String>,
}

impl Spans {
    pub(super) fn new(path: &Path, source: SourceFile) -> Self {
        Self {
            path: path.to_owned(),
            source,
            spans: HashMap::new(),
            shapes: Vec::new(),
            materials: Vec::new(),
        }
    }

    /// Adds a part and its keys.
    pub(super) fn add(&mut self, part: &dyn Part) {
        let place = part.place();
        self.spans.insert(place.to_owned(), part.span());
        part.each_key(&mut |key, span| {
            self.spans.insert(format!("{place}.{key}"), span);
        });
    }

    /// Creates a warning at the first of `paths` that the file has, or else at its start; `label`
    /// is printed at the caret.
    pub fn warning(&self, paths: &[&str], message: String, label: String) -> Finding {
        let span = paths.iter().find_map(|path| self.spans.get(*path)).cloned().unwrap_or(0..0);
        Report::new(&self.path, self.source.clone(), 1).warning(span, message, label)
    }
}
