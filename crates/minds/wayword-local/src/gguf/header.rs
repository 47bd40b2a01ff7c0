//! The head of a GGUF file: metadata, and where its tensors lie.
//!
//! After <https://github.com/ggml-org/ggml/blob/master/docs/gguf.md>. candle reads the format too, but a file can make its reader
//! divide by zero (`general.alignment`) or take 32 times the file's size in memory (arrays of bytes), so this one is ours: nothing
//! is allocated that the file has no bytes for, and lists have bounds of their own.

use candle_core::quantized::GgmlDType;
use std::{collections::BTreeMap, io::Read};

/// Most entries of metadata, and most tensors.
const MOST_ENTRIES: u64 = 1 << 16;
/// Most items of all lists together: the largest vocabularies have 300,000 tokens and as many merges.
const MOST_ITEMS: u64 = 1 << 23;
/// Longest text, bytes.
const LONGEST_TEXT: u64 = 4 << 20;
/// Most axes of a tensor: the format's own limit.
const MOST_AXES: u32 = 4;

/// A value of the metadata.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Whole(i128),
    Real(f64),
    Flag(bool),
    Text(String),
    Texts(Vec<String>),
    Numbers(Vec<f64>),
}

/// Where a tensor lies.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) dtype: GgmlDType,
    /// Rows first, as candle has them.
    pub(super) shape: Vec<usize>,
    /// From the begin of the file, bytes.
    pub(super) from: u64,
}

/// The head.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) metadata: BTreeMap<String, Value>,
    pub(super) tensors: BTreeMap<String, Place>,
}

impl Header {
    /// Reads it from the begin of a file of so many bytes. An error says what is wrong, and with which field.
    pub(super) fn read(from: impl Read, length: u64) -> Result<Self, String> {
        let mut bytes = Bytes { from, left: length, items: MOST_ITEMS };
        if bytes.array::<4>()? != *b"GGUF" {
            return Err("it does not begin with GGUF".to_owned());
        }
        let version = bytes.u32()?;
        if !(2..=3).contains(&version) {
            return Err(format!("GGUF of version {version} is not known, only 2 and 3"));
        }
        let (tensors, entries) = (bytes.count("tensors")?, bytes.count("entries of metadata")?);
        let metadata = bytes.metadata(entries)?;
        let mut tensors = bytes.tensors(tensors)?;
        let begin = aligned(length - bytes.left, &metadata)?;
        for (name, place) in &mut tensors {
            place.settle(begin, length).map_err(|problem| format!("tensor {name}: {problem}"))?;
        }
        Ok(Self { metadata, tensors })
    }
}

/// Where the tensors begin.
fn aligned(end: u64, metadata: &BTreeMap<String, Value>) -> Result<u64, String> {
    let alignment = match metadata.get("general.alignment") {
        None => 32,
        Some(Value::Whole(alignment @ 1..=0x10000)) => *alignment as u64,
        Some(other) => return Err(format!("general.alignment: {other:?} is none")),
    };
    Ok(end.next_multiple_of(alignment))
}

impl Place {
    /// Holds it against the file's length.
    fn settle(&mut self, begin: u64, length: u64) -> Result<(), String> {
        let row = self.shape.last().copied().unwrap_or_default();
        let block = self.dtype.block_size();
        if row == 0 || !row.is_multiple_of(block) {
            return Err(format!("rows of {row} numbers do not fit blocks of {block}"));
        }
        let numbers = self.shape.iter().try_fold(1_usize, |product, &axis| product.checked_mul(axis));
        let bytes = numbers.and_then(|numbers| (numbers / block).checked_mul(self.dtype.type_size()));
        let from = begin.checked_add(self.from);
        let end = from.zip(bytes).and_then(|(from, bytes)| from.checked_add(bytes as u64));
        match (from, end) {
            (Some(from), Some(end)) if end <= length => self.from = from,
            _ => return Err(format!("{:?} numbers from byte {} on end after the file does", self.shape, self.from)),
        }
        Ok(())
    }
}

/// The bytes that are left of a file.
struct Bytes<R> {
    from: R,
    left: u64,
    /// How many items lists may still have.
    items: u64,
}

impl<R: Read> Bytes<R> {
    fn take(&mut self, bytes: u64) -> Result<(), String> {
        self.left = self.left.checked_sub(bytes).ok_or("the file is cut off")?;
        Ok(())
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut array = [0; N];
        self.take(N as u64)?;
        self.from.read_exact(&mut array).map_err(|error| error.to_string())?;
        Ok(array)
    }

    fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, String> {
        self.array().map(u64::from_le_bytes)
    }

    fn count(&mut self, of: &str) -> Result<u64, String> {
        let count = self.u64()?;
        if count > MOST_ENTRIES { Err(format!("{count} {of} are too many")) } else { Ok(count) }
    }

    fn text(&mut self) -> Result<String, String> {
        let length = self.u64()?;
        if length > LONGEST_TEXT {
            return Err(format!("a text of {length} bytes is too long"));
        }
        self.take(length)?;
        let mut bytes = vec![0; length as usize];
        self.from.read_exact(&mut bytes).map_err(|error| error.to_string())?;
        // Some vocabularies hold pieces that are no UTF-8 alone; their spelling matters to nobody but the decoder.
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn metadata(&mut self, count: u64) -> Result<BTreeMap<String, Value>, String> {
        let mut metadata = BTreeMap::new();
        for at in 0..count {
            let key = self.text().map_err(|problem| format!("key {at} of the metadata: {problem}"))?;
            let value = self.value().map_err(|problem| format!("{key}: {problem}"))?;
            if metadata.insert(key.clone(), value).is_some() {
                return Err(format!("{key}: it is there twice"));
            }
        }
        Ok(metadata)
    }

    fn value(&mut self) -> Result<Value, String> {
        match self.u32()? {
            8 => self.text().map(Value::Text),
            9 => self.list(),
            kind => self.scalar(kind),
        }
    }

    fn scalar(&mut self, kind: u32) -> Result<Value, String> {
        Ok(match kind {
            0 => Value::Whole(u8::from_le_bytes(self.array()?).into()),
            1 => Value::Whole(i8::from_le_bytes(self.array()?).into()),
            2 => Value::Whole(u16::from_le_bytes(self.array()?).into()),
            3 => Value::Whole(i16::from_le_bytes(self.array()?).into()),
            4 => Value::Whole(self.u32()?.into()),
            5 => Value::Whole(i32::from_le_bytes(self.array()?).into()),
            6 => Value::Real(f32::from_le_bytes(self.array()?).into()),
            7 => Value::Flag(self.array::<1>()? != [0]),
            10 => Value::Whole(self.u64()?.into()),
            11 => Value::Whole(i64::from_le_bytes(self.array()?).into()),
            12 => Value::Real(f64::from_le_bytes(self.array()?)),
            other => return Err(format!("a value of kind {other} is not known")),
        })
    }

    fn list(&mut self) -> Result<Value, String> {
        let kind = self.u32()?;
        let count = self.u64()?;
        // An item takes a byte at least, so that a list cannot be longer than the file.
        if count > self.left {
            return Err(format!("a list of {count} items is longer than the file"));
        }
        self.items = self.items.checked_sub(count).ok_or_else(|| format!("a list of {count} items is too long"))?;
        match kind {
            8 => (0..count).map(|_| self.text()).collect::<Result<_, _>>().map(Value::Texts),
            9 => Err("lists of lists are not known".to_owned()),
            kind => (0..count)
                .map(|_| self.scalar(kind).map(|value| value.real()))
                .collect::<Result<_, _>>()
                .map(Value::Numbers),
        }
    }

    fn tensors(&mut self, count: u64) -> Result<BTreeMap<String, Place>, String> {
        let mut tensors = BTreeMap::new();
        for at in 0..count {
            let name = self.text().map_err(|problem| format!("name of tensor {at}: {problem}"))?;
            let place = self.place().map_err(|problem| format!("tensor {name}: {problem}"))?;
            if tensors.insert(name.clone(), place).is_some() {
                return Err(format!("tensor {name}: it is there twice"));
            }
        }
        Ok(tensors)
    }

    fn place(&mut self) -> Result<Place, String> {
        let axes = self.u32()?;
        if !(1..=MOST_AXES).contains(&axes) {
            return Err(format!("{axes} axes are none that are known"));
        }
        let mut shape: Vec<usize> = Vec::new();
        for _ in 0..axes {
            shape.push(usize::try_from(self.u64()?).map_err(|error| error.to_string())?);
        }
        shape.reverse();
        let kind = self.u32()?;
        let dtype = dtype(kind).ok_or_else(|| format!("numbers of kind {kind} are not known"))?;
        Ok(Place { dtype, shape, from: self.u64()? })
    }
}

impl Value {
    /// A number of a list; a flag is 0 or 1.
    fn real(&self) -> f64 {
        match self {
            Self::Whole(whole) => *whole as f64,
            Self::Real(real) => *real,
            Self::Flag(flag) => f64::from(u8::from(*flag)),
            Self::Text(_) | Self::Texts(_) | Self::Numbers(_) => f64::NAN,
        }
    }
}

/// The kinds of numbers that candle multiplies with, by ggml's own numbers for them.
fn dtype(kind: u32) -> Option<GgmlDType> {
    Some(match kind {
        0 => GgmlDType::F32,
        1 => GgmlDType::F16,
        2 => GgmlDType::Q4_0,
        3 => GgmlDType::Q4_1,
        6 => GgmlDType::Q5_0,
        7 => GgmlDType::Q5_1,
        8 => GgmlDType::Q8_0,
        10 => GgmlDType::Q2K,
        11 => GgmlDType::Q3K,
        12 => GgmlDType::Q4K,
        13 => GgmlDType::Q5K,
        14 => GgmlDType::Q6K,
        30 => GgmlDType::BF16,
        _ => return None,
    })
}
