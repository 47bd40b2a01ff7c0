//! The common interface of the decoders of all codecs. A sample is one coded picture, as it lies in the file.

use super::colour::PicturePlanes;
use crate::picture_size;

/// A sample on its way into a decoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct CodedSample<'a> {
    /// Its index in the order of decoding.
    pub(super) sample: usize,
    /// The time at which it is shown, ticks.
    pub(super) shown: i64,
    pub(super) bytes: &'a [u8],
}

/// Receives the planes of a picture, with the sample that it came from.
pub(super) type TakePlanes<'a> = dyn FnMut(usize, &PicturePlanes<'_>) -> Result<(), String> + 'a;

/// A decoder of one stream.
pub(super) trait SampleDecoder {
    /// Takes the next sample, and hands out the pictures that are ready. The caller may skip samples, if decoding can begin with
    /// the sample after them.
    fn feed(&mut self, coded: CodedSample<'_>, out: &mut TakePlanes<'_>) -> Result<(), String>;

    /// Hands out the remaining pictures after the last sample.
    fn finish(&mut self, out: &mut TakePlanes<'_>) -> Result<(), String>;
}

/// Refuses pictures that are larger than any camera's.
pub(super) fn check_picture_size(width_px: u32, height_px: u32) -> Result<(), String> {
    if picture_size::is_possible(width_px, height_px) {
        Ok(())
    } else {
        Err(format!("has pictures of {width_px} x {height_px} pixels, which is too large"))
    }
}
