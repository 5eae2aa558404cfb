//! The parts of a TOML file after the schema check.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use serde::de::DeserializeOwned;
use serde_json::Value as Json;

use super::tree::Node;
use crate::scene::diagnostics::Report;
use crate::scene::parts::Part;

/// A part of the file that is checked and read separately.
#[derive(Debug)]
pub(super) struct Item<'a> {
    /// Path as in messages: `shapes[3]`, `materials.glass`; empty for the whole file.
    pub path: String,
    /// Last key of the path of a named part.
    pub name: &'a str,
    pub node: Node<'a>,
    /// The part as JSON without unknown keys; `None` if it does not match its type.
    pub json: Option<Json>,
}

impl Part for Item<'_> {
    fn place(&self) -> &str {
        place(&self.path)
    }

    fn span(&self) -> Range<usize> {
        self.node.span()
    }

    fn span_of(&self, key: &str) -> Range<usize> {
        self.node.span_of(key)
    }

    fn each_key(&self, visit: &mut dyn FnMut(&str, Range<usize>)) {
        self.node.entries().for_each(|(key, _, value)| visit(key, value.span()));
    }
}

impl Item<'_> {
    /// Name of a key of the part in messages.
    pub fn key(&self, key: &str) -> String {
        join(&self.path, key)
    }

    /// Deserializes the part; `None` if its check found an error that prevents this.
    pub fn read<T: DeserializeOwned>(&self, report: &mut Report) -> Option<T> {
        let json = self.json.clone()?;
        match serde_json::from_value(json) {
            Ok(value) => Some(value),
            Err(error) => {
                let message = format!("{} cannot be read: {error}", self.place());
                report.error(self.node.span(), message, "in here", None);
                None
            }
        }
    }
}

/// The parts of a file after the check.
#[derive(Debug)]
pub(super) struct Document<'a> {
    pub sections: BTreeMap<&'a str, Vec<Item<'a>>>,
    /// Index of each named part in its section.
    pub names: HashMap<(&'a str, &'a str), usize>,
}

impl<'a> Document<'a> {
    /// Parts under a top-level key: the elements of an array, the entries of a table of named
    /// parts, or the single value.
    pub fn items(&self, section: &str) -> impl Iterator<Item = &Item<'a>> {
        self.sections.get(section).into_iter().flatten()
    }

    /// Index of a named part in its section.
    pub fn index(&self, section: &str, name: &str) -> Option<usize> {
        self.names.get(&(section, name)).copied()
    }

    /// The single value under a top-level key.
    pub fn item(&self, section: &str) -> Option<&Item<'a>> {
        self.items(section).next()
    }
}

/// Name of the whole file in messages.
pub(super) const THE_FILE: &str = "the file";

/// Name of a part in messages.
pub(super) fn place(path: &str) -> &str {
    if path.is_empty() { THE_FILE } else { path }
}

/// Path of a key of a part.
pub(super) fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
