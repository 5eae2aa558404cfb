//! Where the parts of a scene stand in its file, for warnings about what they mean together.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::report::{Finding, Report, SourceFile};
use super::validate::Item;

/// Spans in a scene file, by path and key.
#[derive(Clone, Debug)]
pub struct Spans {
    path: PathBuf,
    source: SourceFile,
    /// `shapes[3]` and `shapes[3].radius`.
    spans: HashMap<String, Range<usize>>,
    /// The path of each of the scene's shapes; a mesh may stand for several.
    pub shapes: Vec<String>,
    /// The path of each of the scene's materials; those of an OBJ file have none in the scene file.
    pub materials: Vec<String>,
}

impl Spans {
    pub(crate) fn new(path: &Path, source: SourceFile) -> Self {
        Self {
            path: path.to_owned(),
            source,
            spans: HashMap::new(),
            shapes: Vec::new(),
            materials: Vec::new(),
        }
    }

    pub(crate) fn add(&mut self, item: &Item) {
        self.spans.insert(item.path.clone(), item.node.span());
        for (key, _, value) in item.node.entries() {
            self.spans.insert(item.key(key), value.span());
        }
    }

    /// A warning at the first of these paths that the file has, or at its head; `label` stands at
    /// the caret.
    pub fn warning(&self, paths: &[&str], message: String, label: String) -> Finding {
        let span = paths.iter().find_map(|path| self.spans.get(*path)).cloned().unwrap_or(0..0);
        Report::new(&self.path, self.source.clone(), 1).warning(span, message, label)
    }
}
