//! Writes FlatBuffers that TDW's own client can read. The reader is in the parent module.

/// A field of a table.
pub(super) enum Field {
    I32(i32),
    U8(u8),
    F32(f32),
    Struct(Vec<f32>),
    Text(String),
    Bytes(Vec<u8>),
    I32s(Vec<i32>),
    F32s(Vec<f32>),
    /// Structs of a size in bytes, one after another.
    Structs(usize, Vec<u8>),
    Texts(Vec<String>),
    Tables(Vec<Vec<Field>>),
}

impl Field {
    /// Bytes that it takes in its table.
    fn size(&self) -> usize {
        match self {
            Self::U8(_) => 1,
            Self::Struct(numbers) => 4 * numbers.len(),
            _ => 4,
        }
    }
}

/// A whole buffer: a file identifier and a table. Everything that a table refers to comes after it.
pub(super) fn buffer(id: &[u8; 4], fields: Vec<Field>) -> Vec<u8> {
    let mut bytes = vec![0; 4];
    bytes.extend_from_slice(id);
    let root = table(&mut bytes, fields);
    bytes[..4].copy_from_slice(&(root as u32).to_le_bytes());
    bytes
}

/// Appends a table and the data that it refers to; returns where the table starts.
fn table(bytes: &mut Vec<u8>, fields: Vec<Field>) -> usize {
    align(bytes);
    let vtable = bytes.len();
    let mut offset = 4;
    let mut offsets = Vec::new();
    for field in &fields {
        offsets.push(offset as u16);
        offset += field.size().next_multiple_of(4);
    }
    let vtable_size = 4 + 2 * fields.len();
    for entry in [vtable_size as u16, offset as u16].into_iter().chain(offsets.iter().copied()) {
        bytes.extend(entry.to_le_bytes());
    }
    align(bytes);
    let start = bytes.len();
    bytes.extend(((start - vtable) as i32).to_le_bytes());
    bytes.resize(start + offset, 0);
    for (field, offset) in fields.into_iter().zip(offsets) {
        fill(bytes, start + usize::from(offset), field);
    }
    start
}

fn fill(bytes: &mut Vec<u8>, at: usize, field: Field) {
    match field {
        Field::I32(value) => bytes[at..at + 4].copy_from_slice(&value.to_le_bytes()),
        Field::U8(value) => bytes[at] = value,
        Field::F32(value) => bytes[at..at + 4].copy_from_slice(&value.to_le_bytes()),
        Field::Struct(numbers) => {
            let raw = words(&numbers, |number| number.to_le_bytes());
            bytes[at..at + raw.len()].copy_from_slice(&raw);
        }
        Field::Text(text) => vector(bytes, at, text.len(), text.as_bytes()),
        Field::Bytes(raw) => vector(bytes, at, raw.len(), &raw),
        Field::I32s(numbers) => vector(bytes, at, numbers.len(), &words(&numbers, |number| number.to_le_bytes())),
        Field::F32s(numbers) => vector(bytes, at, numbers.len(), &words(&numbers, |number| number.to_le_bytes())),
        Field::Structs(size, raw) => vector(bytes, at, raw.len() / size, &raw),
        Field::Texts(texts) => {
            let elements = offsets(bytes, at, texts.len());
            for (element, text) in elements.zip(texts) {
                vector(bytes, element, text.len(), text.as_bytes());
            }
        }
        Field::Tables(tables) => {
            let elements = offsets(bytes, at, tables.len());
            for (element, fields) in elements.zip(tables) {
                let start = table(bytes, fields);
                point(bytes, element, start);
            }
        }
    }
}

fn words<T: Copy>(values: &[T], raw: impl Fn(T) -> [u8; 4]) -> Vec<u8> {
    values.iter().flat_map(|value| raw(*value)).collect()
}

fn align(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

/// Writes at `from` how far away `to` is.
fn point(bytes: &mut [u8], from: usize, to: usize) {
    bytes[from..from + 4].copy_from_slice(&((to - from) as u32).to_le_bytes());
}

/// Appends a vector, or a text, with the zero that texts end in.
fn vector(bytes: &mut Vec<u8>, at: usize, count: usize, raw: &[u8]) {
    align(bytes);
    let start = bytes.len();
    point(bytes, at, start);
    bytes.extend((count as u32).to_le_bytes());
    bytes.extend_from_slice(raw);
    bytes.push(0);
}

/// Appends a vector of offsets that are filled in later; returns the position of each.
fn offsets(bytes: &mut Vec<u8>, at: usize, count: usize) -> impl Iterator<Item = usize> + use<> {
    vector(bytes, at, count, &vec![0; 4 * count]);
    let first = bytes.len() - 1 - 4 * count;
    (0..count).map(move |index| first + 4 * index)
}
