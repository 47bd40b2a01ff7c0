//! Takes values out of JSON that comes from outside. Every error is a phrase that names the field and the problem, for a
//! message to the user.

use serde_json::Value;

/// Largest absolute value of a coordinate in a building, metres.
const MAX_COORDINATE_M: f64 = 1e6;

/// Returns the coordinate if it is finite and of plausible size.
///
/// # Errors
/// When it is not finite, or too large for a building.
pub fn check_coordinate(number: f64) -> Result<f64, String> {
    if number.is_finite() && number.abs() <= MAX_COORDINATE_M {
        Ok(number)
    } else {
        Err(format!("{number:e} is not a plausible coordinate"))
    }
}

/// A field of an item.
///
/// # Errors
/// When it is missing.
pub fn required_field<'a>(item: &'a Value, name: &str) -> Result<&'a Value, String> {
    item.get(name).ok_or_else(|| format!("field `{name}` is missing"))
}

/// A list in a field of an item.
///
/// # Errors
/// When it is missing, or no list.
pub fn list_field<'a>(item: &'a Value, name: &str) -> Result<&'a [Value], String> {
    let found = required_field(item, name)?;
    found.as_array().map(Vec::as_slice).ok_or_else(|| format!("field `{name}` is {}, not a list", describe_kind(found)))
}

/// A text in a field of an item.
///
/// # Errors
/// When it is missing, or no text.
pub fn text_field<'a>(item: &'a Value, name: &str) -> Result<&'a str, String> {
    let found = required_field(item, name)?;
    found.as_str().ok_or_else(|| format!("field `{name}` is {}, not a text", describe_kind(found)))
}

/// A value that is true or false. `name` is the field that errors name.
///
/// # Errors
/// When it is neither true nor false.
pub fn read_flag(value: &Value, name: &str) -> Result<bool, String> {
    value.as_bool().ok_or_else(|| format!("field `{name}` holds {}, not true or false", describe_kind(value)))
}

/// A value that is a coordinate, metres. `name` is the field that errors name.
///
/// # Errors
/// When it is no number, or not a plausible coordinate.
pub fn read_coordinate(value: &Value, name: &str) -> Result<f64, String> {
    let found = value.as_f64().ok_or_else(|| format!("field `{name}` holds {}, not a number", describe_kind(value)))?;
    check_coordinate(found).map_err(|reason| format!("field `{name}`: {reason}"))
}

fn describe_kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}
