//! Findings as they come: the first of each subject, listed up to a number and counted beyond.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::report::{Finding, Report};

/// What was found, in order.
#[derive(Debug)]
pub(crate) struct Findings {
    listed: Vec<Finding>,
    most: usize,
    more: usize,
    found: usize,
    /// Hashes of the subjects.
    known: HashSet<u64>,
}

impl Findings {
    /// Lists at least one.
    pub fn new(most: u64) -> Self {
        let most = usize::try_from(most).unwrap_or(usize::MAX).max(1);
        Self { listed: Vec::new(), most, more: 0, found: 0, known: HashSet::new() }
    }

    /// Adds a finding, unless there is one about the same.
    pub fn push(&mut self, finding: Finding) {
        self.found += 1;
        let mut hasher = DefaultHasher::new();
        finding.subject().hash(&mut hasher);
        if !self.known.insert(hasher.finish()) {
            return;
        }
        if self.is_full() {
            self.more += 1;
        } else {
            self.listed.push(finding);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.listed.is_empty()
    }

    /// Whether no other will be listed, so that the search for advice can be spared.
    pub fn is_full(&self) -> bool {
        self.listed.len() >= self.most
    }

    /// How often something was found, the same several times too.
    pub fn found(&self) -> usize {
        self.found
    }

    /// Number of those that are not listed.
    pub fn more(&self) -> usize {
        self.more
    }

    /// Those listed.
    pub fn listed(self) -> Vec<Finding> {
        self.listed
    }

    /// Those listed, and one that tells the number of the others.
    pub fn told(self) -> Vec<Finding> {
        let unlisted = (self.more > 0).then(|| Report::unlisted(self.more));
        self.listed.into_iter().chain(unlisted).collect()
    }
}
