//! Parquet's hybrid of runs and packed bits, for levels and for numbers of dictionary entries
//! (apache/parquet-format, Encodings.md, "RLE/Bit-Packing Hybrid").

use std::ops::Range;

/// Where the reading of such numbers has come to. It holds no bytes; they are lent to each step.
#[derive(Debug, Clone)]
pub(super) struct Hybrid {
    at: usize,
    end: usize,
    width_bits: u32,
    run: Run,
}

#[derive(Debug, Clone, Copy)]
enum Run {
    /// One number, again and again.
    Same { left: u64, value: u32 },
    /// One number after another, from a bit on.
    Packed { left: u64, bit: usize },
}

impl Hybrid {
    /// Numbers of some bits (at most 32) in a range of a page's bytes.
    pub(super) fn new(range: Range<usize>, width_bits: u32) -> Self {
        Self { at: range.start, end: range.end, width_bits, run: Run::Same { left: 0, value: 0 } }
    }

    /// The next number.
    ///
    /// # Errors
    /// When there is none.
    pub(super) fn next(&mut self, page: &[u8]) -> Result<u32, String> {
        loop {
            match &mut self.run {
                Run::Same { left, value } if *left > 0 => {
                    *left -= 1;
                    return Ok(*value);
                }
                Run::Packed { left, bit } if *left > 0 => {
                    let value = packed(page, *bit, self.width_bits).ok_or("packed numbers end early")?;
                    (*left, *bit) = (*left - 1, *bit + self.width_bits as usize);
                    return Ok(value);
                }
                _ => self.run = self.begin(page)?,
            }
        }
    }

    fn begin(&mut self, page: &[u8]) -> Result<Run, String> {
        let bytes = page.get(..self.end).unwrap_or_default();
        let mut header = 0_u64;
        for shift in (0..35).step_by(7) {
            let byte = *bytes.get(self.at).ok_or("there are fewer numbers than announced")?;
            self.at += 1;
            header |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                break;
            }
        }
        let count = header >> 1;
        if header & 1 == 1 {
            let run = Run::Packed { left: count * 8, bit: self.at * 8 };
            let length = count.saturating_mul(u64::from(self.width_bits));
            self.at = usize::try_from(length).map_or(usize::MAX, |length| self.at.saturating_add(length));
            return Ok(run);
        }
        let length = self.width_bits.div_ceil(8) as usize;
        let value = bytes.get(self.at..self.at.saturating_add(length)).ok_or("a run ends early")?;
        self.at += length;
        let value = value.iter().rev().fold(0, |value, byte| value << 8 | u32::from(*byte));
        Ok(Run::Same { left: count, value })
    }
}

/// A number of some bits, the lowest first.
fn packed(bytes: &[u8], bit: usize, width_bits: u32) -> Option<u32> {
    if width_bits == 0 {
        return Some(0);
    }
    let first = bit / 8;
    let last = (bit + width_bits as usize - 1) / 8;
    let word = bytes.get(first..=last)?.iter().rev().fold(0_u64, |word, byte| word << 8 | u64::from(*byte));
    let mask = (1_u64 << width_bits) - 1;
    u32::try_from(word >> (bit % 8) & mask).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_example_of_the_format_is_read() {
        // 0 to 7 of three bits: Encodings.md.
        let page = [0b0000_0011, 0b1000_1000, 0b1100_0110, 0b1111_1010];
        let mut numbers = Hybrid::new(0..4, 3);
        assert!((0..8).all(|expected| numbers.next(&page) == Ok(expected)));
        assert!(numbers.next(&page).is_err());
    }

    #[test]
    fn a_run_repeats_its_number() {
        let page = [0, 6, 0x34, 0x12, 0];
        let mut numbers = Hybrid::new(1..4, 13);
        assert!((0..3).all(|_| numbers.next(&page) == Ok(0x1234)));
        assert!(numbers.next(&page).is_err());
    }

    #[test]
    fn numbers_without_bits_are_zero() {
        let mut numbers = Hybrid::new(0..1, 0);
        assert_eq!(numbers.next(&[3]), Ok(0));
    }

    /// As a writer would: runs of one number, or packed in eights.
    fn written(numbers: &[u32], width_bits: u32) -> Vec<u8> {
        let mut page = Vec::new();
        for eight in numbers.chunks(8) {
            if eight.iter().all(|number| *number == eight[0]) {
                page.push((eight.len() << 1) as u8);
                page.extend(&eight[0].to_le_bytes()[..width_bits.div_ceil(8) as usize]);
                continue;
            }
            page.push(3);
            let mut bits = vec![0_u8; width_bits as usize];
            for (at, number) in eight.iter().enumerate() {
                for bit in (0..width_bits as usize).filter(|bit| number >> bit & 1 == 1) {
                    let at = at * width_bits as usize + bit;
                    bits[at / 8] |= 1 << (at % 8);
                }
            }
            page.extend(bits);
        }
        page
    }

    proptest! {
        #[test]
        fn what_was_written_is_read(
            (width_bits, numbers) in (1_u32..=32).prop_flat_map(|width_bits| {
                let number = 0..=u32::MAX >> (32 - width_bits);
                (Just(width_bits), prop::collection::vec(prop_oneof![number, Just(1)], 1..100))
            })
        ) {
            let page = written(&numbers, width_bits);
            let mut read = Hybrid::new(0..page.len(), width_bits);
            for number in numbers {
                prop_assert_eq!(read.next(&page), Ok(number));
            }
        }

        #[test]
        fn no_bytes_are_too_much(page in prop::collection::vec(any::<u8>(), 0..50), width_bits in 0_u32..=32, end in 0_usize..60) {
            let mut numbers = Hybrid::new(0..end, width_bits);
            for _ in 0..100 {
                if numbers.next(&page).is_err() {
                    break;
                }
            }
        }
    }
}
