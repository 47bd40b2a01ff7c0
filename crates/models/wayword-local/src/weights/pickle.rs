//! Reads the pickle of a PyTorch checkpoint as data: tables, lists, texts, numbers, and where tensors lie.
//!
//! Nothing is executed. Of the names that a pickle could call, four are known, and any other ends the reading.

mod machine;

use machine::Machine;
use std::{collections::BTreeMap, rc::Rc};

/// A value of a pickle. Tables and lists are kept apart from it, because a pickle fills them after it has named them.
#[derive(Debug, Clone)]
pub(super) enum Value {
    /// Anything that no tensor depends on.
    Other,
    Whole(i64),
    Text(Rc<str>),
    Tuple(Rc<Tuple>),
    /// A list. What lists hold is not needed.
    List,
    /// A table, by its number.
    Table(usize),
    Known(Known),
    Storage(Rc<Storage>),
    Tensor(Rc<Place>),
}

/// Values in a row.
#[derive(Debug)]
pub(super) struct Tuple {
    values: Vec<Value>,
    /// How deep tuples lie in tuples. It is bounded, because they are dropped one within the other.
    depth: usize,
}

/// The names that a checkpoint may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Known {
    OrderedDict,
    Floats,
    Longs,
    Rebuild,
}

/// A run of numbers in a file of the archive.
#[derive(Debug)]
pub(super) struct Storage {
    /// The name of the file.
    pub(super) key: Rc<str>,
    /// Whether they are floats of 32 bits, not whole numbers of 64.
    pub(super) floats: bool,
    pub(super) count: u64,
}

/// Where a tensor lies.
#[derive(Debug)]
pub(super) struct Place {
    pub(super) storage: Rc<Storage>,
    /// In numbers.
    pub(super) offset: u64,
    pub(super) shape: Vec<usize>,
    pub(super) strides: Vec<usize>,
}

/// The tables of a pickle, and what it describes.
pub(super) struct Pickle {
    tables: Vec<BTreeMap<Rc<str>, Value>>,
    top: Value,
}

impl Pickle {
    /// Reads a pickle.
    ///
    /// # Errors
    /// Says what is wrong with it.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut machine = Machine::new(bytes);
        let top = machine.run()?;
        Ok(Self { tables: machine.tables, top })
    }

    /// The tensors of the table under a key of the top table, by their names.
    pub(super) fn tensors(&self, key: &str) -> Result<impl Iterator<Item = (Rc<str>, Rc<Place>)>, String> {
        let Value::Table(top) = self.top else { return Err("it does not hold a table".to_owned()) };
        let model = match self.tables.get(top).and_then(|top| top.get(key)) {
            Some(Value::Table(model)) => self.tables.get(*model),
            _ => None,
        };
        let model = model.ok_or_else(|| format!("it has no table {key:?}"))?;
        Ok(model.iter().filter_map(|(name, value)| match value {
            Value::Tensor(place) => Some((Rc::clone(name), Rc::clone(place))),
            _ => None,
        }))
    }
}
