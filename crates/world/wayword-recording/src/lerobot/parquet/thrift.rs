//! Thrift's compact protocol, in which Parquet writes what it says about itself.

/// Deepest nesting: a footer's is 6 deep, so whatever goes deeper is no footer.
const MAX_DEPTH: usize = 16;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Thing<'a> {
    /// A whole number, or a truth (0 or 1).
    Number(i64),
    /// A text or bytes.
    Bytes(&'a [u8]),
    /// A list or set.
    List(Vec<Thing<'a>>),
    /// A struct: its fields by number.
    Fields(Vec<(i16, Thing<'a>)>),
    /// A fraction; Parquet has none that matters here.
    Fraction,
}

impl<'a> Thing<'a> {
    /// A field of a struct.
    pub(super) fn field(&self, number: i16) -> Option<&Thing<'a>> {
        let Self::Fields(fields) = self else { return None };
        fields.iter().find(|(at, _)| *at == number).map(|(_, value)| value)
    }

    /// A field that is a whole number.
    pub(super) fn number(&self, field: i16) -> Option<i64> {
        match self.field(field) {
            Some(Self::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// A field that is a count or a size.
    pub(super) fn count(&self, field: i16) -> Option<u64> {
        self.number(field).and_then(|number| u64::try_from(number).ok())
    }

    /// A field that is a text.
    pub(super) fn text(&self, field: i16) -> Option<&'a str> {
        match self.field(field) {
            Some(Self::Bytes(bytes)) => std::str::from_utf8(bytes).ok(),
            _ => None,
        }
    }

    /// A field that is a list; empty where there is none.
    pub(super) fn list(&self, field: i16) -> &[Thing<'a>] {
        match self.field(field) {
            Some(Self::List(list)) => list,
            _ => &[],
        }
    }
}

/// Reads a struct from the beginning of some bytes; also returns how many bytes it takes.
///
/// # Errors
/// With the byte where it cannot be read on.
pub(super) fn read(bytes: &[u8]) -> Result<(Thing<'_>, usize), String> {
    let mut reader = Reader { bytes, at: 0 };
    let fields = reader.fields(0)?;
    Ok((fields, reader.at))
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let taken = rest.get(..count).ok_or_else(|| format!("byte {}: ends early", self.at))?;
        self.at += count;
        Ok(taken)
    }

    fn unsigned(&mut self) -> Result<u64, String> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(format!("byte {}: a number of more than 64 bits", self.at))
    }

    /// Zigzag: the sign is the lowest bit.
    fn signed(&mut self) -> Result<i64, String> {
        let value = self.unsigned()?;
        Ok((value >> 1) as i64 ^ -((value & 1) as i64))
    }

    fn length(&mut self) -> Result<usize, String> {
        let length = self.unsigned()?;
        let rest = self.bytes.len() - self.at;
        // Every element takes at least a byte.
        usize::try_from(length)
            .ok()
            .filter(|length| *length <= rest)
            .ok_or_else(|| format!("byte {}: announces {length} where {rest} bytes are left", self.at))
    }

    fn fields(&mut self, depth: usize) -> Result<Thing<'a>, String> {
        let mut fields = Vec::new();
        let mut number = 0_i16;
        loop {
            let header = self.byte()?;
            let kind = header & 0x0f;
            if kind == 0 {
                return Ok(Thing::Fields(fields));
            }
            number = match header >> 4 {
                0 => i16::try_from(self.signed()?).map_err(|_| format!("byte {}: no number of a field", self.at))?,
                step => number.saturating_add(i16::from(step)),
            };
            let value = match kind {
                1 | 2 => Thing::Number(i64::from(kind == 1)),
                _ => self.value(kind, depth + 1)?,
            };
            fields.push((number, value));
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Result<Thing<'a>, String> {
        if depth > MAX_DEPTH {
            return Err(format!("byte {}: nested more than {MAX_DEPTH} deep", self.at));
        }
        match kind {
            // In lists a truth is a byte.
            1 | 2 => Ok(Thing::Number(i64::from(self.byte()? == 1))),
            3 => Ok(Thing::Number(i64::from(self.byte()?.cast_signed()))),
            4..=6 => self.signed().map(Thing::Number),
            7 => self.take(8).map(|_| Thing::Fraction),
            8 => {
                let length = self.length()?;
                self.take(length).map(Thing::Bytes)
            }
            9 | 10 => self.elements(depth),
            12 => self.fields(depth),
            other => Err(format!("byte {}: values of kind {other} are not known", self.at)),
        }
    }

    fn elements(&mut self, depth: usize) -> Result<Thing<'a>, String> {
        let header = self.byte()?;
        let count = match header >> 4 {
            15 => self.length()?,
            few => usize::from(few),
        };
        // What is announced is not reserved: it may not be there.
        let elements = (0..count).map(|_| self.value(header & 0x0f, depth + 1));
        elements.collect::<Result<_, _>>().map(Thing::List)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_texts_lists_and_structs_are_read() {
        // 1: i32 = -3; 2: "ab"; 3: [i32 1, 2]; 5: true; 6: { 1: i64 300 }; end.
        let bytes = [0x15, 5, 0x18, 2, b'a', b'b', 0x19, 0x25, 2, 4, 0x21, 0x1c, 0x16, 0xd8, 4, 0, 0, 99];
        let (thing, length) = read(&bytes).unwrap();
        assert_eq!(length, bytes.len() - 1);
        assert_eq!((thing.number(1), thing.count(1)), (Some(-3), None));
        assert_eq!(thing.text(2), Some("ab"));
        assert_eq!(thing.list(3), [Thing::Number(1), Thing::Number(2)]);
        assert_eq!(thing.number(5), Some(1));
        assert_eq!(thing.field(6).and_then(|inner| inner.count(1)), Some(300));
    }

    #[test]
    fn what_is_announced_must_be_there() {
        assert!(read(&[0x18, 0xff, 0xff, 0xff, 0x7f]).unwrap_err().contains("announces"));
        assert!(read(&[0x19, 0xf5, 0xff, 0xff, 0xff, 0x7f]).unwrap_err().contains("announces"));
        assert!(read(&[0x1c; 100_000]).unwrap_err().contains("deep"));
        assert!(read(&[0x19; 100_000]).unwrap_err().contains("deep"));
        assert!(read(&[0x15]).unwrap_err().contains("byte 1: ends early"));
    }

    proptest! {
        #[test]
        fn no_bytes_are_too_much(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            if let Ok((_, length)) = read(&bytes) {
                prop_assert!(length <= bytes.len());
            }
        }
    }
}
