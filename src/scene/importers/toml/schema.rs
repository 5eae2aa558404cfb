//! JSON Schema of scene files, and queries on it.

use serde_json::Value as Json;

use super::file::SceneFile;

/// JSON Schema of scene files, as stored in `scenes/schema.json`.
pub fn schema_json() -> String {
    let mut text = format!("{:#}", of::<SceneFile>());
    text.push('\n');
    text
}

/// Schema of a type as JSON.
pub(crate) fn of<T: schemars::JsonSchema>() -> Json {
    schemars::schema_for!(T).to_value()
}

/// Forbids unknown keys in each variant; serde cannot do so together with `flatten`.
pub(crate) fn close_variants(schema: &mut schemars::Schema) {
    if let Some(Json::Array(variants)) = schema.get_mut("oneOf") {
        for variant in variants {
            variant["additionalProperties"] = Json::Bool(false);
        }
    }
}

/// Makes `type` optional in the first variant, which is the default.
pub(crate) fn default_to_first(schema: &mut schemars::Schema) {
    let variants = schema.get_mut("oneOf").and_then(Json::as_array_mut);
    let first = variants.and_then(|variants| variants.first_mut());
    if let Some(required) = first.and_then(|first| first["required"].as_array_mut()) {
        required.retain(|key| key != "type");
    }
}

/// Returns whether a table of this schema needs no `type`.
pub(crate) fn is_default(schema: &Json) -> bool {
    let required = schema["required"].as_array();
    !required.is_some_and(|keys| keys.iter().any(|key| key == "type"))
}

/// Schemas that a value may match: references resolved, nested alternatives flattened, `null` left
/// out.
pub(crate) fn alternatives<'s>(root: &'s Json, schema: &'s Json) -> Vec<&'s Json> {
    if let Some(reference) = schema["$ref"].as_str() {
        let target = reference.strip_prefix('#').and_then(|path| root.pointer(path));
        return target.map_or(Vec::new(), |target| alternatives(root, target));
    }
    let nested = schema["anyOf"].as_array().or(schema["oneOf"].as_array());
    match nested {
        Some(list) => list.iter().flat_map(|one| alternatives(root, one)).collect(),
        None if schema["type"] == "null" => Vec::new(),
        None => vec![schema],
    }
}

/// Returns whether a schema without alternatives has this JSON type.
pub(crate) fn has_type(schema: &Json, name: &str) -> bool {
    match &schema["type"] {
        Json::String(own) => own == name,
        Json::Array(own) => own.iter().any(|one| one == name),
        _ => false,
    }
}

/// The strings that a schema without alternatives allows, if it lists them.
pub(crate) fn listed_strings(schema: &Json) -> Option<Vec<&str>> {
    if let Some(one) = schema["const"].as_str() {
        return Some(vec![one]);
    }
    schema["enum"].as_array().map(|all| all.iter().filter_map(Json::as_str).collect())
}

/// Value of the key `type` in a table of this schema.
pub(crate) fn tag(schema: &Json) -> Option<&str> {
    schema["properties"]["type"]["const"].as_str()
}

/// Describes the expected value in words.
pub(crate) fn describe(root: &Json, schema: &Json) -> String {
    let all = alternatives(root, schema);
    if let Some(tags) = all.iter().map(|one| tag(one)).collect::<Option<Vec<_>>>() {
        return format!("a table with `type` {}", quoted(tags));
    }
    let (words, rest): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|one| listed_strings(one).is_some());
    let mut parts: Vec<_> = rest.into_iter().map(|one| describe_one(root, one)).collect();
    if !words.is_empty() {
        parts.push(quoted(words.into_iter().filter_map(listed_strings).flatten()));
    }
    parts.dedup();
    parts.join(" or ")
}

fn quoted<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.into_iter().map(|word| format!("\"{word}\"")).collect();
    words.join(" or ")
}

fn describe_one(root: &Json, schema: &Json) -> String {
    if has_type(schema, "boolean") {
        "true or false".into()
    } else if has_type(schema, "string") {
        "a string".into()
    } else if has_type(schema, "integer") {
        format!("a whole number{}", range(schema))
    } else if has_type(schema, "number") {
        format!("a number{}", range(schema))
    } else if has_type(schema, "array") {
        let items = describe(root, &schema["items"]);
        let items = match items.strip_prefix("a number") {
            Some(range) if !range.contains(" or ") => format!(" numbers{range}"),
            _ => format!(", each {items}"),
        };
        match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
            (Some(least), Some(most)) if least == most => format!("an array of {least}{items}"),
            (Some(least), Some(most)) => format!("an array of {least} to {most}{items}"),
            (Some(least), None) => format!("an array of at least {least}{items}"),
            _ => format!("an array of any number{items}"),
        }
    } else {
        let required = schema["required"].as_array().map_or(&[][..], |keys| keys);
        let keys: Vec<_> = required.iter().filter_map(Json::as_str).collect();
        match keys[..] {
            [only] if schema["additionalProperties"] == false => format!("{{ {only} = ... }}"),
            _ => "a table".into(),
        }
    }
}

/// The range of a number in words, with a leading space.
fn range(schema: &Json) -> String {
    let bound = |name: &str| schema[name].as_f64();
    let low = bound("exclusiveMinimum")
        .map(|low| format!("greater than {low}"))
        .or(bound("minimum").map(|low| format!("not below {low}")));
    let high = bound("exclusiveMaximum")
        .map(|high| format!("less than {high}"))
        .or(bound("maximum").map(|high| format!("at most {high}")));
    match (bound("minimum"), bound("maximum"), low, high) {
        (Some(low), Some(high), ..) => format!(" from {low} to {high}"),
        (_, _, Some(low), Some(high)) => format!(" {low} and {high}"),
        (_, _, Some(only), None) | (_, _, None, Some(only)) => format!(" {only}"),
        _ => String::new(),
    }
}

/// Returns whether a number is within the range of its schema.
pub(crate) fn in_range(schema: &Json, number: f64) -> bool {
    let holds = |name: &str, test: fn(f64, f64) -> bool| {
        schema[name].as_f64().is_none_or(|bound| test(number, bound))
    };
    holds("minimum", |x, bound| x >= bound)
        && holds("maximum", |x, bound| x <= bound)
        && holds("exclusiveMinimum", |x, bound| x > bound)
        && holds("exclusiveMaximum", |x, bound| x < bound)
}
