//! Reads CDR (Common Data Representation), the encoding of ROS 2 messages (OMG DDSI-RTPS 2.5, section 10.2; DDS-XTypes 1.3,
//! section 7.4.1).
//!
//! The first four bytes give the byte order. Each number after them is aligned to its own size, counted from the end of
//! these four.

/// Bytes at the beginning that contain the byte order.
const ENCAPSULATION_BYTES: usize = 4;
/// The magic number of Zstandard (RFC 8878).
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// A message that is read from front to back. Errors give the byte of the message.
pub(crate) struct CdrReader<'a> {
    body: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> CdrReader<'a> {
    /// Begins to read a message.
    ///
    /// # Errors
    /// When it is too short, or not plain CDR.
    pub(crate) fn new(message: &'a [u8]) -> Result<Self, String> {
        let (head, body) =
            message.split_first_chunk::<ENCAPSULATION_BYTES>().ok_or("byte 0: is too short for a message")?;
        if *head == ZSTD_MAGIC {
            let why =
                "each message is compressed by itself; write the bag again with `--compression-mode file` or `none`";
            return Err(format!("byte 0: {why} (`ros2 bag convert`)"));
        }
        match *head {
            [0, byte_order @ (0 | 1), ..] => Ok(Self { body, at: 0, big_endian: byte_order == 0 }),
            [first, second, ..] => Err(format!("byte 0: is written as {first:#04x}{second:02x}, not as plain CDR")),
        }
    }

    pub(crate) fn read_u8(&mut self) -> Result<u8, String> {
        self.read_number().map(u8::from_le_bytes)
    }

    pub(crate) fn read_u32(&mut self) -> Result<u32, String> {
        Ok(u32::from_le_bytes(self.read_number()?))
    }

    pub(crate) fn read_i32(&mut self) -> Result<i32, String> {
        Ok(i32::from_le_bytes(self.read_number()?))
    }

    pub(crate) fn read_f64(&mut self) -> Result<f64, String> {
        Ok(f64::from_le_bytes(self.read_number()?))
    }

    /// `COUNT` numbers.
    pub(crate) fn read_f64s<const COUNT: usize>(&mut self) -> Result<[f64; COUNT], String> {
        let mut numbers = [0.0; COUNT];
        for number in &mut numbers {
            *number = self.read_f64()?;
        }
        Ok(numbers)
    }

    /// A text; bytes that are not UTF-8 are replaced.
    pub(crate) fn read_text(&mut self) -> Result<String, String> {
        let bytes = self.read_bytes()?;
        // The length includes the zero at the end, which some writers leave out of an empty text.
        Ok(String::from_utf8_lossy(bytes.strip_suffix(&[0]).unwrap_or(bytes)).into_owned())
    }

    /// A sequence of bytes.
    pub(crate) fn read_bytes(&mut self) -> Result<&'a [u8], String> {
        let length = self.read_u32()?;
        self.take_bytes(usize::try_from(length).unwrap_or(usize::MAX))
    }

    /// The number of items of a sequence, each of at least `item_bytes` bytes.
    pub(crate) fn read_count(&mut self, item_bytes: usize) -> Result<usize, String> {
        let (count, at) = (self.read_u32()?, self.at);
        let room = (self.body.len() - self.at) / item_bytes.max(1);
        usize::try_from(count).ok().filter(|count| *count <= room).ok_or_else(|| {
            format!("byte {}: the number of items is {count}, but at most {room} fit", ENCAPSULATION_BYTES + at - 4)
        })
    }

    /// A number's bytes, least significant first.
    fn read_number<const BYTES: usize>(&mut self) -> Result<[u8; BYTES], String> {
        let padding = self.at.wrapping_neg() % BYTES;
        self.take_bytes(padding)?;
        let mut number = [0; BYTES];
        number.copy_from_slice(self.take_bytes(BYTES)?);
        if self.big_endian {
            number.reverse();
        }
        Ok(number)
    }

    fn take_bytes(&mut self, count: usize) -> Result<&'a [u8], String> {
        let rest = self.body.get(self.at..).unwrap_or_default();
        let taken = rest.get(..count).ok_or_else(|| {
            let at = ENCAPSULATION_BYTES + self.at;
            format!("byte {at}: the message ends too early (bytes expected: {count}, left: {})", rest.len())
        })?;
        self.at += count;
        Ok(taken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn numbers_lie_at_multiples_of_their_size_behind_the_first_four_bytes() {
        let mut message = vec![0, 1, 0, 0, 7, 0xff, 0xff, 0xff];
        message.extend(0xfffe_u32.to_le_bytes());
        message.extend(2.5_f64.to_le_bytes());
        message.extend([3, 0, 0, 0, b'h', b'i', 0]);
        let mut cdr = CdrReader::new(&message).unwrap();
        assert_eq!((cdr.read_u8(), cdr.read_u32(), cdr.read_f64()), (Ok(7), Ok(0xfffe), Ok(2.5)));
        assert_eq!(cdr.read_text().unwrap(), "hi");
        assert!(cdr.read_u8().unwrap_err().starts_with("byte 27"));
    }

    #[test]
    fn the_other_byte_order_is_read_too() {
        let mut message = vec![0, 0, 0, 0];
        message.extend((-3_i32).to_be_bytes());
        message.extend([0xff; 4]);
        message.extend(0.5_f64.to_be_bytes());
        let mut cdr = CdrReader::new(&message).unwrap();
        assert_eq!((cdr.read_i32(), cdr.read_f64()), (Ok(-3), Ok(0.5)));
    }

    #[test]
    fn lengths_that_lie_and_other_ways_of_writing_are_refused() {
        assert!(CdrReader::new(&[0, 3, 0, 0]).err().unwrap().contains("0x0003"));
        let long = [0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, b'x'];
        assert!(
            CdrReader::new(&long).unwrap().read_text().unwrap_err().contains("bytes expected: 4294967295, left: 1")
        );
        assert!(CdrReader::new(&long).unwrap().read_count(8).unwrap_err().contains("at most 0 fit"));
        // ROS 2 writes an empty text with the length 1; others with 0.
        assert_eq!(CdrReader::new(&[0, 1, 0, 0, 0, 0, 0, 0]).unwrap().read_text().unwrap(), "");
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(message in prop::collection::vec(any::<u8>(), 0..64)) {
            if let Ok(mut cdr) = CdrReader::new(&message) {
                let _ = (cdr.read_u8(), cdr.read_text(), cdr.read_f64(), cdr.read_count(3), cdr.read_bytes(), cdr.read_f64s::<3>());
            }
        }
    }
}
