//! Ordered list of findings: one per subject up to a limit; further ones are only counted.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::finding::Finding;

/// Findings in the order of discovery.
#[derive(Debug)]
pub(crate) struct Findings {
    listed: Vec<Finding>,
    most: usize,
    more: usize,
    found: usize,
    /// Hashes of the subjects so far.
    known: HashSet<u64>,
}

impl Findings {
    /// Creates an empty list of at most `most` findings, but at least one.
    pub fn new(most: u64) -> Self {
        let most = usize::try_from(most).unwrap_or(usize::MAX).max(1);
        Self { listed: Vec::new(), most, more: 0, found: 0, known: HashSet::new() }
    }

    /// Adds a finding unless there is one with the same subject.
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

    /// Returns whether the list is full, so that callers can skip the search for suggestions.
    pub fn is_full(&self) -> bool {
        self.listed.len() >= self.most
    }

    /// Number of findings pushed, duplicates included.
    pub fn found(&self) -> usize {
        self.found
    }

    /// Number of findings beyond the list, duplicates excluded.
    pub fn more(&self) -> usize {
        self.more
    }

    /// The listed findings.
    pub fn listed(self) -> Vec<Finding> {
        self.listed
    }

    /// The listed findings, and one that states the number of the others.
    pub fn with_remainder(self) -> Vec<Finding> {
        let unlisted = (self.more > 0).then(|| Finding::unlisted(self.more));
        self.listed.into_iter().chain(unlisted).collect()
    }
}
