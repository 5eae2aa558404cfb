//! Errors or warnings in one file that a scene names, such as a mesh.

use std::ops::Range;

/// Most errors of one mesh or material file that are listed.
const MOST_PER_ASSET: usize = 10;
/// Most warnings of one mesh or material file that are listed.
const MOST_WARNINGS_PER_ASSET: usize = 100;

/// An error or a warning in a file that a scene names.
#[derive(Debug)]
pub(super) struct Fault {
    pub span: Range<usize>,
    pub message: String,
    pub expected: String,
}

/// Faults in a file that a scene names: the first ones, and the number of the others.
#[derive(Debug)]
pub(crate) struct Faults {
    pub(super) listed: Vec<Fault>,
    most: usize,
    /// Number of faults beyond the list.
    pub(super) more: usize,
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

    pub fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// Returns whether no further fault will be listed.
    pub fn is_full(&self) -> bool {
        self.listed.len() == self.most
    }
}
