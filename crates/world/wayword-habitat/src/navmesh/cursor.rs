//! Reads little-endian numbers from bytes that may end anywhere. Errors name the byte and the item that was expected.

use super::error::NavMeshError;

/// A position in a file, which only moves forward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NavMeshCursor<'a> {
    /// The bytes that are left.
    rest: &'a [u8],
    at: usize,
}

impl<'a> NavMeshCursor<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, at: 0 }
    }

    /// Offset from the file's beginning, bytes.
    pub(crate) fn byte_offset(&self) -> usize {
        self.at
    }

    pub(crate) fn bytes_left(&self) -> usize {
        self.rest.len()
    }

    pub(crate) fn remaining_bytes(&self) -> &'a [u8] {
        self.rest
    }

    /// The next `needed` bytes. The count is 64 bits wide, so that no product of a file's counts overflows.
    pub(crate) fn take_bytes(&mut self, needed: u64, what: &'static str) -> Result<&'a [u8], NavMeshError> {
        let parts = usize::try_from(needed).ok().and_then(|count| self.rest.split_at_checked(count));
        let (taken, rest) = parts.ok_or_else(|| self.short_error(what, needed))?;
        (self.at, self.rest) = (self.at + taken.len(), rest);
        Ok(taken)
    }

    fn short_error(&self, what: &'static str, needed: u64) -> NavMeshError {
        NavMeshError::Short { offset: self.at, what, needed, left: self.bytes_left() }
    }

    fn read_array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], NavMeshError> {
        let (array, rest) = self.rest.split_first_chunk().ok_or_else(|| self.short_error(what, N as u64))?;
        (self.at, self.rest) = (self.at + N, rest);
        Ok(*array)
    }

    pub(crate) fn read_u8(&mut self, what: &'static str) -> Result<u8, NavMeshError> {
        Ok(u8::from_le_bytes(self.read_array(what)?))
    }

    pub(crate) fn read_u16(&mut self, what: &'static str) -> Result<u16, NavMeshError> {
        Ok(u16::from_le_bytes(self.read_array(what)?))
    }

    pub(crate) fn read_u32(&mut self, what: &'static str) -> Result<u32, NavMeshError> {
        Ok(u32::from_le_bytes(self.read_array(what)?))
    }

    pub(crate) fn read_i32(&mut self, what: &'static str) -> Result<i32, NavMeshError> {
        Ok(i32::from_le_bytes(self.read_array(what)?))
    }

    /// Any 32-bit float: the caller checks whether it is finite.
    pub(crate) fn read_f32(&mut self, what: &'static str) -> Result<f32, NavMeshError> {
        Ok(f32::from_le_bytes(self.read_array(what)?))
    }

    /// A count; a negative one is an error.
    pub(crate) fn read_count(&mut self, what: &'static str) -> Result<u32, NavMeshError> {
        let offset = self.at;
        let count = self.read_i32(what)?;
        u32::try_from(count).map_err(|_| NavMeshError::bad_value(offset, what, count, "a count of 0 or more"))
    }

    /// A number that must equal `expected`.
    pub(crate) fn expect_magic(&mut self, what: &'static str, expected: i32, hint: &str) -> Result<(), NavMeshError> {
        let offset = self.at;
        let found = self.read_i32(what)?;
        if found == expected {
            return Ok(());
        }
        Err(NavMeshError::bad_value(offset, what, format!("{found:#x}"), format!("{expected:#x}: {hint}")))
    }

    /// `N` finite numbers of at most 1000 km.
    pub(crate) fn read_place<const N: usize>(&mut self, what: &'static str) -> Result<[f32; N], NavMeshError> {
        let mut place = [0.0; N];
        for number in &mut place {
            let offset = self.at;
            *number = self.read_f32(what)?;
            if !(number.is_finite() && number.abs() <= 1e6) {
                return Err(NavMeshError::bad_value(offset, what, *number, "metres within 1000 km of the origin"));
            }
        }
        Ok(place)
    }
}
