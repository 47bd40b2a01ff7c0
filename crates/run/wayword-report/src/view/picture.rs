//! Encodes pictures as PNG and JPEG.

use image::{
    ExtendedColorType, ImageEncoder, ImageError,
    codecs::{jpeg::JpegEncoder, png::PngEncoder},
};
use wayword_core::Image;
use wayword_run::error::CommandError;

/// Quality of JPEG files, percent.
const JPEG_QUALITY: u8 = 90;

/// A picture as a PNG file's bytes.
///
/// # Errors
/// When it cannot be encoded.
pub(super) fn encode_png(picture: &Image) -> Result<Vec<u8>, CommandError> {
    let mut bytes = Vec::new();
    encode_with(picture, PngEncoder::new(&mut bytes)).map(|()| bytes)
}

/// A picture as a JPEG file's bytes.
///
/// # Errors
/// When it cannot be encoded.
pub fn encode_jpeg(picture: &Image) -> Result<Vec<u8>, CommandError> {
    let mut bytes = Vec::new();
    encode_with(picture, JpegEncoder::new_with_quality(&mut bytes, JPEG_QUALITY)).map(|()| bytes)
}

fn encode_with(picture: &Image, encoder: impl ImageEncoder) -> Result<(), CommandError> {
    let (width, height) = (picture.width_px(), picture.height_px());
    encoder.write_image(picture.rgb_bytes(), width, height, ExtendedColorType::Rgb8).map_err(picture_error)
}

/// The error for a picture that cannot be stored in a format.
// A closure's argument cannot be a reference where `map_err` gives the value away.
#[allow(clippy::needless_pass_by_value)]
pub(super) fn picture_error(error: ImageError) -> CommandError {
    CommandError::usage(
        format!("the picture cannot be written: {error}"),
        "try another size with --width, or another ending",
    )
}
