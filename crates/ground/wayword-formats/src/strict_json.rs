//! JSON as `serde_json` reads it, with three differences: a key that is given twice is refused, the size of a value is
//! bounded, and an error names the field of the value at which it happened.

use crate::limits;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use serde_path_to_error::{Path, Segment, Track};
use std::{
    cell::{Cell, RefCell},
    fmt::{self, Write as _},
};

/// Reads one value. If that fails, the text in its cell becomes the field at which it failed, for example `path[3]`; the
/// text stays empty where the value itself is wrong.
#[derive(Clone, Copy)]
pub(crate) struct StrictJson<'f>(pub(crate) &'f RefCell<String>);

impl<'de> DeserializeSeed<'de> for StrictJson<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        let (mut track, values_left) = (Track::new(), Cell::new(limits::MAX_VALUES_PER_ITEM));
        let bytes_left = Cell::new(limits::MAX_LINE_BYTES);
        let part = StrictPart { values_left: &values_left, bytes_left: &bytes_left, is_twice: false };
        let read = part.deserialize(serde_path_to_error::Deserializer::new(deserializer, &mut track));
        read.inspect_err(|_| *self.0.borrow_mut() = field_path(&track.path()))
    }
}

/// The place of a value in its item, as errors name it: `path[3]`, `info.geodesic_distance`.
fn field_path(path: &Path) -> String {
    let mut field = String::new();
    for segment in path {
        let dot = if field.is_empty() { "" } else { "." };
        // Writing to a String cannot fail.
        let _ = match segment {
            // A hostile key may be as long as its file.
            Segment::Map { key } => write!(field, "{dot}{key:.40}"),
            Segment::Seq { index } => write!(field, "[{index}]"),
            _ => Ok(()),
        };
    }
    field
}

/// Reads a part of a value: the value itself, an entry of a list, or the value of a key.
#[derive(Clone, Copy)]
struct StrictPart<'l> {
    /// How many more JSON values the whole value may have.
    values_left: &'l Cell<usize>,
    /// How many more bytes of text it may have.
    bytes_left: &'l Cell<usize>,
    /// Whether the part is the value of a key that its object had before.
    is_twice: bool,
}

impl StrictPart<'_> {
    /// Counts the bytes of a text towards the limit.
    fn count_bytes<E: Error>(self, text: &str) -> Result<(), E> {
        let left = self.bytes_left.get().checked_sub(text.len());
        self.bytes_left.set(left.ok_or_else(|| E::custom("it has more than 16 MiB of text"))?);
        Ok(())
    }
}

impl<'de> DeserializeSeed<'de> for StrictPart<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        if self.is_twice {
            return Err(D::Error::custom("it is given twice"));
        }
        let left =
            self.values_left.get().checked_sub(1).ok_or_else(|| D::Error::custom("it has more than 200,000 values"))?;
        self.values_left.set(left);
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for StrictPart<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        self.count_bytes(value)?;
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = list.next_element_seed(self)? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            self.count_bytes(&key)?;
            let value = entries.next_value_seed(StrictPart { is_twice: map.contains_key(&key), ..self })?;
            map.insert(key, value);
        }
        Ok(Value::Object(map))
    }
}
