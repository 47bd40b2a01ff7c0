//! One item of a file. Its methods take fields and check their types, and an error names file, item and field.

use crate::{FormatError, ItemPlace, WrongItem, limits};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::path::{Component, Path};
use wayword_core::{DVec3, Heading, ObjectId, SceneId, ViewpointId};

/// Longest path below a folder, bytes.
const MAX_RELATIVE_PATH_BYTES: usize = 512;

/// Whether a path leads to a place below its folder, on every system.
pub(crate) fn is_path_below(path: &str) -> bool {
    !path.is_empty()
        && path.len() <= MAX_RELATIVE_PATH_BYTES
        && !path.contains('\\')
        && Path::new(path).components().all(|part| matches!(part, Component::Normal(_)))
}

/// An object of a dataset file. A reader takes the fields that it knows; the others are kept as unknown fields.
pub(crate) struct DatasetItem<'a> {
    file: &'a Path,
    place: ItemPlace,
    id: Option<String>,
    fields: Map<String, Value>,
}

impl<'a> DatasetItem<'a> {
    pub(crate) fn new(file: &'a Path, place: ItemPlace, value: Value) -> Result<Self, FormatError> {
        let Value::Object(fields) = value else {
            let problem = format!("{place}: expected an object, found {}", describe_value(&value));
            return Err(FormatError::for_document(file, problem, "each item of a dataset is a JSON object"));
        };
        Ok(Self { file, place, id: None, fields })
    }

    /// Sets the id that errors name from here on.
    pub(crate) fn set_id(&mut self, id: &str) {
        self.id = Some(id.to_owned());
    }

    pub(crate) fn file(&self) -> &'a Path {
        self.file
    }

    /// The fields that were not taken, in the order of the file.
    pub(crate) fn into_rest(self) -> Map<String, Value> {
        self.fields
    }

    /// Takes a field that must be there.
    pub(crate) fn take_field(&mut self, field: &str) -> Result<Value, FormatError> {
        let value = self.take_optional(field);
        value.ok_or_else(|| self.wrong_field(field, "it is missing", "add it, because the format requires it"))
    }

    /// Looks at a field without taking it.
    pub(crate) fn peek_field(&self, field: &str) -> Option<&Value> {
        self.fields.get(field)
    }

    /// The names of the fields that were not taken.
    pub(crate) fn field_names(&self) -> impl Iterator<Item = &String> {
        self.fields.keys()
    }

    /// Takes a field that may be missing.
    pub(crate) fn take_optional(&mut self, field: &str) -> Option<Value> {
        self.fields.shift_remove(field)
    }

    /// The error for a field, with the item's file, place and id.
    pub(crate) fn wrong_field(&self, field: &str, problem: impl Into<String>, hint: &'static str) -> FormatError {
        Box::new(WrongItem {
            file: self.file.to_owned(),
            place: self.place,
            id: self.id.clone(),
            field: field.to_owned(),
            problem: problem.into(),
            hint,
        })
        .into()
    }

    /// The error for a field with a value of a wrong kind: "expected `what`, found ...".
    pub(crate) fn expected_kind(&self, field: &str, what: &str, found: &Value, hint: &'static str) -> FormatError {
        self.wrong_field(field, format!("expected {what}, found {}", describe_value(found)), hint)
    }

    pub(crate) fn checked_text<'v>(&self, field: &str, value: &'v Value) -> Result<&'v str, FormatError> {
        value.as_str().ok_or_else(|| self.expected_kind(field, "a text", value, "put it in quotes"))
    }

    /// The name of a path or an item: a whole number, or a text that is safe as a file name.
    pub(crate) fn checked_name(&self, field: &str, value: &Value) -> Result<String, FormatError> {
        const WHAT: &str =
            "a whole number, or a text without path separators and control characters of at most 128 bytes";
        let name =
            name_of(value).filter(|name| SceneId::new(name.as_str()).is_ok() && name.len() <= limits::MAX_NAME_BYTES);
        name.ok_or_else(|| self.expected_kind(field, WHAT, value, "change it, because names become file names later"))
    }

    pub(crate) fn checked_scene(&self, field: &str, value: &Value) -> Result<SceneId, FormatError> {
        let text = self.checked_text(field, value)?;
        SceneId::new(text).map_err(|error| self.wrong_field(field, error.to_string(), "give the scan's bare name"))
    }

    pub(crate) fn checked_object(&self, field: &str, value: &Value) -> Result<ObjectId, FormatError> {
        let name = self.checked_name(field, value)?;
        ObjectId::new(name).map_err(|error| self.wrong_field(field, error.to_string(), "give the object's bare id"))
    }

    pub(crate) fn checked_number(&self, field: &str, value: &Value) -> Result<f64, FormatError> {
        let number = value.as_f64().filter(|number| number.is_finite());
        number.ok_or_else(|| self.expected_kind(field, "a finite number", value, "write it as a JSON number"))
    }

    pub(crate) fn checked_heading(&self, field: &str, value: &Value) -> Result<Heading, FormatError> {
        let rad = self.checked_number(field, value)?;
        Heading::new(rad).map_err(|error| self.wrong_field(field, error.to_string(), "write it in radians"))
    }

    /// Three numbers.
    pub(crate) fn checked_position(&self, field: &str, value: &Value) -> Result<DVec3, FormatError> {
        let [x, y, z] = self.checked_numbers(field, value)?;
        Ok(DVec3::new(x, y, z))
    }

    /// `N` finite numbers.
    pub(crate) fn checked_numbers<const N: usize>(&self, field: &str, value: &Value) -> Result<[f64; N], FormatError> {
        let list = self.checked_list(field, value, N)?;
        let numbers =
            list.iter().enumerate().map(|(index, value)| self.checked_number(&format!("{field}[{index}]"), value));
        let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
        <[f64; N]>::try_from(numbers).map_err(|_| {
            self.wrong_field(field, format!("expected {N} numbers, found {}", list.len()), "write all of them")
        })
    }

    /// Any type that serde can read.
    pub(crate) fn parse_value<T: DeserializeOwned>(&self, field: &str, value: Value) -> Result<T, FormatError> {
        serde_json::from_value(value)
            .map_err(|error| self.wrong_field(field, error.to_string(), "docs/FORMATS.md says what it should be"))
    }

    /// A list of at most `max_entries`.
    pub(crate) fn checked_list<'v>(
        &self,
        field: &str,
        value: &'v Value,
        max_entries: usize,
    ) -> Result<&'v [Value], FormatError> {
        let hint = || match value {
            Value::String(text) if text.starts_with('[') => "write it as JSON, without the quotes",
            Value::Object(_) => "write the list itself",
            _ => "put it in brackets",
        };
        let list = value.as_array().ok_or_else(|| self.expected_kind(field, "a list", value, hint()))?;
        if list.len() > max_entries {
            let problem = format!("it has {} entries, more than {max_entries}", list.len());
            return Err(self.wrong_field(field, problem, "split it: no known dataset has that many"));
        }
        Ok(list)
    }

    /// The nodes of a path: at least one.
    pub(crate) fn checked_viewpoints(&self, field: &str, value: &Value) -> Result<Vec<ViewpointId>, FormatError> {
        let list = self.checked_list(field, value, limits::MAX_PATH_NODES)?;
        if list.is_empty() {
            return Err(self.wrong_field(field, "it is empty", "add at least one viewpoint"));
        }
        let viewpoint = |(index, value)| {
            let field = format!("{field}[{index}]");
            ViewpointId::new(self.checked_text(&field, value)?)
                .map_err(|error| self.wrong_field(&field, error.to_string(), "give the viewpoint's bare name"))
        };
        list.iter().enumerate().map(viewpoint).collect()
    }

    pub(crate) fn checked_instruction(&self, field: &str, value: &Value) -> Result<String, FormatError> {
        let text = self.checked_text(field, value)?;
        if text.len() > limits::MAX_INSTRUCTION_BYTES {
            let problem = format!("it has {} bytes, more than {}", text.len(), limits::MAX_INSTRUCTION_BYTES);
            return Err(self.wrong_field(field, problem, "shorten it: an instruction is a few sentences"));
        }
        Ok(text.to_owned())
    }

    pub(crate) fn checked_instructions(&self, field: &str, value: &Value) -> Result<Vec<String>, FormatError> {
        let list = self.checked_list(field, value, limits::MAX_INSTRUCTIONS)?;
        list.iter()
            .enumerate()
            .map(|(index, value)| self.checked_instruction(&format!("{field}[{index}]"), value))
            .collect()
    }
}

/// A name as text, where the value is a name. Datasets write some names as numbers.
pub(crate) fn name_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) if number.is_u64() || number.is_i64() => Some(number.to_string()),
        _ => None,
    }
}

/// A name as datasets write it: `7` for "7", and a text for any other name ("007", "house2").
pub(crate) fn value_of(name: &str) -> Value {
    match name.parse::<u64>() {
        Ok(number) if number.to_string() == name => number.into(),
        _ => name.into(),
    }
}

/// A value in short, for an error: texts are cut at 40 characters.
fn describe_value(value: &Value) -> String {
    match value {
        Value::Array(list) => format!("a list of {}", list.len()),
        Value::Object(_) => "an object".to_owned(),
        Value::String(text) if text.chars().count() > 40 => {
            format!("{:?} (cut)", text.chars().take(40).collect::<String>())
        }
        Value::String(text) => format!("{text:?}"),
        other => other.to_string(),
    }
}
