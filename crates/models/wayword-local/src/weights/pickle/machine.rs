//! Reads a pickle step by step.
//!
//! A pickle is a list of steps for a stack machine. Each step begins with one byte: `K` pushes a number, `X` a text,
//! `t` makes a tuple of everything since the last mark, `R` calls a function with a tuple, and so on. Only the steps
//! that PyTorch writes into checkpoints are understood.

use super::{Known, Place, Storage, Tuple, Value};
use std::{collections::BTreeMap, rc::Rc};

/// The most values, so that a small file cannot fill the memory.
const MOST_VALUES: usize = 4 << 20;

/// The deepest nesting of tuples.
const DEEPEST: usize = 16;

/// The state of the stack machine: the bytes that are left, the stack, the marks on it, and the values that got a
/// number to be used again (`memo`).
#[derive(Default)]
pub(super) struct Machine<'a> {
    rest: &'a [u8],
    stack: Vec<Value>,
    marks: Vec<usize>,
    memo: BTreeMap<u32, Value>,
    pub(super) tables: Vec<BTreeMap<Rc<str>, Value>>,
    made: usize,
}

impl<'a> Machine<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, ..Self::default() }
    }

    pub(super) fn run(&mut self) -> Result<Value, String> {
        loop {
            let step = self.byte()?;
            self.made += 1;
            if self.made > MOST_VALUES {
                return Err(format!("it has more than {MOST_VALUES} values"));
            }
            match step {
                b'.' => return self.pop(),
                0x80 => drop(self.take(1)?),
                b'(' => self.marks.push(self.stack.len()),
                b'N' | 0x88 | 0x89 => self.stack.push(Value::Other),
                b'G' => self.skip(8)?,
                b'}' => self.table(),
                b']' => self.stack.push(Value::List),
                b')' => self.join(Vec::new())?,
                b'K' => self.whole(1)?,
                b'M' => self.whole(2)?,
                b'J' => self.whole(4)?,
                0x8a => self.long()?,
                b'X' => self.text(4)?,
                b'U' => self.text(1)?,
                b'q' => self.keep(1)?,
                b'r' => self.keep(4)?,
                b'h' => self.recall(1)?,
                b'j' => self.recall(4)?,
                b'c' => self.known()?,
                b't' => self.tuple()?,
                0x85..=0x87 => self.short_tuple(usize::from(step - 0x84))?,
                b'Q' => self.storage()?,
                b'R' => self.call()?,
                b'b' => drop(self.pop()?),
                b'a' => drop(self.pop()?),
                b'e' => drop(self.since_mark()?),
                b's' => self.set_one()?,
                b'u' => self.set_many()?,
                other => return Err(format!("step {other:#04x} is not one of a checkpoint")),
            }
        }
    }

    fn take(&mut self, count: usize) -> Result<&[u8], String> {
        let Some((taken, rest)) = self.rest.split_at_checked(count) else { return Err("it is cut off".to_owned()) };
        self.rest = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// Reads an unsigned number of up to four bytes, the lowest byte first.
    fn number(&mut self, bytes: usize) -> Result<u32, String> {
        Ok(self.take(bytes)?.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte)))
    }

    fn pop(&mut self) -> Result<Value, String> {
        let floor = self.marks.last().copied().unwrap_or(0);
        let value = if self.stack.len() > floor { self.stack.pop() } else { None };
        value.ok_or_else(|| "it takes a value that is not there".to_owned())
    }

    fn since_mark(&mut self) -> Result<Vec<Value>, String> {
        let mark = self.marks.pop().ok_or("it ends a list that did not begin")?;
        Ok(self.stack.split_off(mark.min(self.stack.len())))
    }

    fn skip(&mut self, bytes: usize) -> Result<(), String> {
        self.take(bytes)?;
        self.stack.push(Value::Other);
        Ok(())
    }

    fn table(&mut self) {
        self.stack.push(Value::Table(self.tables.len()));
        self.tables.push(BTreeMap::new());
    }

    /// Pushes a whole number. Only a number of four bytes has a sign.
    fn whole(&mut self, bytes: usize) -> Result<(), String> {
        let number = self.number(bytes)?;
        self.stack.push(Value::Whole(if bytes == 4 { i64::from(number.cast_signed()) } else { i64::from(number) }));
        Ok(())
    }

    fn long(&mut self) -> Result<(), String> {
        let count = usize::from(self.byte()?);
        let bytes = self.take(count)?;
        let sign = if bytes.last().is_some_and(|byte| byte & 0x80 != 0) { -1 } else { 0 };
        // A longer number cannot be a size, so its value is not needed.
        let number = (count <= 8).then(|| bytes.iter().rev().fold(sign, |number, &byte| number << 8 | i64::from(byte)));
        self.stack.push(number.map_or(Value::Other, Value::Whole));
        Ok(())
    }

    fn text(&mut self, bytes: usize) -> Result<(), String> {
        let length = self.number(bytes)? as usize;
        let text = std::str::from_utf8(self.take(length)?).map_err(|_| "a text is not UTF-8")?;
        let text = Value::Text(text.into());
        self.stack.push(text);
        Ok(())
    }

    fn keep(&mut self, bytes: usize) -> Result<(), String> {
        let number = self.number(bytes)?;
        let value = self.stack.last().cloned().ok_or("it keeps a value that is not there")?;
        self.memo.insert(number, value);
        Ok(())
    }

    fn recall(&mut self, bytes: usize) -> Result<(), String> {
        let number = self.number(bytes)?;
        let value = self.memo.get(&number).cloned().ok_or("it recalls a value that was not kept")?;
        self.stack.push(value);
        Ok(())
    }

    fn line(&mut self) -> Result<String, String> {
        let end = self.rest.iter().position(|&byte| byte == b'\n').ok_or("it is cut off")?;
        let line = String::from_utf8_lossy(self.take(end)?).into_owned();
        self.take(1)?;
        Ok(line)
    }

    fn known(&mut self) -> Result<(), String> {
        let (module, name) = (self.line()?, self.line()?);
        let known = match (&module[..], &name[..]) {
            ("collections", "OrderedDict") => Known::OrderedDict,
            ("torch", "FloatStorage") => Known::Floats,
            ("torch", "LongStorage") => Known::Longs,
            ("torch._utils", "_rebuild_tensor_v2") => Known::Rebuild,
            _ => {
                let name: String = format!("{module}.{name}").chars().take(100).collect();
                return Err(format!("it calls {name:?}, which no checkpoint of this kind does"));
            }
        };
        self.stack.push(Value::Known(known));
        Ok(())
    }

    fn tuple(&mut self) -> Result<(), String> {
        let values = self.since_mark()?;
        self.join(values)
    }

    fn join(&mut self, values: Vec<Value>) -> Result<(), String> {
        let depth = |value: &Value| if let Value::Tuple(tuple) = value { tuple.depth + 1 } else { 0 };
        let depth = values.iter().map(depth).max().unwrap_or(0);
        if depth > DEEPEST {
            return Err(format!("its tuples lie deeper than {DEEPEST} in each other"));
        }
        self.stack.push(Value::Tuple(Rc::new(Tuple { values, depth })));
        Ok(())
    }

    fn short_tuple(&mut self, length: usize) -> Result<(), String> {
        let mut values = (0..length).map(|_| self.pop()).collect::<Result<Vec<_>, _>>()?;
        values.reverse();
        self.join(values)
    }

    /// Replaces the tuple ("storage", type, key, device, count) on the stack by a storage.
    fn storage(&mut self) -> Result<(), String> {
        let Value::Tuple(parts) = self.pop()? else { return Err("a storage is not described".to_owned()) };
        let [Value::Text(_), Value::Known(kind), Value::Text(key), Value::Text(_), Value::Whole(count)] =
            &parts.values[..]
        else {
            return Err("a storage is not described as PyTorch does".to_owned());
        };
        let floats = match kind {
            Known::Floats => true,
            Known::Longs => false,
            _ => return Err("a storage has no type of numbers".to_owned()),
        };
        let count = u64::try_from(*count).map_err(|_| "a storage has less than no numbers")?;
        self.stack.push(Value::Storage(Rc::new(Storage { key: Rc::clone(key), floats, count })));
        Ok(())
    }

    fn call(&mut self) -> Result<(), String> {
        let (given, called) = (self.pop()?, self.pop()?);
        match (called, given) {
            (Value::Known(Known::OrderedDict), Value::Tuple(given)) if given.values.is_empty() => self.table(),
            (Value::Known(Known::Rebuild), Value::Tuple(given)) => {
                let place = place(&given.values).ok_or("a tensor is not described as PyTorch does")?;
                self.stack.push(Value::Tensor(Rc::new(place)));
            }
            _ => return Err("it calls something that is not to be called so".to_owned()),
        }
        Ok(())
    }

    fn set_one(&mut self) -> Result<(), String> {
        let (value, key) = (self.pop()?, self.pop()?);
        self.set(vec![key, value])
    }

    fn set_many(&mut self) -> Result<(), String> {
        let pairs = self.since_mark()?;
        self.set(pairs)
    }

    /// Puts pairs of key and value into the table on top of the stack. Pairs with a key that is no text are dropped.
    fn set(&mut self, pairs: Vec<Value>) -> Result<(), String> {
        let Some(Value::Table(table)) = self.stack.last() else { return Err("it fills what is no table".to_owned()) };
        let Some(table) = self.tables.get_mut(*table) else {
            return Err("it fills a table that is not there".to_owned());
        };
        let mut pairs = pairs.into_iter();
        while let (Some(key), Some(value)) = (pairs.next(), pairs.next()) {
            if let Value::Text(key) = key {
                table.insert(key, value);
            }
        }
        Ok(())
    }
}

/// Reads the location of a tensor from the arguments of its constructor: (storage, offset, shape, strides, ..).
fn place(given: &[Value]) -> Option<Place> {
    let [Value::Storage(storage), Value::Whole(offset), Value::Tuple(shape), Value::Tuple(strides), ..] = given else {
        return None;
    };
    let lengths = |values: &[Value]| {
        let length = |value: &Value| match value {
            Value::Whole(length) => usize::try_from(*length).ok(),
            _ => None,
        };
        values.iter().map(length).collect::<Option<Vec<usize>>>()
    };
    let (shape, strides) = (lengths(&shape.values)?, lengths(&strides.values)?);
    let offset = u64::try_from(*offset).ok()?;
    (shape.len() == strides.len()).then(|| Place { storage: Rc::clone(storage), offset, shape, strides })
}
