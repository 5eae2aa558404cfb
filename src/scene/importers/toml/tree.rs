//! Parsed TOML tree with the position of each value.

use std::ops::Range;

use serde_json::Value as Json;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A TOML value with its position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'a>(&'a Spanned<DeValue<'a>>);

impl<'a> Node<'a> {
    pub fn new(value: &'a Spanned<DeValue<'a>>) -> Self {
        Self(value)
    }

    /// Byte range of the value; for a `[table]`, of its header.
    pub fn span(&self) -> Range<usize> {
        self.0.span()
    }

    /// Byte range of the value under a key; the node's own if there is no such key.
    pub fn span_of(&self, key: &str) -> Range<usize> {
        self.get(key).map_or(self.span(), |value| value.span())
    }

    /// The value under a key of a table.
    pub fn get(&self, key: &str) -> Option<Node<'a>> {
        self.0.get_ref().get(key).map(Node)
    }

    pub fn table(&self) -> Option<&'a DeTable<'a>> {
        self.0.get_ref().as_table()
    }

    pub fn str(&self) -> Option<&'a str> {
        self.0.get_ref().as_str()
    }

    /// Elements of an array; empty for other types.
    pub fn elements(&self) -> impl Iterator<Item = Node<'a>> + use<'a> {
        self.0.get_ref().as_array().into_iter().flat_map(|array| array.iter().map(Node))
    }

    /// Keys with their byte ranges, and values, of a table; empty for other types.
    pub fn entries(&self) -> impl Iterator<Item = (&'a str, Range<usize>, Node<'a>)> + use<'a> {
        let pairs = self.table().into_iter().flat_map(|table| table.iter());
        pairs.map(|(key, value)| (key.get_ref().as_ref(), key.span(), Node(value)))
    }

    /// A number as f64; NaN if it cannot be parsed or is an integer beyond i128.
    pub fn number(&self) -> Option<f64> {
        match self.0.get_ref() {
            DeValue::Float(float) => Some(float.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Integer(_) => Some(self.integer().map_or(f64::NAN, |integer| integer as f64)),
            _ => None,
        }
    }

    /// An integer; `None` for other types and for integers beyond i128.
    pub fn integer(&self) -> Option<i128> {
        let integer = self.0.get_ref().as_integer()?;
        i128::from_str_radix(integer.as_str(), integer.radix()).ok()
    }

    /// The matching JSON type.
    pub fn json_type(&self) -> &'static str {
        match self.0.get_ref() {
            DeValue::String(_) => "string",
            DeValue::Integer(_) => "integer",
            DeValue::Float(_) => "number",
            DeValue::Boolean(_) => "boolean",
            DeValue::Datetime(_) => "date",
            DeValue::Array(_) => "array",
            DeValue::Table(_) => "object",
        }
    }

    /// Name of its type, for messages.
    pub fn type_name(&self) -> &'static str {
        match self.0.get_ref() {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) => "a whole number",
            DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "an array",
            DeValue::Table(_) => "a table",
        }
    }

    /// A string or a boolean as JSON; `None` for other types.
    pub fn plain_json(&self) -> Option<Json> {
        match self.0.get_ref() {
            DeValue::String(text) => Some(Json::String(text.to_string())),
            DeValue::Boolean(flag) => Some(Json::Bool(*flag)),
            _ => None,
        }
    }
}
