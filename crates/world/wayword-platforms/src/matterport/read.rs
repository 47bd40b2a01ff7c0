//! Reads pictures and values of JSON files that come from outside, and says what is wrong with them.

use serde_json::Value;
use std::path::Path;
use wayword_core::{Image, PlatformError};
use wayword_world::files;

pub(crate) use wayword_world::files::{bytes_if_there, json_if_there, text_if_there, wrong};

/// Largest picture file, bytes.
const MAX_PICTURE_BYTES: u64 = 32 << 20;
/// What to do about a broken picture.
pub(crate) const PICTURE_HINT: &str = "get the picture again from Matterport3D, or move it away to use only labels";

/// Largest absolute value of a coordinate in a building, metres.
const MAX_COORDINATE_M: f64 = 1e6;

/// Decodes a JPEG or PNG file of limited size.
///
/// # Errors
/// If it is missing, too large, or not a picture.
pub(crate) fn picture(file: &Path) -> Result<Image, PlatformError> {
    let wrong = |reason: String| wrong(file, reason, PICTURE_HINT);
    let bytes = bytes_if_there(file, MAX_PICTURE_BYTES, PICTURE_HINT)?
        .ok_or_else(|| wrong("is missing from its set of pictures".into()))?;
    files::picture(&bytes).map_err(wrong)
}

/// A finite coordinate of plausible size, or a text that says what is wrong with it.
pub(crate) fn coordinate(number: f64) -> Result<f64, String> {
    if number.is_finite() && number.abs() <= MAX_COORDINATE_M {
        Ok(number)
    } else {
        Err(format!("{number} is not a plausible coordinate"))
    }
}

/// A field of an item, or a text that says that it is missing.
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
