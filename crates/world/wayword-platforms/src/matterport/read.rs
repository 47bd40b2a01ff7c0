//! Files from outside, read with a bound, and the words for what is wrong with them.

use serde_json::Value;
use std::{
    fs::File,
    io::{ErrorKind, Read},
    path::Path,
};
use wayword_core::PlatformError;

/// Numbers beyond this are no place in a building, metres.
const MAX_COORDINATE_M: f64 = 1e6;

/// An error about a file.
pub(crate) fn wrong(file: &Path, reason: impl Into<String>, hint: &'static str) -> PlatformError {
    PlatformError::File { file: file.to_owned(), reason: reason.into(), hint }
}

/// The bytes of a file, at most `max_bytes` of them; `None` where there is no such file.
pub(crate) fn bytes_if_there(
    file: &Path,
    max_bytes: u64,
    hint: &'static str,
) -> Result<Option<Vec<u8>>, PlatformError> {
    let opened = match File::open(file) {
        Ok(opened) => opened,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(wrong(file, error.to_string(), hint)),
    };
    let mut bytes = Vec::new();
    opened.take(max_bytes + 1).read_to_end(&mut bytes).map_err(|error| wrong(file, error.to_string(), hint))?;
    if bytes.len() as u64 > max_bytes {
        return Err(wrong(file, format!("has more than {max_bytes} bytes, which no such file has"), hint));
    }
    Ok(Some(bytes))
}

/// The text of a file, at most `max_bytes` of it; `None` where there is no such file.
pub(crate) fn text_if_there(file: &Path, max_bytes: u64, hint: &'static str) -> Result<Option<String>, PlatformError> {
    let Some(bytes) = bytes_if_there(file, max_bytes, hint)? else {
        return Ok(None);
    };
    String::from_utf8(bytes).map(Some).map_err(|_| wrong(file, "is not text in UTF-8", hint))
}

/// A finite coordinate of plausible size, or the words for what is wrong with it.
pub(crate) fn coordinate(number: f64) -> Result<f64, String> {
    if number.is_finite() && number.abs() <= MAX_COORDINATE_M {
        Ok(number)
    } else {
        Err(format!("{number} is no place in a building"))
    }
}

/// A field of an item, or the words for its absence.
pub(crate) fn field<'a>(item: &'a Value, name: &str) -> Result<&'a Value, String> {
    item.get(name).ok_or_else(|| format!("field `{name}` is missing"))
}

/// A list in a field of an item.
pub(crate) fn list<'a>(item: &'a Value, name: &str) -> Result<&'a [Value], String> {
    let found = field(item, name)?;
    found.as_array().map(Vec::as_slice).ok_or_else(|| format!("field `{name}` is {}, not a list", kind(found)))
}

/// A text in a field of an item.
pub(crate) fn text<'a>(item: &'a Value, name: &str) -> Result<&'a str, String> {
    let found = field(item, name)?;
    found.as_str().ok_or_else(|| format!("field `{name}` is {}, not a text", kind(found)))
}

/// A flag.
pub(crate) fn flag(value: &Value, name: &str) -> Result<bool, String> {
    value.as_bool().ok_or_else(|| format!("field `{name}` holds {}, not true or false", kind(value)))
}

/// A coordinate.
pub(crate) fn number(value: &Value, name: &str) -> Result<f64, String> {
    let found = value.as_f64().ok_or_else(|| format!("field `{name}` holds {}, not a number", kind(value)))?;
    coordinate(found).map_err(|reason| format!("field `{name}`: {reason}"))
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}
