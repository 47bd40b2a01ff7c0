//! Reads the boxes that form an MP4 file (ISO/IEC 14496-12, section 4.2).
//!
//! This is done here and not by a crate, because few boxes are needed and no length may be trusted. `re_mp4` 0.5 makes as
//! many samples as a header of 20 bytes claims (four thousand million), and it refuses QuickTime files, which have no
//! `ftyp`.

/// A box: its kind and its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Mp4Box<'a> {
    pub(super) kind: [u8; 4],
    pub(super) body: &'a [u8],
}

/// The boxes in some bytes, up to the first bytes that are not a box: some writers end a list with zeros.
pub(super) fn boxes_in(mut rest: &[u8]) -> impl Iterator<Item = Mp4Box<'_>> {
    std::iter::from_fn(move || {
        let BoxHeader { kind, length, bytes } = BoxHeader::read(rest, rest.len() as u64)?;
        let (whole, after) = rest.split_at_checked(usize::try_from(bytes).ok()?)?;
        let body = whole.get(length..)?;
        rest = after;
        Some(Mp4Box { kind, body })
    })
}

/// The first box of a kind.
pub(super) fn find_box<'a>(within: &'a [u8], kind: &[u8; 4]) -> Option<&'a [u8]> {
    boxes_in(within).find(|found| found.kind == *kind).map(|found| found.body)
}

/// The first box of a kind; an error if there is none.
pub(super) fn need_box<'a>(within: &'a [u8], kind: &[u8; 4]) -> Result<&'a [u8], String> {
    find_box(within, kind).ok_or_else(|| format!("has no box `{}`", kind_name(kind)))
}

/// The kind of a box as text.
pub(super) fn kind_name(kind: &[u8; 4]) -> String {
    kind.iter().flat_map(|byte| std::ascii::escape_default(*byte)).map(char::from).collect()
}

/// The beginning of a box.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoxHeader {
    pub(super) kind: [u8; 4],
    /// Length of the header itself, bytes.
    pub(super) length: usize,
    /// Length of the whole box, bytes.
    pub(super) bytes: u64,
}

impl BoxHeader {
    /// Longest header, bytes.
    pub(super) const MAX_BYTES: usize = 16;

    /// The header at the beginning of `start`. The surroundings of the box end after `left` bytes.
    pub(super) fn read(start: &[u8], left: u64) -> Option<Self> {
        let mut fields = BoxFields::new(start);
        let short = fields.read_u32().ok()?;
        let kind = fields.read_array().ok()?;
        // 0 means up to the end of the surroundings, and 1 that a length of 64 bits follows.
        let (length, bytes) = match short {
            0 => (8, left),
            1 => (16, fields.read_u64().ok()?),
            bytes => (8, u64::from(bytes)),
        };
        (bytes >= length as u64).then_some(Self { kind, length, bytes })
    }
}

/// Reads numbers, most significant byte first.
#[derive(Debug, Clone)]
pub(super) struct BoxFields<'a> {
    rest: &'a [u8],
}

impl<'a> BoxFields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Reads the beginning of a box that has a byte of version and three bytes of flags there: the fields after them, the
    /// version, and the flags.
    pub(super) fn with_version(bytes: &'a [u8]) -> Result<(Self, u8, u32), String> {
        let mut fields = Self::new(bytes);
        let [version, a, b, c] = fields.read_array::<4>()?;
        Ok((fields, version, u32::from_be_bytes([0, a, b, c])))
    }

    pub(super) fn remaining_bytes(&self) -> &'a [u8] {
        self.rest
    }

    pub(super) fn read_array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (first, rest) = self.rest.split_first_chunk::<N>().ok_or("is too short")?;
        self.rest = rest;
        Ok(*first)
    }

    pub(super) fn read_bytes(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (first, rest) = self.rest.split_at_checked(count).ok_or("is too short")?;
        self.rest = rest;
        Ok(first)
    }

    pub(super) fn read_u8(&mut self) -> Result<u8, String> {
        self.read_array().map(u8::from_be_bytes)
    }

    pub(super) fn read_u16(&mut self) -> Result<u16, String> {
        self.read_array().map(u16::from_be_bytes)
    }

    pub(super) fn read_u32(&mut self) -> Result<u32, String> {
        self.read_array().map(u32::from_be_bytes)
    }

    pub(super) fn read_i32(&mut self) -> Result<i32, String> {
        self.read_array().map(i32::from_be_bytes)
    }

    pub(super) fn read_u64(&mut self) -> Result<u64, String> {
        self.read_array().map(u64::from_be_bytes)
    }

    /// 32 bits in version 0 of a box, 64 in version 1.
    pub(super) fn read_versioned(&mut self, version: u8) -> Result<u64, String> {
        if version == 0 { self.read_u32().map(u64::from) } else { self.read_u64() }
    }

    /// A counted list of rows of `N` bytes. A count that is larger than the bytes allow is an error.
    pub(super) fn read_rows<const N: usize>(&mut self) -> Result<impl Iterator<Item = [u8; N]> + use<'a, N>, String> {
        let count = self.read_u32()? as usize;
        let bytes = count.checked_mul(N).ok_or("is too short")?;
        Ok(self.read_bytes(bytes)?.chunks_exact(N).filter_map(|row| row.try_into().ok()))
    }
}

/// Adds the name of the box to an error message.
pub(super) fn in_box(kind: &'static str) -> impl Fn(String) -> String {
    move |reason| format!("box `{kind}` {reason}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_end_at_the_first_bytes_that_are_no_box() {
        let bytes =
            [&[0, 0, 0, 9][..], b"abcd", &[7], &[0, 0, 0, 1], b"long", &17_u64.to_be_bytes(), &[8], &[0, 0, 0, 0]]
                .concat();
        let found: Vec<_> = boxes_in(&bytes).map(|found| (kind_name(&found.kind), found.body.to_vec())).collect();
        assert_eq!(found, [("abcd".to_owned(), vec![7]), ("long".to_owned(), vec![8])]);
    }

    #[test]
    fn a_box_larger_than_its_container_is_none() {
        assert_eq!(boxes_in(b"\0\0\0\x0aabcd\x07").count(), 0);
        assert_eq!(boxes_in(b"\0\0\0\x07abcd\x07").count(), 0);
        assert_eq!(boxes_in(b"\0\0\0\x01abcd\xff\xff\xff\xff\xff\xff\xff\xff").count(), 0);
    }

    #[test]
    fn a_list_cannot_claim_more_than_there_is() {
        assert!(BoxFields::new(&[0xff; 8]).read_rows::<8>().is_err());
        assert_eq!(BoxFields::new(&[0, 0, 0, 1, 5, 6]).read_rows::<2>().unwrap().next(), Some([5, 6]));
    }
}
