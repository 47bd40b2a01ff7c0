//! Compares a manifest with the published schemas of Kubernetes (`fixtures/kubernetes`).

use serde_json::{Map, Value};
use std::sync::LazyLock;

static PUBLISHED: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("../../../fixtures/kubernetes/schemas.json")).unwrap());

/// The faults of a manifest, each with its place. An unknown field is a fault, and so is a field without a value.
pub(crate) fn faults(manifest: &Value) -> Vec<String> {
    let kind = format!("{} {}", text(manifest, "apiVersion"), text(manifest, "kind"));
    let Some(root) = PUBLISHED["roots"].get(&kind) else {
        return vec![format!("{kind:?} is no kind of manifest that is known here")];
    };
    let mut faults = Vec::new();
    compare(manifest, &PUBLISHED["schemas"][root.as_str().unwrap()], "", &mut faults);
    faults
}

fn text<'a>(value: &'a Value, name: &str) -> &'a str {
    value[name].as_str().unwrap_or_default()
}

fn compare(value: &Value, schema: &Value, at: &str, faults: &mut Vec<String>) {
    if let Some(name) = schema["$ref"].as_str() {
        return compare(value, &PUBLISHED["schemas"][name], at, faults);
    }
    if let Some(kinds) = schema["oneOf"].as_array() {
        if !kinds.iter().any(|kind| has_type(value, kind)) {
            faults.push(format!("{at}: {value} has none of the types {}", schema["oneOf"]));
        }
        return;
    }
    if !has_type(value, schema) {
        return faults.push(format!("{at}: {value} is no {}", schema["type"]));
    }
    if schema["enum"].as_array().is_some_and(|allowed| !allowed.contains(value)) {
        faults.push(format!("{at}: {value} is none of {}", schema["enum"]));
    }
    match value {
        Value::Object(fields) => compare_fields(fields, schema, at, faults),
        Value::Array(items) => {
            for (position, item) in items.iter().enumerate() {
                compare(item, &schema["items"], &format!("{at}[{position}]"), faults);
            }
        }
        _ => {}
    }
}

fn compare_fields(fields: &Map<String, Value>, schema: &Value, at: &str, faults: &mut Vec<String>) {
    for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        if !fields.contains_key(name) {
            faults.push(format!("{at}: the field {name} is missing"));
        }
    }
    for (name, value) in fields {
        let known = schema["properties"].get(name);
        let other = Some(&schema["additionalProperties"]).filter(|schema| schema.is_object());
        match known.or(other) {
            Some(schema) => compare(value, schema, &format!("{at}.{name}"), faults),
            None => faults.push(format!("{at}: there is no field {name}")),
        }
    }
}

/// The package's schemas allow null everywhere, which servers mostly take as absent. We never write one.
fn has_type(value: &Value, schema: &Value) -> bool {
    let is = |kind: &str| match kind {
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.as_i64().is_some_and(|number| schema["format"] != "int32" || i32::try_from(number).is_ok()),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => false,
    };
    match &schema["type"] {
        Value::String(kind) => is(kind),
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).any(is),
        _ => false,
    }
}
