//! Reads the boxes that form an MP4 file (ISO/IEC 14496-12, section 4.2).
//!
//! This is done here and not by a crate, because few boxes are needed and no length may be trusted. `re_mp4` 0.5 makes as
//! many samples as a header of 20 bytes claims (four thousand million), and it refuses QuickTime files, which have no
//! `ftyp`.

/// A box: its kind and its content.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Atom<'a> {
    pub(super) kind: [u8; 4],
    pub(super) body: &'a [u8],
}

/// The boxes in some bytes, up to the first bytes that are not a box: some writers end a list with zeros.
pub(super) fn boxes(mut rest: &[u8]) -> impl Iterator<Item = Atom<'_>> {
    std::iter::from_fn(move || {
        let Header { kind, length, bytes } = Header::read(rest, rest.len() as u64)?;
        let end = usize::try_from(bytes).ok().filter(|end| *end <= rest.len())?;
        let body = rest.get(length..end)?;
        rest = &rest[end..];
        Some(Atom { kind, body })
    })
}

/// The first box of a kind.
pub(super) fn find<'a>(within: &'a [u8], kind: &[u8; 4]) -> Option<&'a [u8]> {
    boxes(within).find(|found| found.kind == *kind).map(|found| found.body)
}

/// The first box of a kind; an error if there is none.
pub(super) fn need<'a>(within: &'a [u8], kind: &[u8; 4]) -> Result<&'a [u8], String> {
    find(within, kind).ok_or_else(|| format!("has no box `{}`", name(kind)))
}

/// The kind of a box as text.
pub(super) fn name(kind: &[u8; 4]) -> String {
    kind.iter().flat_map(|byte| std::ascii::escape_default(*byte)).map(char::from).collect()
}

/// The beginning of a box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Header {
    pub(super) kind: [u8; 4],
    /// Length of the header itself, bytes.
    pub(super) length: usize,
    /// Length of the whole box, bytes.
    pub(super) bytes: u64,
}

impl Header {
    /// Longest header, bytes.
    pub(super) const MOST: usize = 16;

    /// The header at the beginning of `start`. The surroundings of the box end after `left` bytes.
    pub(super) fn read(start: &[u8], left: u64) -> Option<Self> {
        let mut fields = Fields::new(start);
        let short = fields.u32().ok()?;
        let kind = fields.array().ok()?;
        let (length, bytes) = match short {
            0 => (8, left),
            1 => (16, fields.u64().ok()?),
            bytes => (8, u64::from(bytes)),
        };
        (bytes >= length as u64).then_some(Self { kind, length, bytes })
    }
}

/// Reads numbers, most significant byte first.
#[derive(Debug, Clone)]
pub(super) struct Fields<'a> {
    rest: &'a [u8],
}

impl<'a> Fields<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The fields, version and flags of a box that begins with the last two.
    pub(super) fn full(bytes: &'a [u8]) -> Result<(Self, u8, u32), String> {
        let mut fields = Self::new(bytes);
        let word = fields.u32()?;
        Ok((fields, (word >> 24) as u8, word & 0x00ff_ffff))
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (first, rest) = self.rest.split_first_chunk::<N>().ok_or("is too short")?;
        self.rest = rest;
        Ok(*first)
    }

    pub(super) fn bytes(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (first, rest) = self.rest.split_at_checked(count).ok_or("is too short")?;
        self.rest = rest;
        Ok(first)
    }

    pub(super) fn u8(&mut self) -> Result<u8, String> {
        self.array().map(u8::from_be_bytes)
    }

    pub(super) fn u16(&mut self) -> Result<u16, String> {
        self.array().map(u16::from_be_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, String> {
        self.array().map(u32::from_be_bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32, String> {
        self.array().map(i32::from_be_bytes)
    }

    pub(super) fn u64(&mut self) -> Result<u64, String> {
        self.array().map(u64::from_be_bytes)
    }

    /// 32 bits in version 0 of a box, 64 in version 1.
    pub(super) fn long(&mut self, version: u8) -> Result<u64, String> {
        if version == 0 { self.u32().map(u64::from) } else { self.u64() }
    }

    /// A counted list of rows of `N` bytes. A count that is larger than the bytes allow is an error.
    pub(super) fn rows<const N: usize>(&mut self) -> Result<impl Iterator<Item = [u8; N]> + use<'a, N>, String> {
        let count = self.u32()? as usize;
        let bytes = count.checked_mul(N).ok_or("is too short")?;
        Ok(self.bytes(bytes)?.chunks_exact(N).filter_map(|row| row.try_into().ok()))
    }
}

/// Adds the name of the box to an error message.
pub(super) fn within(kind: &'static str) -> impl Fn(String) -> String {
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
        let found: Vec<_> = boxes(&bytes).map(|found| (name(&found.kind), found.body.to_vec())).collect();
        assert_eq!(found, [("abcd".to_owned(), vec![7]), ("long".to_owned(), vec![8])]);
    }

    #[test]
    fn a_box_larger_than_its_container_is_none() {
        assert_eq!(boxes(b"\0\0\0\x0aabcd\x07").count(), 0);
        assert_eq!(boxes(b"\0\0\0\x07abcd\x07").count(), 0);
        assert_eq!(boxes(b"\0\0\0\x01abcd\xff\xff\xff\xff\xff\xff\xff\xff").count(), 0);
    }

    #[test]
    fn a_list_cannot_claim_more_than_there_is() {
        assert!(Fields::new(&[0xff; 8]).rows::<8>().is_err());
        assert_eq!(Fields::new(&[0, 0, 0, 1, 5, 6]).rows::<2>().unwrap().next(), Some([5, 6]));
    }
}
