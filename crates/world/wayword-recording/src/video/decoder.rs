//! What the decoders of all codecs have in common.

use super::colour::Planes;
use crate::size;

/// A sample on its way into a decoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coded<'a> {
    /// Its place in the order of decoding.
    pub(super) sample: usize,
    /// When it is shown, ticks.
    pub(super) shown: i64,
    pub(super) bytes: &'a [u8],
}

/// Who is handed a picture: the sample that it was, and its planes.
pub(super) type Out<'a> = dyn FnMut(usize, &Planes<'_>) -> Result<(), String> + 'a;

/// A decoder of one stream.
pub(super) trait Decode {
    /// Takes the next sample, and hands out what can be shown now. Samples may be left out before one with which decoding can
    /// begin.
    fn feed(&mut self, coded: Coded<'_>, out: &mut Out<'_>) -> Result<(), String>;

    /// Hands out what is left when nothing more comes.
    fn finish(&mut self, out: &mut Out<'_>) -> Result<(), String>;
}

/// Refuses pictures of sizes that no camera has.
pub(super) fn size_is_possible(width_px: u32, height_px: u32) -> Result<(), String> {
    if size::is_possible(width_px, height_px) {
        Ok(())
    } else {
        Err(format!("has pictures of {width_px} x {height_px} pixels, which is too large"))
    }
}
