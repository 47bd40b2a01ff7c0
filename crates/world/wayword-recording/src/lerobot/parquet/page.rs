//! Pages: the pieces of a column that are compressed and encoded as one.

use super::{
    footer::{Codec, Leaf, Physical},
    hybrid::Hybrid,
    thrift::{self, Thing},
    unfold::unfold,
};
use std::ops::Range;

/// Pages may unfold to this much, bytes: writers close them at 1 MiB.
const USUAL_BYTES: u64 = 8 << 20;
/// And larger ones to this many times of what they are compressed.
const MAX_RATIO: u64 = 256;

/// What stands before a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Header {
    pub(super) kind: Kind,
    /// Of its bytes in the file, and unfolded.
    pub(super) compressed: u64,
    unfolded: u64,
    /// Number of values, or of entries of a dictionary; those that are missing count.
    pub(super) values: u64,
    encoding: i64,
    /// Of the levels at the front of the second version's pages, bytes: repetition, definition.
    levels: (u64, u64),
    /// The second version's pages may be stored as they are.
    folded: bool,
}

/// Kinds of pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Dictionary,
    /// Values, in the first or second version's layout.
    Values,
    Values2,
    /// None that has to be read.
    Other,
}

impl Header {
    /// Reads a header; also returns its length.
    ///
    /// # Errors
    /// When it is none, or announces more than a page can hold.
    pub(super) fn read(bytes: &[u8]) -> Result<(Self, usize), String> {
        let (thing, length) = thrift::read(bytes)?;
        let (kind, about) = match thing.number(1) {
            Some(0) => (Kind::Values, thing.field(5)),
            Some(2) => (Kind::Dictionary, thing.field(7)),
            Some(3) => (Kind::Values2, thing.field(8)),
            _ => (Kind::Other, None),
        };
        let compressed = thing.count(3).ok_or("a page has no length")?;
        let unfolded = thing.count(2).ok_or("a page has no unfolded length")?;
        if unfolded > USUAL_BYTES.max(compressed.saturating_mul(MAX_RATIO)) {
            return Err(format!("a page of {compressed} bytes is to unfold to {unfolded}"));
        }
        let nothing = Thing::Fields(Vec::new());
        let about = about.unwrap_or(&nothing);
        let second = kind == Kind::Values2;
        let header = Self {
            kind,
            compressed,
            unfolded,
            values: about.count(1).unwrap_or(0),
            encoding: about.number(if second { 4 } else { 2 }).unwrap_or(-1),
            levels: if second { (about.count(6).unwrap_or(0), about.count(5).unwrap_or(0)) } else { (0, 0) },
            folded: !second || about.number(7).unwrap_or(1) != 0,
        };
        Ok((header, length))
    }

    /// A page's bytes as they were before they were compressed.
    fn unfold(&self, codec: Codec, bytes: Vec<u8>) -> Result<Vec<u8>, String> {
        if codec == Codec::None || !self.folded {
            return Ok(bytes);
        }
        // Levels of the second version are not compressed.
        let front = usize::try_from(self.levels.0.saturating_add(self.levels.1)).unwrap_or(usize::MAX);
        let too_long = "levels are longer than their page";
        let (levels, folded) = bytes.split_at_checked(front).ok_or(too_long)?;
        let size = usize::try_from(self.unfolded).ok().filter(|size| *size >= front).ok_or(too_long)?;
        let mut unfolded = levels.to_vec();
        unfolded.resize(size, 0);
        // Where all values are missing, there is nothing that was compressed.
        if size > front {
            unfold(codec, folded, &mut unfolded[front..])?;
        }
        Ok(unfolded)
    }
}

/// Entries that values are numbers of.
#[derive(Debug)]
pub(super) struct Dictionary {
    bytes: Vec<u8>,
    places: Vec<Range<usize>>,
}

impl Dictionary {
    /// Unfolds a dictionary's page.
    pub(super) fn new(header: &Header, codec: Codec, leaf: &Leaf, bytes: Vec<u8>) -> Result<Self, String> {
        let bytes = header.unfold(codec, bytes)?;
        let (mut at, mut places) = (0, Vec::new());
        for _ in 0..header.values {
            let place = plain(leaf.physical, &bytes, at)?;
            at = place.end;
            places.push(place);
        }
        Ok(Self { bytes, places })
    }

    fn entry(&self, number: u32) -> Result<&[u8], String> {
        let place = self.places.get(number as usize).cloned();
        let place = place.ok_or_else(|| format!("entry {number} of a dictionary of {}", self.places.len()))?;
        Ok(&self.bytes[place])
    }
}

/// A page of values, read one after another.
#[derive(Debug)]
pub(super) struct Page {
    bytes: Vec<u8>,
    /// Values that have not been read.
    pub(super) left: u64,
    repetition: Option<Hybrid>,
    definition: Option<Hybrid>,
    max_definition: u32,
    values: Values,
}

#[derive(Debug)]
enum Values {
    /// One after another, the next from a byte on.
    Plain(Physical, usize),
    /// Numbers of a dictionary's entries.
    Numbers(Hybrid),
}

/// A value of a column, or that there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell<'a> {
    /// It is the first of a row.
    pub(super) begins_row: bool,
    pub(super) value: Option<&'a [u8]>,
}

impl Page {
    /// Unfolds a page of values.
    pub(super) fn new(header: &Header, codec: Codec, leaf: &Leaf, bytes: Vec<u8>) -> Result<Self, String> {
        let bytes = header.unfold(codec, bytes)?;
        let second = header.kind == Kind::Values2;
        let (mut at, end) = (0, bytes.len());
        let mut levels = |max: u32, length: u64| -> Result<Option<Hybrid>, String> {
            if max == 0 && !second {
                return Ok(None);
            }
            // The first version writes each length before its levels.
            let (from, length) = if second { (at, length) } else { (at + 4, length_at(&bytes, at)? as u64) };
            let to = usize::try_from(length).ok().and_then(|length| from.checked_add(length)).filter(|to| *to <= end);
            at = to.ok_or_else(|| format!("levels of {length} bytes in a page of {end}"))?;
            Ok((max > 0).then(|| Hybrid::new(from..at, u32::BITS - max.leading_zeros())))
        };
        let repetition = levels(leaf.max_repetition, header.levels.0)?;
        let definition = levels(leaf.max_definition, header.levels.1)?;
        let values = match header.encoding {
            0 => Values::Plain(leaf.physical, at),
            2 | 8 => {
                // The width stands in a byte of its own; without values there may be none.
                let width = bytes.get(at).copied().unwrap_or(0);
                let width =
                    Some(u32::from(width)).filter(|width| *width <= u32::BITS).ok_or("numbers of more than 32 bits")?;
                Values::Numbers(Hybrid::new(at + 1..end, width))
            }
            other => {
                return Err(format!("values are encoded in way {other} of parquet.thrift, which is not read here"));
            }
        };
        Ok(Self { bytes, left: header.values, repetition, definition, max_definition: leaf.max_definition, values })
    }

    /// The next value; not to be called when none is left.
    ///
    /// # Errors
    /// When it is not there, or in no dictionary.
    pub(super) fn next<'a>(&'a mut self, dictionary: Option<&'a Dictionary>) -> Result<Cell<'a>, String> {
        let Self { bytes, left, repetition, definition, max_definition, values } = self;
        *left = left.saturating_sub(1);
        let begins_row = match repetition {
            Some(levels) => levels.next(bytes)? == 0,
            None => true,
        };
        let there = match definition {
            Some(levels) => levels.next(bytes)? == *max_definition,
            None => true,
        };
        if !there {
            return Ok(Cell { begins_row, value: None });
        }
        let value = match values {
            Values::Plain(physical, at) => {
                let place = plain(*physical, bytes, *at)?;
                *at = place.end;
                &bytes[place]
            }
            Values::Numbers(numbers) => {
                let number = numbers.next(bytes)?;
                dictionary.ok_or("there is no dictionary before the first page")?.entry(number)?
            }
        };
        Ok(Cell { begins_row, value: Some(value) })
    }
}

/// Where a value lies that is stored as it is, from a byte on.
fn plain(physical: Physical, bytes: &[u8], at: usize) -> Result<Range<usize>, String> {
    let (from, size) = match physical.size() {
        Some(size) => (at, size),
        None if physical == Physical::Bytes => (at + 4, length_at(bytes, at)?),
        None => return Err("holds values of a kind that is not read here".to_owned()),
    };
    let end = from.checked_add(size).filter(|end| *end <= bytes.len());
    end.map(|end| from..end).ok_or_else(|| format!("byte {at} of a page: a value of {size} bytes, of {}", bytes.len()))
}

fn length_at(bytes: &[u8], at: usize) -> Result<usize, String> {
    let length = bytes.get(at..).and_then(|rest| rest.first_chunk::<4>());
    length.map(|length| u32::from_le_bytes(*length) as usize).ok_or_else(|| format!("byte {at} of a page: ends early"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Before a page of values: stored in 20 bytes, and unfolded to a number of bytes.
    fn header(unfolded: &[u8]) -> Result<Header, String> {
        let bytes = [&[0x15, 0, 0x15], unfolded, &[0x15, 40, 0x2c, 0x15, 2, 0x15, 0, 0, 0]].concat();
        Header::read(&bytes).map(|(header, length)| {
            assert_eq!(length, bytes.len());
            header
        })
    }

    fn leaf(physical: Physical) -> Leaf {
        Leaf { path: vec!["x".to_owned()], physical, max_definition: 0, max_repetition: 0 }
    }

    #[test]
    fn a_page_that_is_to_become_too_large_is_refused() {
        let usual = header(&[0x50]).unwrap();
        assert_eq!((usual.kind, usual.compressed, usual.unfolded, usual.values), (Kind::Values, 20, 40, 1));
        let gigabyte = header(&[0x80, 0x80, 0x80, 0x80, 0x08]);
        assert_eq!(gigabyte, Err("a page of 20 bytes is to unfold to 1073741824".to_owned()));
    }

    #[test]
    fn entries_of_a_dictionary_must_be_there() {
        let many = Header { kind: Kind::Dictionary, values: u64::MAX, ..header(&[0x50]).unwrap() };
        for physical in [Physical::Double, Physical::Bytes, Physical::Other] {
            assert!(Dictionary::new(&many, Codec::None, &leaf(physical), vec![0; 40]).is_err());
        }
        let two = Header { values: 2, ..many };
        let dictionary = Dictionary::new(&two, Codec::None, &leaf(Physical::Int32), vec![7; 8]).unwrap();
        assert_eq!(dictionary.entry(1), Ok(&[7; 4][..]));
        assert_eq!(dictionary.entry(2), Err("entry 2 of a dictionary of 2".to_owned()));
    }

    #[test]
    fn a_page_without_its_dictionary_is_refused() {
        let numbers = Header { encoding: 8, ..header(&[0x50]).unwrap() };
        let mut page = Page::new(&numbers, Codec::None, &leaf(Physical::Int32), vec![1, 2, 0]).unwrap();
        assert!(page.next(None).unwrap_err().contains("no dictionary"));
    }
}
