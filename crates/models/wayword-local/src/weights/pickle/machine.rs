//! Reads a pickle step by step.
//!
//! A pickle is a list of steps for a stack machine. Each step begins with one byte: `K` pushes a number, `X` a text,
//! `t` makes a tuple of everything since the last mark, `R` calls a function with a tuple, and so on. Only the steps
//! that PyTorch writes into checkpoints are understood.

use super::{PickleCallable, PickleTuple, PickleValue, TensorLocation, TensorStorage};
use std::{collections::BTreeMap, rc::Rc};

/// The most steps of a pickle, each of which makes at most one value, so that a small file cannot fill the memory.
const MAX_PICKLE_STEPS: usize = 4 << 20;

/// The deepest nesting of tuples; deeper ones are refused.
const MAX_TUPLE_DEPTH: usize = 16;

/// The state of the stack machine: the bytes that are left, the stack, the marks on it, and the values that got a
/// number to be used again (`memo`).
#[derive(Default)]
pub(super) struct PickleMachine<'a> {
    rest: &'a [u8],
    stack: Vec<PickleValue>,
    marks: Vec<usize>,
    memo: BTreeMap<u32, PickleValue>,
    /// The tables that the pickle makes. Values refer to them by their index.
    pub(super) tables: Vec<BTreeMap<Rc<str>, PickleValue>>,
    /// The number of steps so far.
    step_count: usize,
}

impl<'a> PickleMachine<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, ..Self::default() }
    }

    /// Performs the steps until the first one below, and returns the value on top of the stack.
    ///
    /// The steps below have these names in Python's `pickletools`, in their order: STOP, PROTO, MARK, NONE with NEWTRUE
    /// and NEWFALSE, BINFLOAT, EMPTY_DICT, EMPTY_LIST, EMPTY_TUPLE, BININT1, BININT2, BININT, LONG1, BINUNICODE,
    /// SHORT_BINSTRING, BINPUT, LONG_BINPUT, BINGET, LONG_BINGET, GLOBAL, TUPLE, TUPLE1 to TUPLE3, BINPERSID, REDUCE,
    /// BUILD, APPEND, APPENDS, SETITEM, SETITEMS.
    pub(super) fn run(&mut self) -> Result<PickleValue, String> {
        loop {
            let step = self.take_byte()?;
            self.step_count += 1;
            if self.step_count > MAX_PICKLE_STEPS {
                return Err(format!("it has more than {MAX_PICKLE_STEPS} values"));
            }
            match step {
                b'.' => return self.pop_value(),
                0x80 => drop(self.take_bytes(1)?),
                b'(' => self.marks.push(self.stack.len()),
                b'N' | 0x88 | 0x89 => self.stack.push(PickleValue::Other),
                b'G' => self.skip_bytes(8)?,
                b'}' => self.push_table(),
                b']' => self.stack.push(PickleValue::List),
                b')' => self.push_tuple(Vec::new())?,
                b'K' => self.push_whole(1)?,
                b'M' => self.push_whole(2)?,
                b'J' => self.push_whole(4)?,
                0x8a => self.push_long()?,
                b'X' => self.push_text(4)?,
                b'U' => self.push_text(1)?,
                b'q' => self.memorise_top(1)?,
                b'r' => self.memorise_top(4)?,
                b'h' => self.recall_value(1)?,
                b'j' => self.recall_value(4)?,
                b'c' => self.push_known_name()?,
                b't' => self.push_marked_tuple()?,
                0x85..=0x87 => self.push_short_tuple(usize::from(step - 0x84))?,
                b'Q' => self.push_storage()?,
                b'R' => self.call_name()?,
                b'b' => drop(self.pop_value()?),
                b'a' => drop(self.pop_value()?),
                b'e' => drop(self.take_since_mark()?),
                b's' => self.set_item()?,
                b'u' => self.set_items()?,
                other => return Err(format!("step {other:#04x} is not one of a checkpoint")),
            }
        }
    }

    fn take_bytes(&mut self, count: usize) -> Result<&[u8], String> {
        let Some((taken, rest)) = self.rest.split_at_checked(count) else { return Err("it is cut off".to_owned()) };
        self.rest = rest;
        Ok(taken)
    }

    fn take_byte(&mut self) -> Result<u8, String> {
        let (byte, rest) = self.rest.split_first().ok_or("it is cut off")?;
        self.rest = rest;
        Ok(*byte)
    }

    /// Reads an unsigned number of up to four bytes, the lowest byte first.
    fn take_number(&mut self, bytes: usize) -> Result<u32, String> {
        Ok(self.take_bytes(bytes)?.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
    }

    /// Takes the value on top of the stack, if it is above the last mark.
    fn pop_value(&mut self) -> Result<PickleValue, String> {
        let floor = self.marks.last().copied().unwrap_or(0);
        let value = if self.stack.len() > floor { self.stack.pop() } else { None };
        value.ok_or_else(|| "it takes a value that is not there".to_owned())
    }

    /// Takes all values since the last mark, and the mark.
    fn take_since_mark(&mut self) -> Result<Vec<PickleValue>, String> {
        let mark = self.marks.pop().ok_or("it ends a list that did not begin")?;
        Ok(self.stack.split_off(mark.min(self.stack.len())))
    }

    /// Skips the bytes of a value that is not needed, and pushes a placeholder for it.
    fn skip_bytes(&mut self, bytes: usize) -> Result<(), String> {
        self.take_bytes(bytes)?;
        self.stack.push(PickleValue::Other);
        Ok(())
    }

    fn push_table(&mut self) {
        self.stack.push(PickleValue::Table(self.tables.len()));
        self.tables.push(BTreeMap::new());
    }

    /// Pushes a whole number. Only a number of four bytes has a sign.
    fn push_whole(&mut self, bytes: usize) -> Result<(), String> {
        let number = self.take_number(bytes)?;
        self.stack.push(PickleValue::Whole(if bytes == 4 {
            i64::from(number.cast_signed())
        } else {
            i64::from(number)
        }));
        Ok(())
    }

    /// Pushes a whole number of any length, which comes first. Its sign is in the highest bit.
    fn push_long(&mut self) -> Result<(), String> {
        let count = usize::from(self.take_byte()?);
        let bytes = self.take_bytes(count)?;
        let sign = if bytes.last().is_some_and(|byte| byte & 0x80 != 0) { -1 } else { 0 };
        // A longer number cannot be a size, so its value is not needed.
        let number = (count <= 8).then(|| bytes.iter().rev().fold(sign, |number, &byte| number << 8 | i64::from(byte)));
        self.stack.push(number.map_or(PickleValue::Other, PickleValue::Whole));
        Ok(())
    }

    /// Pushes a text. Its length comes first, in a number of `bytes` bytes.
    fn push_text(&mut self, bytes: usize) -> Result<(), String> {
        let length = self.take_number(bytes)? as usize;
        let text = std::str::from_utf8(self.take_bytes(length)?).map_err(|_| "a text is not UTF-8")?;
        let text = PickleValue::Text(text.into());
        self.stack.push(text);
        Ok(())
    }

    /// Keeps the value on top of the stack under a number of `bytes` bytes.
    fn memorise_top(&mut self, bytes: usize) -> Result<(), String> {
        let number = self.take_number(bytes)?;
        let value = self.stack.last().cloned().ok_or("it keeps a value that is not there")?;
        self.memo.insert(number, value);
        Ok(())
    }

    /// Pushes the value that was kept under a number of `bytes` bytes.
    fn recall_value(&mut self, bytes: usize) -> Result<(), String> {
        let number = self.take_number(bytes)?;
        let value = self.memo.get(&number).cloned().ok_or("it recalls a value that was not kept")?;
        self.stack.push(value);
        Ok(())
    }

    fn take_line(&mut self) -> Result<String, String> {
        let end = self.rest.iter().position(|&byte| byte == b'\n').ok_or("it is cut off")?;
        let line = String::from_utf8_lossy(self.take_bytes(end)?).into_owned();
        self.take_bytes(1)?;
        Ok(line)
    }

    /// Pushes a function or type by its name. Names that are not known are an error.
    fn push_known_name(&mut self) -> Result<(), String> {
        let (module, name) = (self.take_line()?, self.take_line()?);
        let known = match (module.as_str(), name.as_str()) {
            ("collections", "OrderedDict") => PickleCallable::OrderedDict,
            ("torch", "FloatStorage") => PickleCallable::Floats,
            ("torch", "LongStorage") => PickleCallable::Longs,
            ("torch._utils", "_rebuild_tensor_v2") => PickleCallable::Rebuild,
            _ => {
                let name: String = format!("{module}.{name}").chars().take(100).collect();
                return Err(format!("it calls {name:?}, which no checkpoint of this kind does"));
            }
        };
        self.stack.push(PickleValue::Known(known));
        Ok(())
    }

    fn push_marked_tuple(&mut self) -> Result<(), String> {
        let values = self.take_since_mark()?;
        self.push_tuple(values)
    }

    fn push_tuple(&mut self, values: Vec<PickleValue>) -> Result<(), String> {
        let depth = |value: &PickleValue| if let PickleValue::Tuple(tuple) = value { tuple.depth + 1 } else { 0 };
        let depth = values.iter().map(depth).max().unwrap_or(0);
        if depth > MAX_TUPLE_DEPTH {
            return Err(format!("its tuples lie deeper than {MAX_TUPLE_DEPTH} in each other"));
        }
        self.stack.push(PickleValue::Tuple(Rc::new(PickleTuple { values, depth })));
        Ok(())
    }

    /// Pushes a tuple of the topmost values.
    fn push_short_tuple(&mut self, length: usize) -> Result<(), String> {
        let mut values = (0..length).map(|_| self.pop_value()).collect::<Result<Vec<_>, _>>()?;
        values.reverse();
        self.push_tuple(values)
    }

    /// Replaces the tuple ("storage", type, key, device, count) on the stack by a storage.
    fn push_storage(&mut self) -> Result<(), String> {
        let PickleValue::Tuple(parts) = self.pop_value()? else { return Err("a storage is not described".to_owned()) };
        let [
            PickleValue::Text(_),
            PickleValue::Known(kind),
            PickleValue::Text(key),
            PickleValue::Text(_),
            PickleValue::Whole(count),
        ] = parts.values.as_slice()
        else {
            return Err("a storage is not described as PyTorch does".to_owned());
        };
        let floats = match kind {
            PickleCallable::Floats => true,
            PickleCallable::Longs => false,
            _ => return Err("a storage has no type of numbers".to_owned()),
        };
        let count = u64::try_from(*count).map_err(|_| "a storage has less than no numbers")?;
        self.stack.push(PickleValue::Storage(Rc::new(TensorStorage { key: Rc::clone(key), floats, count })));
        Ok(())
    }

    /// Replaces a function and the tuple of its arguments on the stack by its result.
    fn call_name(&mut self) -> Result<(), String> {
        let (arguments, function) = (self.pop_value()?, self.pop_value()?);
        match (function, arguments) {
            (PickleValue::Known(PickleCallable::OrderedDict), PickleValue::Tuple(arguments))
                if arguments.values.is_empty() =>
            {
                self.push_table();
            }
            (PickleValue::Known(PickleCallable::Rebuild), PickleValue::Tuple(arguments)) => {
                let place = tensor_location(&arguments.values).ok_or("a tensor is not described as PyTorch does")?;
                self.stack.push(PickleValue::Tensor(Rc::new(place)));
            }
            _ => return Err("it calls something that is not to be called so".to_owned()),
        }
        Ok(())
    }

    fn set_item(&mut self) -> Result<(), String> {
        let (value, key) = (self.pop_value()?, self.pop_value()?);
        self.set_pairs(vec![key, value])
    }

    fn set_items(&mut self) -> Result<(), String> {
        let pairs = self.take_since_mark()?;
        self.set_pairs(pairs)
    }

    /// Puts pairs of key and value into the table on top of the stack. Pairs with a key that is no text are dropped.
    fn set_pairs(&mut self, pairs: Vec<PickleValue>) -> Result<(), String> {
        let Some(PickleValue::Table(table)) = self.stack.last() else {
            return Err("it fills what is no table".to_owned());
        };
        let Some(table) = self.tables.get_mut(*table) else {
            return Err("it fills a table that is not there".to_owned());
        };
        let mut pairs = pairs.into_iter();
        while let (Some(key), Some(value)) = (pairs.next(), pairs.next()) {
            if let PickleValue::Text(key) = key {
                table.insert(key, value);
            }
        }
        Ok(())
    }
}

/// Reads the location of a tensor from the arguments of its constructor: (storage, offset, shape, strides, ..).
fn tensor_location(arguments: &[PickleValue]) -> Option<TensorLocation> {
    let [
        PickleValue::Storage(storage),
        PickleValue::Whole(offset),
        PickleValue::Tuple(shape),
        PickleValue::Tuple(strides),
        ..,
    ] = arguments
    else {
        return None;
    };
    let lengths = |values: &[PickleValue]| {
        let length = |value: &PickleValue| match value {
            PickleValue::Whole(length) => usize::try_from(*length).ok(),
            _ => None,
        };
        values.iter().map(length).collect::<Option<Vec<usize>>>()
    };
    let (shape, strides) = (lengths(&shape.values)?, lengths(&strides.values)?);
    let offset = u64::try_from(*offset).ok()?;
    (shape.len() == strides.len()).then(|| TensorLocation { storage: Rc::clone(storage), offset, shape, strides })
}
