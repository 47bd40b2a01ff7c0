//! Reads FlatBuffers, as far as TDW's output uses them: tables with vtables, strings, vectors, structs.
//!
//! A table starts with an offset back to its vtable, a list of two-byte entries. Entry (slot) `n` is the position of
//! field `n` in the table, or 0 where the table leaves the field out. Strings, vectors and inner tables are elsewhere in
//! the buffer; their field is an offset that counts from its own position.
//!
//! Every offset is checked against the input's length before it is followed. Strings, bytes and tables are borrowed from
//! the input: a hostile buffer can point many offsets at one long string, and this takes no memory. Offsets cannot lead
//! in a circle, because the code that reads a table sets the depth, and not the bytes.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

/// Bytes that do not have the expected form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("byte {at}: expected {expected}")]
pub struct FlatBufferError {
    /// Position in the frame.
    pub at: usize,
    /// The expected content.
    pub expected: &'static str,
}

/// A table of a buffer.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlatBufferTable<'a> {
    /// The whole frame.
    bytes: &'a [u8],
    /// Where the table starts in it.
    at: usize,
    vtable: &'a [u8],
    /// Where the table's own fields end.
    end: usize,
}

/// A vector's elements: all of one size, and all within the input.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlatBufferVector<'a> {
    /// The whole frame.
    bytes: &'a [u8],
    /// Where the first element starts in it.
    from: usize,
    /// Bytes of an element.
    size: usize,
    count: usize,
}

fn fixed_bytes<const N: usize>(bytes: &[u8], at: usize, expected: &'static str) -> Result<[u8; N], FlatBufferError> {
    let slice = bytes.get(at..).and_then(|rest| rest.first_chunk());
    slice.copied().ok_or(FlatBufferError { at, expected })
}

fn u16_at(bytes: &[u8], at: usize, expected: &'static str) -> Result<usize, FlatBufferError> {
    fixed_bytes(bytes, at, expected).map(|raw| usize::from(u16::from_le_bytes(raw)))
}

fn u32_at(bytes: &[u8], at: usize, expected: &'static str) -> Result<usize, FlatBufferError> {
    fixed_bytes(bytes, at, expected).map(|raw| u32::from_le_bytes(raw) as usize)
}

/// Follows an offset, which counts from its own position.
fn follow_offset(bytes: &[u8], at: usize, expected: &'static str) -> Result<usize, FlatBufferError> {
    let to = at.saturating_add(u32_at(bytes, at, expected)?);
    if to < bytes.len() { Ok(to) } else { Err(FlatBufferError { at, expected }) }
}

impl<'a> FlatBufferTable<'a> {
    /// The outermost table.
    pub(super) fn root_table(bytes: &'a [u8]) -> Result<Self, FlatBufferError> {
        Self::table_at(bytes, follow_offset(bytes, 0, "an offset to the root table")?)
    }

    fn table_at(bytes: &'a [u8], at: usize) -> Result<Self, FlatBufferError> {
        let expected = "an offset to a vtable";
        let back = i64::from(i32::from_le_bytes(fixed_bytes(bytes, at, expected)?));
        let start = i64::try_from(at).ok().and_then(|at| usize::try_from(at - back).ok());
        let start = start.ok_or(FlatBufferError { at, expected })?;
        let length = u16_at(bytes, start, expected)?;
        let vtable = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let vtable =
            vtable.filter(|vtable| vtable.len() >= 4).ok_or(FlatBufferError { at: start, expected: "a vtable" })?;
        let end = at + u16_at(vtable, 2, "a vtable")?;
        if end > bytes.len() {
            return Err(FlatBufferError { at: start + 2, expected: "a table within the frame" });
        }
        Ok(Self { bytes, at, vtable, end })
    }

    /// Where a field of `size` bytes lies; `None` where the table leaves it out.
    fn field_position(
        &self,
        slot: usize,
        size: usize,
        expected: &'static str,
    ) -> Result<Option<usize>, FlatBufferError> {
        let entry = 4 + 2 * slot;
        if entry + 2 > self.vtable.len() {
            return Ok(None);
        }
        let offset = u16_at(self.vtable, entry, expected)?;
        let at = self.at + offset;
        match offset {
            0 => Ok(None),
            _ if at + size <= self.end => Ok(Some(at)),
            _ => Err(FlatBufferError { at, expected }),
        }
    }

    /// The error for a field with invalid content.
    pub(super) fn field_error(&self, slot: usize, expected: &'static str) -> FlatBufferError {
        let at = self.field_position(slot, 1, expected).ok().flatten().unwrap_or(self.at);
        FlatBufferError { at, expected }
    }

    fn read_scalar<const N: usize>(
        &self,
        slot: usize,
        expected: &'static str,
    ) -> Result<Option<[u8; N]>, FlatBufferError> {
        self.field_position(slot, N, expected)?.map(|at| fixed_bytes(self.bytes, at, expected)).transpose()
    }

    pub(super) fn read_i32(&self, slot: usize, default: i32) -> Result<i32, FlatBufferError> {
        Ok(self.read_scalar(slot, "an integer")?.map_or(default, i32::from_le_bytes))
    }

    pub(super) fn read_u8(&self, slot: usize, default: u8) -> Result<u8, FlatBufferError> {
        Ok(self.read_scalar(slot, "a byte")?.map_or(default, |[byte]| byte))
    }

    pub(super) fn read_bool(&self, slot: usize) -> Result<bool, FlatBufferError> {
        Ok(self.read_u8(slot, 0)? != 0)
    }

    pub(super) fn read_f32(&self, slot: usize) -> Result<f32, FlatBufferError> {
        Ok(self.read_scalar(slot, "a number")?.map_or(0.0, f32::from_le_bytes))
    }

    /// A struct of `N` numbers; zeros where the table leaves it out.
    pub(super) fn read_floats<const N: usize>(&self, slot: usize) -> Result<[f32; N], FlatBufferError> {
        let expected = "a struct of numbers";
        let Some(at) = self.field_position(slot, 4 * N, expected)? else {
            return Ok([0.0; N]);
        };
        let mut numbers = [0.0; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number = f32::from_le_bytes(fixed_bytes(self.bytes, at + 4 * index, expected)?);
        }
        Ok(numbers)
    }

    /// A struct of three integers.
    pub(super) fn three_i32(&self, slot: usize) -> Result<[i32; 3], FlatBufferError> {
        Ok(self.read_floats::<3>(slot)?.map(|raw| raw.to_bits().cast_signed()))
    }

    /// A text; empty where the table leaves it out.
    pub(super) fn read_text(&self, slot: usize) -> Result<&'a str, FlatBufferError> {
        let expected = "a text";
        let Some(at) = self.field_position(slot, 4, expected)? else {
            return Ok("");
        };
        text_at(self.bytes, follow_offset(self.bytes, at, expected)?)
    }

    /// A vector with elements of `size` bytes each; empty where the table leaves it out.
    pub(super) fn read_vector(&self, slot: usize, size: usize) -> Result<FlatBufferVector<'a>, FlatBufferError> {
        let expected = "a vector";
        let Some(at) = self.field_position(slot, 4, expected)? else {
            return Ok(FlatBufferVector { bytes: self.bytes, from: 0, size, count: 0 });
        };
        FlatBufferVector::vector_at(self.bytes, follow_offset(self.bytes, at, expected)?, size)
    }

    pub(super) fn read_bytes(&self, slot: usize) -> Result<&'a [u8], FlatBufferError> {
        Ok(self.read_vector(slot, 1)?.raw_bytes())
    }

    pub(super) fn read_i32s(&self, slot: usize) -> Result<Vec<i32>, FlatBufferError> {
        let raw = self.read_vector(slot, 4)?.raw_bytes();
        Ok(raw.as_chunks().0.iter().map(|word| i32::from_le_bytes(*word)).collect())
    }

    pub(super) fn read_f32s(&self, slot: usize) -> Result<Vec<f32>, FlatBufferError> {
        let raw = self.read_vector(slot, 4)?.raw_bytes();
        Ok(raw.as_chunks().0.iter().map(|word| f32::from_le_bytes(*word)).collect())
    }

    pub(super) fn read_texts(&self, slot: usize) -> Result<Vec<&'a str>, FlatBufferError> {
        self.read_vector(slot, 4)?.offset_targets()?.into_iter().map(|at| text_at(self.bytes, at)).collect()
    }

    pub(super) fn read_tables(&self, slot: usize) -> Result<Vec<Self>, FlatBufferError> {
        self.read_vector(slot, 4)?.offset_targets()?.into_iter().map(|at| Self::table_at(self.bytes, at)).collect()
    }
}

fn text_at(bytes: &[u8], at: usize) -> Result<&str, FlatBufferError> {
    let raw = FlatBufferVector::vector_at(bytes, at, 1)?.raw_bytes();
    std::str::from_utf8(raw).map_err(|_| FlatBufferError { at, expected: "a text in UTF-8" })
}

impl<'a> FlatBufferVector<'a> {
    fn vector_at(bytes: &'a [u8], at: usize, size: usize) -> Result<Self, FlatBufferError> {
        let count = u32_at(bytes, at, "a vector's length")?;
        let from = at + 4;
        let end = count.checked_mul(size).and_then(|length| length.checked_add(from));
        if end.is_none_or(|end| end > bytes.len()) {
            return Err(FlatBufferError { at, expected: "a vector that ends within the frame" });
        }
        Ok(Self { bytes, from, size, count })
    }

    pub(super) fn raw_bytes(&self) -> &'a [u8] {
        // The vector ends within the frame.
        self.bytes.get(self.from..self.from + self.size * self.count).unwrap_or_default()
    }

    /// Where the offsets of a vector lead.
    fn offset_targets(&self) -> Result<Vec<usize>, FlatBufferError> {
        let at = |index| self.from + 4 * index;
        (0..self.count).map(|index| follow_offset(self.bytes, at(index), "an offset within the frame")).collect()
    }
}
