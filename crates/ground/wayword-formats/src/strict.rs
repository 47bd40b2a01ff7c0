//! JSON as `serde_json` reads it, but a key given twice is refused, the size of a value is bounded, and an error knows the
//! way into the value at which it happened.

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::{
    cell::{Cell, RefCell},
    fmt::{self, Write as _},
};

/// Where the parser is within the value that it reads, and how many more parts that value may have.
pub(crate) struct Trail {
    steps: RefCell<Vec<Step>>,
    values_left: Cell<usize>,
}

enum Step {
    Key(String),
    Index(usize),
}

impl Trail {
    pub(crate) fn new(values: usize) -> Self {
        Self { steps: RefCell::default(), values_left: Cell::new(values) }
    }

    /// Begins the next value.
    pub(crate) fn restart(&self, values: usize) {
        self.steps.borrow_mut().clear();
        self.values_left.set(values);
    }

    /// The way into the value, as `path[3]`; empty at its root.
    pub(crate) fn field(&self) -> String {
        let mut field = String::new();
        for step in self.steps.borrow().iter() {
            let dot = if field.is_empty() { "" } else { "." };
            // Writing to a String cannot fail.
            let _ = match step {
                // A hostile key may be as long as its file.
                Step::Key(key) => write!(field, "{dot}{key:.40}"),
                Step::Index(index) => write!(field, "[{index}]"),
            };
        }
        field
    }

    /// Reads a part; the step to it is taken back only where that went well, so that a failure leaves the way behind.
    fn within<T, E>(&self, step: Step, read: impl FnOnce() -> Result<T, E>) -> Result<T, E> {
        self.steps.borrow_mut().push(step);
        let value = read()?;
        self.steps.borrow_mut().pop();
        Ok(value)
    }

    fn count<E: Error>(&self) -> Result<(), E> {
        let left = self.values_left.get().checked_sub(1).ok_or_else(|| E::custom("it has too many parts"))?;
        self.values_left.set(left);
        Ok(())
    }
}

/// Reads one value.
#[derive(Clone, Copy)]
pub(crate) struct Strict<'t>(pub(crate) &'t Trail);

impl<'de> DeserializeSeed<'de> for Strict<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        self.0.count()?;
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Strict<'_> {
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
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = self.0.within(Step::Index(values.len()), || list.next_element_seed(self))? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(key) = entries.next_key::<String>()? {
            let value = self.0.within(Step::Key(key.clone()), || {
                if map.contains_key(&key) {
                    Err(A::Error::custom("it is given twice"))
                } else {
                    entries.next_value_seed(self)
                }
            })?;
            map.insert(key, value);
        }
        Ok(Value::Object(map))
    }
}
