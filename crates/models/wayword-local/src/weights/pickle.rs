//! Reads the pickle of a PyTorch checkpoint as data: tables, lists, texts, numbers, and the locations of tensors.
//!
//! A pickle is a program for a small stack machine, and Python lets it call any function. Here only four names are
//! known, and they are translated into data. Any other name ends the reading with an error. So a malicious file cannot
//! execute code.

mod machine;

use machine::PickleMachine;
use std::{collections::BTreeMap, rc::Rc};

/// A value of a pickle. A table (Python's `dict`) is referred to by its number, because a pickle fills it after it has put it on the
/// stack.
#[derive(Debug, Clone)]
pub(super) enum PickleValue {
    /// A value that no tensor depends on, such as a float or a boolean.
    Other,
    /// A whole number.
    Whole(i64),
    Text(Rc<str>),
    Tuple(Rc<PickleTuple>),
    /// A list. Its values are not kept, because no tensor depends on them.
    List,
    /// A table, by its number.
    Table(usize),
    /// A function or type by its name.
    Known(PickleCallable),
    /// The numbers of one or more tensors.
    Storage(Rc<TensorStorage>),
    /// A tensor: a part of a storage.
    Tensor(Rc<TensorLocation>),
}

/// Values in a row.
#[derive(Debug)]
pub(super) struct PickleTuple {
    values: Vec<PickleValue>,
    /// The depth of nested tuples. It is bounded, because dropping them is recursive, and could exhaust the stack.
    depth: usize,
}

/// The functions and types that a checkpoint may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PickleCallable {
    /// Makes a table.
    OrderedDict,
    /// The type of a storage of floats of 32 bits.
    Floats,
    /// The type of a storage of whole numbers of 64 bits.
    Longs,
    /// Makes a tensor of a part of a storage.
    Rebuild,
}

/// A run of numbers in a file of the archive.
#[derive(Debug)]
pub(super) struct TensorStorage {
    /// The name of the file.
    pub(super) key: Rc<str>,
    /// Whether the numbers are floats of 32 bits. Otherwise they are whole numbers of 64 bits.
    pub(super) floats: bool,
    /// How many numbers there are.
    pub(super) count: u64,
}

/// The location of a tensor: a part of a storage.
#[derive(Debug)]
pub(super) struct TensorLocation {
    pub(super) storage: Rc<TensorStorage>,
    /// The numbers of the storage before the tensor.
    pub(super) offset: u64,
    pub(super) shape: Vec<usize>,
    pub(super) strides: Vec<usize>,
}

/// A pickle after it is read: its tables, and its top value, which is usually one of them.
pub(super) struct CheckpointPickle {
    tables: Vec<BTreeMap<Rc<str>, PickleValue>>,
    top: PickleValue,
}

impl CheckpointPickle {
    /// Reads a pickle.
    ///
    /// # Errors
    /// The problem with the pickle.
    pub(super) fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        let mut machine = PickleMachine::new(bytes);
        let top = machine.run()?;
        Ok(Self { tables: machine.tables, top })
    }

    /// The tensors, with their names, of the table that the top table has under `key`.
    pub(super) fn tensors_under(
        &self,
        key: &str,
    ) -> Result<impl Iterator<Item = (Rc<str>, Rc<TensorLocation>)>, String> {
        let PickleValue::Table(top) = self.top else { return Err("it does not hold a table".to_owned()) };
        let model = match self.tables.get(top).and_then(|top| top.get(key)) {
            Some(PickleValue::Table(model)) => self.tables.get(*model),
            _ => None,
        };
        let model = model.ok_or_else(|| format!("it has no table {key:?}"))?;
        Ok(model.iter().filter_map(|(name, value)| match value {
            PickleValue::Tensor(place) => Some((Rc::clone(name), Rc::clone(place))),
            _ => None,
        }))
    }
}
