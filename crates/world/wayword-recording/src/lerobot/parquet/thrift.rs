//! Reads Thrift's compact protocol, the format of Parquet's metadata. Skipped values take no memory.

/// Kinds of values, as numbers of the protocol. Kinds that are only skipped have no name here: 3 is a byte, 4 and 6 are other
/// integers, 7 is a double, and 10 is a set.
pub(super) const KIND_TRUE: u8 = 1;
pub(super) const KIND_FALSE: u8 = 2;
pub(super) const KIND_I32: u8 = 5;
pub(super) const KIND_BYTES: u8 = 8;
pub(super) const KIND_LIST: u8 = 9;
pub(super) const KIND_STRUCT: u8 = 12;

/// Deepest nesting of skipped values; deeper ones are an error. A footer's are 6 deep.
const MAX_DEPTH: usize = 16;

/// Bytes that are read one value after another.
pub(super) struct ThriftReader<'a> {
    rest: &'a [u8],
}

impl<'a> ThriftReader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The bytes that have not been read.
    pub(super) const fn remaining_bytes(&self) -> &'a [u8] {
        self.rest
    }

    fn take_bytes(&mut self, count: u64) -> Result<&'a [u8], String> {
        let taken = usize::try_from(count).ok().and_then(|count| self.rest.split_at_checked(count));
        let (taken, rest) =
            taken.ok_or_else(|| format!("{count} bytes should follow, but only {} do", self.rest.len()))?;
        self.rest = rest;
        Ok(taken)
    }

    fn read_byte(&mut self) -> Result<u8, String> {
        let (first, rest) = self.rest.split_first().ok_or("1 bytes should follow, but only 0 do")?;
        self.rest = rest;
        Ok(*first)
    }

    /// A number without a sign: seven bits in each byte, the lowest first, until a byte without its highest bit.
    fn read_varint(&mut self) -> Result<u64, String> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.read_byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err("a number has more than 64 bits".to_owned())
    }

    /// A whole number in zigzag form: its lowest bit is the sign.
    pub(super) fn read_number(&mut self) -> Result<i64, String> {
        let value = self.read_varint()?;
        Ok((value >> 1).cast_signed() ^ -(value & 1).cast_signed())
    }

    /// Bytes or a text.
    pub(super) fn read_bytes(&mut self) -> Result<&'a [u8], String> {
        let length = self.read_varint()?;
        self.take_bytes(length)
    }

    /// The beginning of a list: the number of its elements, and their kind. Each element takes at least a
    /// byte, so a count above the remaining bytes is refused.
    pub(super) fn read_list(&mut self) -> Result<(u64, u8), String> {
        let header = self.read_byte()?;
        let count = if header >> 4 == 15 { self.read_varint()? } else { u64::from(header >> 4) };
        if count > self.rest.len() as u64 {
            return Err(format!("{count} elements should follow in {} bytes", self.rest.len()));
        }
        Ok((count, header & 0x0f))
    }

    /// The kind of the next field of a struct; `None` after the last. `number` is that of the last field and becomes
    /// that of this one.
    pub(super) fn next_field(&mut self, number: &mut i16) -> Result<Option<u8>, String> {
        let header = self.read_byte()?;
        if header & 0x0f == 0 {
            return Ok(None);
        }
        *number = match header >> 4 {
            0 => i16::try_from(self.read_number()?).map_err(|_| "a field has no valid number")?,
            step => number.saturating_add(i16::from(step)),
        };
        Ok(Some(header & 0x0f))
    }

    /// Skips a field's value.
    pub(super) fn skip_value(&mut self, kind: u8) -> Result<(), String> {
        self.skip_nested_value(kind, 0)
    }

    /// Skips a value that lies in `depth` other values.
    fn skip_nested_value(&mut self, kind: u8, depth: usize) -> Result<(), String> {
        match kind {
            // The value of a boolean field is in the kind itself.
            KIND_TRUE | KIND_FALSE => Ok(()),
            3 => self.read_byte().map(drop),
            4..=6 => self.read_varint().map(drop),
            7 => self.take_bytes(8).map(drop),
            KIND_BYTES => self.read_bytes().map(drop),
            KIND_LIST | 10 if depth < MAX_DEPTH => {
                let (count, kind) = self.read_list()?;
                // In a list a boolean is a byte.
                let kind = if matches!(kind, KIND_TRUE | KIND_FALSE) { 3 } else { kind };
                (0..count).try_for_each(|_| self.skip_nested_value(kind, depth + 1))
            }
            KIND_STRUCT if depth < MAX_DEPTH => {
                let mut number = 0;
                while let Some(kind) = self.next_field(&mut number)? {
                    self.skip_nested_value(kind, depth + 1)?;
                }
                Ok(())
            }
            other => Err(format!("a value has kind {other}, which is not known or nested too deeply")),
        }
    }
}
