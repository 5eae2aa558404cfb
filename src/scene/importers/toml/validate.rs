//! Validates a parsed file against the schema and reports every difference: unknown and missing
//! keys, wrong types, numbers out of range, words that are not listed.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use serde_json::{Map, Value as Json};

use super::document::{Document, Item, THE_FILE, join, place};
use super::schema::{alternatives, describe, has_type, in_range, is_default, listed_strings, tag};
use super::tree::Node;
use crate::scene::diagnostics::{Report, list};
use crate::scene::numbers::{LARGEST, SMALLEST, rounded_into};

/// Checks a file that consists of a single part.
pub(crate) fn whole<'a>(root: &Json, file: Node<'a>, report: &mut Report) -> Item<'a> {
    let json = Checker { root, report }.value(root, file, "");
    Item { path: String::new(), name: "", node: file, json }
}

/// Checks a file of several parts.
pub(crate) fn document<'a>(root: &Json, file: Node<'a>, report: &mut Report) -> Document<'a> {
    let mut checker = Checker { root, report };
    checker.missing_keys(root, file, THE_FILE);
    let mut sections = BTreeMap::<&str, Vec<Item>>::new();
    let mut names = HashMap::new();
    for (key, key_span, node) in file.entries() {
        let Some(schema) = checker.property(root, key, key_span, THE_FILE) else {
            continue;
        };
        let resolved = alternatives(root, schema);
        let items = sections.entry(key).or_default();
        let container = resolved.first().copied().unwrap_or(&Json::Null);
        let is_map = container["additionalProperties"].is_object();
        if is_map && node.table().is_some() {
            for (name, _, node) in node.entries() {
                let path = format!("{key}.{name}");
                let json = checker.value(&container["additionalProperties"], node, &path);
                names.insert((key, name), items.len());
                items.push(Item { path, name, node, json });
            }
        } else if has_type(container, "array") && node.json_type() == "array" {
            for (index, node) in node.elements().enumerate() {
                let path = format!("{key}[{index}]");
                let json = checker.value(&container["items"], node, &path);
                items.push(Item { path, name: "", node, json });
            }
        } else {
            let json = checker.value(schema, node, key);
            items.push(Item { path: key.into(), name: "", node, json });
        }
    }
    Document { sections, names }
}

struct Checker<'c> {
    root: &'c Json,
    report: &'c mut Report,
}

impl<'c> Checker<'c> {
    /// Checks a value and converts it to JSON without unknown keys; `None` if its type does not
    /// match. A number out of range is reported and still returned, so that later checks can find
    /// other errors.
    fn value(&mut self, schema: &'c Json, node: Node, path: &str) -> Option<Json> {
        let all = alternatives(self.root, schema);
        let fits = |one: &&&Json| {
            let own = node.json_type();
            has_type(one, own) || (own == "integer" && has_type(one, "number"))
        };
        let fitting: Vec<_> = all.iter().filter(fits).copied().collect();
        match (node.json_type(), &fitting[..]) {
            (_, []) => {
                self.wrong_type(schema, node, path);
                None
            }
            ("object", _) => self.table(schema, &fitting, node, path),
            ("array", [first, ..]) => self.array(first, node, path),
            ("integer" | "number", [first, ..]) => self.number(schema, first, node, path),
            ("string", _) => self.string(schema, &fitting, node, path),
            _ => node.plain_json(),
        }
    }

    fn wrong_type(&mut self, schema: &Json, node: Node, path: &str) {
        let expected = describe(self.root, schema);
        let mut help = description(schema);
        if node.json_type() == "object" && has_type(schema, "array") {
            help = Some(format!("write [[{path}]] with two brackets, once for each"));
        } else if node.json_type() == "array" && expected.starts_with("a table") {
            help = Some(format!("write [{path}] with one bracket, once"));
        }
        self.report.error(
            node.span(),
            format!("`{path}` is {}", node.type_name()),
            format!("expected {expected}"),
            help,
        );
    }

    fn number(&mut self, whole: &Json, schema: &Json, node: Node, path: &str) -> Option<Json> {
        let number = node.number()?;
        let expected = describe(self.root, schema);
        if !number.is_finite() {
            let message = format!("`{path}` is not a finite number");
            self.report.error(
                node.span(),
                message,
                expected.replacen("a number", "expected a finite number", 1),
                description(whole),
            );
            return Some(Json::from(1.0));
        }
        if let Some(inside) = rounded(schema, number) {
            let message = format!("`{path}` = {number} is out of range by rounding");
            self.report.warn(node.span(), message, format!("read as {inside}"));
            return Some(Json::from(inside));
        }
        let fits = in_range(schema, number) && integer_fits(schema, number);
        if !fits {
            let message = format!("`{path}` = {number} is out of range");
            self.report.error(
                node.span(),
                message,
                format!("expected {expected}"),
                description(whole),
            );
        }
        if !has_type(schema, "integer") {
            let largest = schema["x-largest"].as_f64().unwrap_or(LARGEST);
            let smallest = if schema["exclusiveMinimum"] == 0 { SMALLEST } else { 0.0 };
            if fits && number.abs() > largest {
                let message = format!("`{path}` = {number:e} is too large for single precision");
                let label = format!("expected at most {largest:e} in magnitude");
                self.report.error(node.span(), message, label, description(whole));
            } else if fits && number < smallest && smallest > 0.0 {
                let message = format!("`{path}` = {number:e} is too small for single precision");
                let label = format!("expected at least {smallest:e}");
                self.report.error(node.span(), message, label, description(whole));
            }
            return Some(Json::from(number.clamp(-largest, largest)));
        }
        let clamped = node.integer()?.clamp(0, i128::from(u32::MAX));
        let integer = if fits { node.integer()? } else { clamped };
        u64::try_from(integer).map(Json::from).or(i64::try_from(integer).map(Json::from)).ok()
    }

    fn string(&mut self, schema: &Json, fitting: &[&Json], node: Node, path: &str) -> Option<Json> {
        let text = node.str()?;
        let listed: Option<Vec<_>> = fitting.iter().map(|one| listed_strings(one)).collect();
        if let Some(words) = listed.map(|lists| lists.concat())
            && !words.contains(&text)
        {
            let expected = format!("expected {}", describe(self.root, schema));
            let label = self.report.did_you_mean(text, words, &expected);
            let message = format!("`{path}` = \"{text}\" is not known");
            self.report.error(node.span(), message, label, Some(expected));
            return None;
        }
        node.plain_json()
    }

    fn array(&mut self, schema: &'c Json, node: Node, path: &str) -> Option<Json> {
        let length = node.elements().count() as u64;
        let least = schema["minItems"].as_u64().unwrap_or(0);
        let most = schema["maxItems"].as_u64().unwrap_or(u64::MAX);
        let fits = (least..=most).contains(&length);
        if !fits {
            self.report.error(
                node.span(),
                format!("`{path}` has {length} element{}", if length == 1 { "" } else { "s" }),
                format!("expected {}", describe(self.root, schema)),
                description(schema),
            );
        }
        let mut elements = Vec::new();
        for (index, element) in node.elements().enumerate() {
            elements.push(self.value(&schema["items"], element, &format!("{path}[{index}]")));
        }
        let elements: Option<Vec<_>> = elements.into_iter().collect();
        elements.filter(|_| fits).map(Json::Array)
    }

    fn table(
        &mut self,
        whole: &'c Json,
        fitting: &[&'c Json],
        node: Node,
        path: &str,
    ) -> Option<Json> {
        let schema = self.variant(whole, fitting, node, path)?;
        let place = match tag(schema) {
            Some(kind) if node.get("type").is_some() => format!("{path} ({kind})"),
            _ => place(path).to_owned(),
        };
        let mut complete = self.missing_keys(schema, node, &place);
        let mut table = Map::new();
        if let Some(kind) = tag(schema) {
            table.insert("type".to_owned(), Json::from(kind));
        }
        for (key, key_span, value) in node.entries() {
            let Some(property) = self.property(schema, key, key_span, &place) else {
                continue;
            };
            match self.value(property, value, &join(path, key)) {
                Some(json) => drop(table.insert(key.to_owned(), json)),
                None => complete = false,
            }
        }
        complete.then_some(Json::Object(table))
    }

    /// Selects one of several table schemas by `type`, or else by a key that only one of them has.
    fn variant(
        &mut self,
        whole: &Json,
        fitting: &[&'c Json],
        node: Node,
        path: &str,
    ) -> Option<&'c Json> {
        if let [only] = fitting {
            return Some(only);
        }
        let tags: Vec<_> = fitting.iter().filter_map(|one| tag(one)).collect();
        if tags.is_empty() {
            let has_key =
                |one: &&&Json| node.entries().any(|(key, ..)| one["properties"].get(key).is_some());
            let found = fitting.iter().find(has_key).copied();
            if found.is_none() {
                let expected = format!("expected {}", describe(self.root, whole));
                self.report.error(
                    node.span(),
                    format!("`{path}` has no known key"),
                    expected,
                    None,
                );
            }
            return found;
        }
        let kinds = format!("known types: {}", list(tags.iter().copied()));
        let Some(kind) = node.get("type") else {
            if let Some(default) = fitting.iter().find(|one| is_default(one)) {
                return Some(default);
            }
            let message = format!("`type` is missing in {path}");
            self.report.error(node.span(), message, "expected a `type` in here", Some(kinds));
            return None;
        };
        let Some(text) = kind.str() else {
            let message = format!("`{path}.type` is {}", kind.type_name());
            self.report.error(kind.span(), message, "expected a string", Some(kinds));
            return None;
        };
        let found = fitting.iter().find(|one| tag(one) == Some(text)).copied();
        if found.is_none() {
            let label = self.report.did_you_mean(text, tags, "not a known type");
            self.report.error(
                kind.span(),
                format!("unknown type \"{text}\" in {path}"),
                label,
                Some(kinds),
            );
        }
        found
    }

    /// The schema of a key; reports an unknown key.
    fn property(
        &mut self,
        schema: &'c Json,
        key: &str,
        span: Range<usize>,
        place: &str,
    ) -> Option<&'c Json> {
        let properties = schema["properties"].as_object();
        let found = properties.and_then(|all| all.get(key));
        if found.is_none() {
            let known: Vec<_> =
                properties.into_iter().flat_map(|all| all.keys().map(String::as_str)).collect();
            let label = self.report.did_you_mean(key, known.iter().copied(), "not known here");
            let help = format!("known keys: {}", list(known));
            self.report.error(span, format!("unknown key `{key}` in {place}"), label, Some(help));
        }
        found
    }

    /// Reports missing required keys; returns true if there are none.
    fn missing_keys(&mut self, schema: &Json, node: Node, place: &str) -> bool {
        let required = schema["required"].as_array().into_iter().flatten();
        let missing: Vec<_> =
            required.filter_map(Json::as_str).filter(|key| node.get(key).is_none()).collect();
        for key in &missing {
            let property = &schema["properties"][*key];
            let message = format!("`{key}` is missing in {place}");
            let label = format!("expected `{key}`, {}", describe(self.root, property));
            self.report.missing(node.span(), message, label, description(property));
        }
        missing.is_empty()
    }
}

fn description(schema: &Json) -> Option<String> {
    schema["description"].as_str().map(|text| text.replace('\n', " "))
}

/// The nearest number in a schema's range, if `number` is out of it by a rounding error.
fn rounded(schema: &Json, number: f64) -> Option<f64> {
    if in_range(schema, number) || has_type(schema, "integer") {
        return None;
    }
    let least = schema["minimum"].as_f64().unwrap_or(f64::NEG_INFINITY);
    let most = schema["maximum"].as_f64().unwrap_or(f64::INFINITY);
    rounded_into(number, least, most).filter(|&inside| in_range(schema, inside))
}

fn integer_fits(schema: &Json, number: f64) -> bool {
    match schema["format"].as_str() {
        Some("int32") => number >= f64::from(i32::MIN) && number <= f64::from(i32::MAX),
        Some("uint32") => number <= f64::from(u32::MAX),
        Some("uint64") => number <= i64::MAX as f64,
        _ => true,
    }
}
