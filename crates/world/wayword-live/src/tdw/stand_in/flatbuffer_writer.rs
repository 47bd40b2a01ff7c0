//! Writes FlatBuffers that TDW's own client can read. `flatbuffer_reader.rs` explains the format.

/// A field of a table.
pub(super) enum FlatBufferField {
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
    Tables(Vec<Vec<FlatBufferField>>),
}

impl FlatBufferField {
    /// Bytes that it takes in its table.
    fn bytes_in_table(&self) -> usize {
        match self {
            Self::U8(_) => 1,
            Self::Struct(numbers) => 4 * numbers.len(),
            _ => 4,
        }
    }
}

/// A whole buffer: a file identifier and a table. Everything that a table refers to comes after it.
pub(super) fn write_buffer(id: &[u8; 4], fields: Vec<FlatBufferField>) -> Vec<u8> {
    let mut bytes = vec![0; 4];
    bytes.extend_from_slice(id);
    let root = append_table(&mut bytes, fields);
    bytes[..4].copy_from_slice(&(root as u32).to_le_bytes());
    bytes
}

/// Appends a table and the data that it refers to; returns where the table starts.
fn append_table(bytes: &mut Vec<u8>, fields: Vec<FlatBufferField>) -> usize {
    align_to_four(bytes);
    let vtable = bytes.len();
    let mut offset = 4;
    let mut offsets = Vec::new();
    for field in &fields {
        offsets.push(offset as u16);
        offset += field.bytes_in_table().next_multiple_of(4);
    }
    let vtable_size = 4 + 2 * fields.len();
    for entry in [vtable_size as u16, offset as u16].into_iter().chain(offsets.iter().copied()) {
        bytes.extend(entry.to_le_bytes());
    }
    align_to_four(bytes);
    let start = bytes.len();
    bytes.extend(((start - vtable) as i32).to_le_bytes());
    bytes.resize(start + offset, 0);
    for (field, offset) in fields.into_iter().zip(offsets) {
        fill_field(bytes, start + usize::from(offset), field);
    }
    start
}

fn fill_field(bytes: &mut Vec<u8>, at: usize, field: FlatBufferField) {
    match field {
        FlatBufferField::I32(value) => bytes[at..at + 4].copy_from_slice(&value.to_le_bytes()),
        FlatBufferField::U8(value) => bytes[at] = value,
        FlatBufferField::F32(value) => bytes[at..at + 4].copy_from_slice(&value.to_le_bytes()),
        FlatBufferField::Struct(numbers) => {
            let raw = little_endian_words(&numbers, |number| number.to_le_bytes());
            bytes[at..at + raw.len()].copy_from_slice(&raw);
        }
        FlatBufferField::Text(text) => append_vector(bytes, at, text.len(), text.as_bytes()),
        FlatBufferField::Bytes(raw) => append_vector(bytes, at, raw.len(), &raw),
        FlatBufferField::I32s(numbers) => {
            append_vector(bytes, at, numbers.len(), &little_endian_words(&numbers, |number| number.to_le_bytes()));
        }
        FlatBufferField::F32s(numbers) => {
            append_vector(bytes, at, numbers.len(), &little_endian_words(&numbers, |number| number.to_le_bytes()));
        }
        FlatBufferField::Structs(size, raw) => append_vector(bytes, at, raw.len() / size, &raw),
        FlatBufferField::Texts(texts) => {
            let elements = append_offsets(bytes, at, texts.len());
            for (element, text) in elements.zip(texts) {
                append_vector(bytes, element, text.len(), text.as_bytes());
            }
        }
        FlatBufferField::Tables(tables) => {
            let elements = append_offsets(bytes, at, tables.len());
            for (element, fields) in elements.zip(tables) {
                let start = append_table(bytes, fields);
                write_offset(bytes, element, start);
            }
        }
    }
}

fn little_endian_words<T: Copy>(values: &[T], raw: impl Fn(T) -> [u8; 4]) -> Vec<u8> {
    values.iter().flat_map(|value| raw(*value)).collect()
}

fn align_to_four(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(4), 0);
}

/// Writes at `from` how far away `to` is.
fn write_offset(bytes: &mut [u8], from: usize, to: usize) {
    bytes[from..from + 4].copy_from_slice(&((to - from) as u32).to_le_bytes());
}

/// Appends a vector, or a text, with the zero that texts end in.
fn append_vector(bytes: &mut Vec<u8>, at: usize, count: usize, raw: &[u8]) {
    align_to_four(bytes);
    let start = bytes.len();
    write_offset(bytes, at, start);
    bytes.extend((count as u32).to_le_bytes());
    bytes.extend_from_slice(raw);
    bytes.push(0);
}

/// Appends a vector of offsets that are filled in later; returns the position of each.
fn append_offsets(bytes: &mut Vec<u8>, at: usize, count: usize) -> impl Iterator<Item = usize> + use<> {
    append_vector(bytes, at, count, &vec![0; 4 * count]);
    let first = bytes.len() - 1 - 4 * count;
    (0..count).map(move |index| first + 4 * index)
}
