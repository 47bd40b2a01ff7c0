//! Files from outside, read with a bound, and the words for what is wrong with them.

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::{
    fs::File,
    io::{Cursor, ErrorKind, Read},
    path::Path,
};
use wayword_core::{Image, PlatformError};

/// Longest side of a decoded picture: a strip of six faces of 2048 pixels.
const MAX_SIDE_PX: u32 = 6 * 2048;
/// The most memory that decoding one picture may take, bytes.
const MAX_DECODED_BYTES: u64 = 256 << 20;

/// An error about a file.
#[must_use]
pub fn wrong(file: &Path, reason: impl Into<String>, hint: &'static str) -> PlatformError {
    PlatformError::File { file: file.to_owned(), reason: reason.into(), hint }
}

/// The bytes of a file, at most `max_bytes` of them; `None` where there is no such file.
///
/// # Errors
/// When it cannot be read, or has more.
pub fn bytes_if_there(file: &Path, max_bytes: u64, hint: &'static str) -> Result<Option<Vec<u8>>, PlatformError> {
    let opened = match File::open(file) {
        Ok(opened) => opened,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(wrong(file, error.to_string(), hint)),
    };
    let mut bytes = Vec::new();
    opened.take(max_bytes + 1).read_to_end(&mut bytes).map_err(|error| wrong(file, error.to_string(), hint))?;
    if bytes.len() as u64 > max_bytes {
        return Err(wrong(file, format!("has more than {max_bytes} bytes, which no such file has"), hint));
    }
    Ok(Some(bytes))
}

/// The text of a file, at most `max_bytes` of it; `None` where there is no such file.
///
/// # Errors
/// When it cannot be read, has more, or is not UTF-8.
pub fn text_if_there(file: &Path, max_bytes: u64, hint: &'static str) -> Result<Option<String>, PlatformError> {
    let Some(bytes) = bytes_if_there(file, max_bytes, hint)? else {
        return Ok(None);
    };
    String::from_utf8(bytes).map(Some).map_err(|_| wrong(file, "is not text in UTF-8", hint))
}

/// Decodes a JPEG or PNG file, within bounds.
///
/// # Errors
/// In words, when it is too large, or no such picture.
pub fn picture(bytes: &[u8]) -> Result<Image, String> {
    // Decoders for other formats may be there for other purposes.
    let format =
        image::guess_format(bytes).ok().filter(|format| matches!(format, ImageFormat::Png | ImageFormat::Jpeg));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format.ok_or("is neither PNG nor JPEG")?);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX);
    limits.max_image_height = Some(MAX_SIDE_PX);
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    let unread = |error: ImageError| format!("is no picture that can be read: {error}");
    let mut decoder = reader.into_decoder().map_err(unread)?;
    if decoder.total_bytes() > MAX_DECODED_BYTES {
        return Err(format!("has more than {MAX_DECODED_BYTES} bytes once it is unpacked"));
    }
    // A telephone that was held upright writes down that its picture lies on its side.
    let orientation = decoder.orientation().map_err(unread)?;
    let mut picture = DynamicImage::from_decoder(decoder).map_err(unread)?;
    picture.apply_orientation(orientation);
    let picture = picture.into_rgb8();
    Image::new(picture.width(), picture.height(), picture.into_raw()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageEncoder, Rgb, RgbImage, codecs::jpeg::JpegEncoder};

    /// Exif with one entry: the orientation.
    fn exif(orientation: u8) -> Vec<u8> {
        let mut exif = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0".to_vec();
        exif.extend([orientation, 0, 0, 0, 0, 0, 0, 0]);
        exif
    }

    #[test]
    fn a_picture_that_was_taken_upright_stands_upright() {
        let lying = RgbImage::from_fn(32, 16, |x, _| Rgb([if x < 16 { 250 } else { 5 }; 3]));
        for (orientation, size, top_left) in
            [(1, (32, 16), 250), (6, (16, 32), 250), (8, (16, 32), 5), (3, (32, 16), 5)]
        {
            let mut bytes = Vec::new();
            let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 95);
            encoder.set_exif_metadata(exif(orientation)).unwrap();
            encoder.write_image(lying.as_raw(), 32, 16, image::ExtendedColorType::Rgb8).unwrap();
            let read = picture(&bytes).unwrap();
            assert_eq!((read.width_px(), read.height_px()), size, "{orientation}");
            assert!(read.rgb()[0].abs_diff(top_left) < 10, "{orientation}: {}", read.rgb()[0]);
        }
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        assert!(picture(b"GIF89a").unwrap_err().contains("neither PNG nor JPEG"));
        assert!(picture(b"\x89PNG\r\n\x1a\n").unwrap_err().contains("no picture that can be read"));
    }
}
