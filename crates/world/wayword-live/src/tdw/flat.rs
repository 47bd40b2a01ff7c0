//! Reads FlatBuffers, as far as TDW's output uses them: tables with vtables, strings, vectors, structs.
//!
//! A table starts with an offset back to its vtable, a list of two-byte entries. Entry (slot) `n` is the position of
//! field `n` in the table, or 0 where the table leaves the field out. Strings, vectors and inner tables are elsewhere in
//! the buffer; their field is an offset that counts from its own position.
//!
//! Every offset is checked against the input's length before it is followed. Strings, bytes and tables are borrowed from
//! the input: a hostile buffer can point many offsets at one long string, and this takes no memory. Offsets cannot lead
//! in a circle, because the code that reads a table sets the depth, and not the bytes.

/// Bytes that do not have the expected form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("byte {at}: expected {expected}")]
pub struct Misread {
    /// Position in the frame.
    pub at: usize,
    /// The expected content.
    pub expected: &'static str,
}

/// A table of a buffer.
#[derive(Debug, Clone, Copy)]
pub(super) struct Table<'a> {
    bytes: &'a [u8],
    at: usize,
    vtable: &'a [u8],
    /// Where the table's own fields end.
    end: usize,
}

/// A vector's elements: all of one size, and all within the input.
#[derive(Debug, Clone, Copy)]
pub(super) struct Items<'a> {
    bytes: &'a [u8],
    from: usize,
    size: usize,
    count: usize,
}

fn fixed<const N: usize>(bytes: &[u8], at: usize, expected: &'static str) -> Result<[u8; N], Misread> {
    let slice = bytes.get(at..).and_then(|rest| rest.first_chunk());
    slice.copied().ok_or(Misread { at, expected })
}

fn u16_at(bytes: &[u8], at: usize, expected: &'static str) -> Result<usize, Misread> {
    fixed(bytes, at, expected).map(|raw| usize::from(u16::from_le_bytes(raw)))
}

fn u32_at(bytes: &[u8], at: usize, expected: &'static str) -> Result<usize, Misread> {
    fixed(bytes, at, expected).map(|raw| u32::from_le_bytes(raw) as usize)
}

/// Follows an offset, which counts from its own position.
fn followed(bytes: &[u8], at: usize, expected: &'static str) -> Result<usize, Misread> {
    let to = at.saturating_add(u32_at(bytes, at, expected)?);
    if to < bytes.len() { Ok(to) } else { Err(Misread { at, expected }) }
}

impl<'a> Table<'a> {
    /// The outermost table.
    pub(super) fn root(bytes: &'a [u8]) -> Result<Self, Misread> {
        Self::at(bytes, followed(bytes, 0, "an offset to the root table")?)
    }

    fn at(bytes: &'a [u8], at: usize) -> Result<Self, Misread> {
        let expected = "an offset to a vtable";
        let back = i64::from(i32::from_le_bytes(fixed(bytes, at, expected)?));
        let start = usize::try_from(at as i64 - back).map_err(|_| Misread { at, expected })?;
        let length = u16_at(bytes, start, expected)?;
        let vtable = start.checked_add(length).and_then(|end| bytes.get(start..end));
        let vtable = vtable.filter(|vtable| vtable.len() >= 4).ok_or(Misread { at: start, expected: "a vtable" })?;
        let end = at + u16_at(vtable, 2, "a vtable")?;
        if end > bytes.len() {
            return Err(Misread { at: start + 2, expected: "a table within the frame" });
        }
        Ok(Self { bytes, at, vtable, end })
    }

    /// Where a field of `size` bytes lies; `None` where the table leaves it out.
    fn field(&self, slot: usize, size: usize, expected: &'static str) -> Result<Option<usize>, Misread> {
        let entry = 4 + 2 * slot;
        if entry + 2 > self.vtable.len() {
            return Ok(None);
        }
        let offset = u16_at(self.vtable, entry, expected)?;
        let at = self.at + offset;
        match offset {
            0 => Ok(None),
            _ if at + size <= self.end => Ok(Some(at)),
            _ => Err(Misread { at, expected }),
        }
    }

    /// The error for a field with invalid content.
    pub(super) fn misfit(&self, slot: usize, expected: &'static str) -> Misread {
        let at = self.field(slot, 1, expected).ok().flatten().unwrap_or(self.at);
        Misread { at, expected }
    }

    fn scalar<const N: usize>(&self, slot: usize, expected: &'static str) -> Result<Option<[u8; N]>, Misread> {
        self.field(slot, N, expected)?.map(|at| fixed(self.bytes, at, expected)).transpose()
    }

    pub(super) fn i32(&self, slot: usize, default: i32) -> Result<i32, Misread> {
        Ok(self.scalar(slot, "an integer")?.map_or(default, i32::from_le_bytes))
    }

    pub(super) fn u8(&self, slot: usize, default: u8) -> Result<u8, Misread> {
        Ok(self.scalar(slot, "a byte")?.map_or(default, |[byte]| byte))
    }

    pub(super) fn bool(&self, slot: usize) -> Result<bool, Misread> {
        Ok(self.u8(slot, 0)? != 0)
    }

    pub(super) fn f32(&self, slot: usize) -> Result<f32, Misread> {
        Ok(self.scalar(slot, "a number")?.map_or(0.0, f32::from_le_bytes))
    }

    /// A struct of `N` numbers; zeros where the table leaves it out.
    pub(super) fn floats<const N: usize>(&self, slot: usize) -> Result<[f32; N], Misread> {
        let expected = "a struct of numbers";
        let Some(at) = self.field(slot, 4 * N, expected)? else {
            return Ok([0.0; N]);
        };
        let mut numbers = [0.0; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number = f32::from_le_bytes(fixed(self.bytes, at + 4 * index, expected)?);
        }
        Ok(numbers)
    }

    /// A struct of three integers.
    pub(super) fn three_i32(&self, slot: usize) -> Result<[i32; 3], Misread> {
        Ok(self.floats::<3>(slot)?.map(|raw| raw.to_bits() as i32))
    }

    /// A text; empty where the table leaves it out.
    pub(super) fn text(&self, slot: usize) -> Result<&'a str, Misread> {
        let expected = "a text";
        let Some(at) = self.field(slot, 4, expected)? else {
            return Ok("");
        };
        text_at(self.bytes, followed(self.bytes, at, expected)?)
    }

    /// A vector with elements of `size` bytes each; empty where the table leaves it out.
    pub(super) fn vector(&self, slot: usize, size: usize) -> Result<Items<'a>, Misread> {
        let expected = "a vector";
        let Some(at) = self.field(slot, 4, expected)? else {
            return Ok(Items { bytes: self.bytes, from: 0, size, count: 0 });
        };
        Items::at(self.bytes, followed(self.bytes, at, expected)?, size)
    }

    pub(super) fn bytes(&self, slot: usize) -> Result<&'a [u8], Misread> {
        Ok(self.vector(slot, 1)?.raw())
    }

    pub(super) fn i32s(&self, slot: usize) -> Result<Vec<i32>, Misread> {
        let raw = self.vector(slot, 4)?.raw();
        Ok(raw.as_chunks().0.iter().map(|word| i32::from_le_bytes(*word)).collect())
    }

    pub(super) fn f32s(&self, slot: usize) -> Result<Vec<f32>, Misread> {
        let raw = self.vector(slot, 4)?.raw();
        Ok(raw.as_chunks().0.iter().map(|word| f32::from_le_bytes(*word)).collect())
    }

    pub(super) fn texts(&self, slot: usize) -> Result<Vec<&'a str>, Misread> {
        self.vector(slot, 4)?.targets()?.into_iter().map(|at| text_at(self.bytes, at)).collect()
    }

    pub(super) fn tables(&self, slot: usize) -> Result<Vec<Self>, Misread> {
        self.vector(slot, 4)?.targets()?.into_iter().map(|at| Self::at(self.bytes, at)).collect()
    }
}

fn text_at(bytes: &[u8], at: usize) -> Result<&str, Misread> {
    let raw = Items::at(bytes, at, 1)?.raw();
    std::str::from_utf8(raw).map_err(|_| Misread { at, expected: "a text in UTF-8" })
}

impl<'a> Items<'a> {
    fn at(bytes: &'a [u8], at: usize, size: usize) -> Result<Self, Misread> {
        let count = u32_at(bytes, at, "a vector's length")?;
        let from = at + 4;
        let end = count.checked_mul(size).and_then(|length| length.checked_add(from));
        if end.is_none_or(|end| end > bytes.len()) {
            return Err(Misread { at, expected: "a vector that ends within the frame" });
        }
        Ok(Self { bytes, from, size, count })
    }

    pub(super) fn raw(&self) -> &'a [u8] {
        &self.bytes[self.from..self.from + self.size * self.count]
    }

    /// Where the offsets of a vector lead.
    fn targets(&self) -> Result<Vec<usize>, Misread> {
        let at = |index| self.from + 4 * index;
        (0..self.count).map(|index| followed(self.bytes, at(index), "an offset within the frame")).collect()
    }
}
