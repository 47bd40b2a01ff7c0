//! What an H.264 stream says of itself: sequence parameter sets (ITU-T H.264, section 7.3.2.1.1 and annex E).

use super::colour::Colour;

/// Profiles whose parameter sets say how colours are sampled.
const HIGH_PROFILES: [u32; 12] = [100, 110, 122, 244, 44, 83, 86, 118, 128, 138, 139, 134];

/// The part of a sequence parameter set that matters here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Sps {
    /// Coded, which may be a little more than is shown.
    pub(super) width_px: u32,
    pub(super) height_px: u32,
    /// 0 is grey, 1 is 4:2:0.
    pub(super) chroma_format: u32,
    pub(super) bits: u32,
    /// Whether rows of a picture are coded in two halves.
    pub(super) is_interlaced: bool,
    pub(super) colour: Colour,
}

impl Sps {
    /// Reads a NAL unit of type 7; `None` where it is broken.
    pub(super) fn read(unit: &[u8]) -> Option<Self> {
        let mut bits = Bits::new(unit.get(1..)?);
        let profile = bits.read(8)?;
        bits.read(16)?;
        bits.code()?;
        let (mut chroma_format, mut depth) = (1, 8);
        if HIGH_PROFILES.contains(&profile) {
            (chroma_format, depth) = sampling(&mut bits)?;
        }
        bits.code()?;
        order(&mut bits)?;
        bits.code()?;
        bits.read(1)?;
        let width = bits.code()?.checked_add(1)?.checked_mul(16)?;
        let height = bits.code()?.checked_add(1)?.checked_mul(16)?;
        let is_interlaced = bits.read(1)? == 0;
        if is_interlaced {
            bits.read(1)?;
        }
        bits.read(1)?;
        if bits.read(1)? == 1 {
            for _ in 0..4 {
                bits.code()?;
            }
        }
        let height_px = if is_interlaced { height.checked_mul(2)? } else { height };
        // Parameters of use end where they are broken off.
        let colour = if bits.read(1)? == 1 { usability(&mut bits).unwrap_or_default() } else { Colour::default() };
        Some(Self { width_px: width, height_px, chroma_format, bits: depth, is_interlaced, colour })
    }
}

/// Chroma format and bits of a sample, of the higher profiles.
fn sampling(bits: &mut Bits<'_>) -> Option<(u32, u32)> {
    let chroma_format = bits.code()?;
    if chroma_format == 3 {
        bits.read(1)?;
    }
    let depth = bits.code()?.max(bits.code()?).checked_add(8)?;
    bits.read(1)?;
    if bits.read(1)? == 1 {
        let lists = if chroma_format == 3 { 12 } else { 8 };
        for list in 0..lists {
            if bits.read(1)? == 1 {
                skip_scaling_list(bits, if list < 6 { 16 } else { 64 })?;
            }
        }
    }
    Some((chroma_format, depth))
}

/// Section 7.3.2.1.1.1.
fn skip_scaling_list(bits: &mut Bits<'_>, size: u32) -> Option<()> {
    let (mut last, mut next) = (8, 8);
    for _ in 0..size {
        if next != 0 {
            next = (last + bits.signed()?).rem_euclid(256);
        }
        last = if next == 0 { last } else { next };
    }
    Some(())
}

/// How the order of pictures is coded.
fn order(bits: &mut Bits<'_>) -> Option<()> {
    match bits.code()? {
        0 => {
            bits.code()?;
        }
        1 => {
            bits.read(1)?;
            bits.signed()?;
            bits.signed()?;
            for _ in 0..bits.code()?.min(255) {
                bits.signed()?;
            }
        }
        _ => {}
    }
    Some(())
}

/// Annex E.1.1, up to the colours.
fn usability(bits: &mut Bits<'_>) -> Option<Colour> {
    if bits.read(1)? == 1 && bits.read(8)? == 255 {
        bits.read(32)?;
    }
    if bits.read(1)? == 1 {
        bits.read(1)?;
    }
    let mut colour = Colour::default();
    if bits.read(1)? == 1 {
        bits.read(3)?;
        colour.full_range = Some(bits.read(1)? == 1);
        if bits.read(1)? == 1 {
            bits.read(16)?;
            colour.matrix = Colour::coded(bits.read(8)?);
        }
    }
    Some(colour)
}

/// Bits of a NAL unit, from which the bytes against false starts are taken out (section 7.4.1).
struct Bits<'a> {
    bytes: std::slice::Iter<'a, u8>,
    zeros: u32,
    current: u8,
    left: u32,
}

impl<'a> Bits<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { bytes: bytes.iter(), zeros: 0, current: 0, left: 0 }
    }

    fn byte(&mut self) -> Option<u8> {
        let mut byte = *self.bytes.next()?;
        if self.zeros >= 2 && byte == 3 {
            self.zeros = 0;
            byte = *self.bytes.next()?;
        }
        self.zeros = if byte == 0 { self.zeros + 1 } else { 0 };
        Some(byte)
    }

    /// A number of up to 32 bits.
    fn read(&mut self, count: u32) -> Option<u32> {
        let mut number = 0;
        for _ in 0..count {
            if self.left == 0 {
                (self.current, self.left) = (self.byte()?, 8);
            }
            self.left -= 1;
            number = number << 1 | u32::from(self.current >> self.left & 1);
        }
        Some(number)
    }

    /// An unsigned Exp-Golomb code (section 9.1).
    fn code(&mut self) -> Option<u32> {
        let mut zeros = 0;
        while self.read(1)? == 0 {
            zeros += 1;
            if zeros > 31 {
                return None;
            }
        }
        Some(((1_u64 << zeros) - 1) as u32 + self.read(zeros)?)
    }

    /// A signed Exp-Golomb code.
    fn signed(&mut self) -> Option<i32> {
        let code = i64::from(self.code()?);
        let size = (code + 1) / 2;
        i32::try_from(if code % 2 == 1 { size } else { -size }).ok().filter(|number| number.abs() < 1 << 30)
    }
}
