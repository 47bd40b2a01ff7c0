//! Reads third-party files up to a size limit. An error names the file, the problem, and what to do about it (`hint`).

use crate::picture_end::is_cut_off;
use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use std::{
    fs::{self, File, Metadata},
    io::{Cursor, ErrorKind, Read},
    path::Path,
};
use wayword_core::{Image, PlatformError};

/// Longest side of a decoded picture: a strip of six faces of 2048 pixels.
const MAX_SIDE_PX: u32 = 6 * 2048;
/// The most memory that decoding one picture may take, bytes.
const MAX_DECODED_BYTES: u64 = 256 << 20;

/// The error for a file that cannot be used.
#[must_use]
pub fn file_error(file: &Path, reason: impl Into<String>, hint: &'static str) -> PlatformError {
    PlatformError::File { file: file.to_owned(), reason: reason.into(), hint }
}

/// For a path that is not a plain file, a phrase that describes it, such as "is a folder, not a file"; `None` for a plain
/// file. Pipes are refused because opening one waits until another program writes to it.
#[must_use]
pub fn describe_irregular(about: &Metadata) -> Option<&'static str> {
    if about.is_dir() {
        return Some("is a folder, not a file");
    }
    (!about.is_file()).then_some("is a pipe or a device, not a file")
}

/// The bytes of a file, at most `max_bytes` of them; `None` if the file does not exist.
///
/// # Errors
/// When it cannot be read, or is larger.
pub fn bytes_if_there(file: &Path, max_bytes: u64, hint: &'static str) -> Result<Option<Vec<u8>>, PlatformError> {
    let failed = |error: std::io::Error| PlatformError::for_unread_file(file, &error, hint);
    let too_large =
        || file_error(file, format!("has more than {max_bytes} bytes, the limit for a file of this kind"), hint);
    let about = match fs::metadata(file) {
        Ok(about) => about,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(failed(error)),
    };
    if let Some(reason) = describe_irregular(&about) {
        return Err(file_error(file, reason, hint));
    }
    if about.len() > max_bytes {
        return Err(too_large());
    }
    let mut bytes = Vec::new();
    // The file may grow while it is read.
    File::open(file).and_then(|file| file.take(max_bytes + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > max_bytes { Err(too_large()) } else { Ok(Some(bytes)) }
}

/// Opens a file to read parts of it.
///
/// # Errors
/// When it cannot be opened, or is not a plain file.
pub fn open_plain_file(file: &Path, hint: &'static str) -> Result<File, PlatformError> {
    let failed = |error: std::io::Error| PlatformError::for_unread_file(file, &error, hint);
    match describe_irregular(&fs::metadata(file).map_err(failed)?) {
        Some(reason) => Err(file_error(file, reason, hint)),
        None => File::open(file).map_err(failed),
    }
}

/// The bytes of a JSON file, as [`bytes_if_there`] reads them, without the byte order mark that Windows editors put
/// before UTF-8.
///
/// # Errors
/// As [`bytes_if_there`].
pub fn json_if_there(file: &Path, max_bytes: u64, hint: &'static str) -> Result<Option<Vec<u8>>, PlatformError> {
    Ok(bytes_if_there(file, max_bytes, hint)?.map(without_mark))
}

/// The byte order mark of UTF-8.
const UTF8_BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];

fn without_mark(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.starts_with(&UTF8_BYTE_ORDER_MARK) {
        bytes.drain(..UTF8_BYTE_ORDER_MARK.len());
    }
    bytes
}

/// Bytes as text, without the byte order mark of UTF-8.
///
/// # Errors
/// A phrase that names the encoding, if it is not UTF-8.
pub fn decode_utf8(bytes: Vec<u8>) -> Result<String, &'static str> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err("is text in UTF-16; save it as UTF-8");
    }
    String::from_utf8(without_mark(bytes)).map_err(|_| "is not text in UTF-8")
}

/// The text of a file, at most `max_bytes` of it; `None` if the file does not exist.
///
/// # Errors
/// When it cannot be read, is larger, or is not UTF-8.
pub fn text_if_there(file: &Path, max_bytes: u64, hint: &'static str) -> Result<Option<String>, PlatformError> {
    let Some(bytes) = bytes_if_there(file, max_bytes, hint)? else {
        return Ok(None);
    };
    decode_utf8(bytes).map(Some).map_err(|reason| file_error(file, reason, hint))
}

/// A phrase about a picture file that breaks off.
const CUT_OFF: &str = "is a picture that is cut off";

/// Decodes a JPEG or PNG file, within limits of size and memory.
///
/// # Errors
/// A phrase about the problem: the picture is cut off or too large, or it is no JPEG or PNG picture.
pub fn decode_picture(bytes: &[u8]) -> Result<Image, String> {
    if is_cut_off(bytes) {
        return Err(CUT_OFF.to_owned());
    }
    // Decoders for other formats may be compiled in for other purposes.
    let format =
        image::guess_format(bytes).ok().filter(|format| matches!(format, ImageFormat::Png | ImageFormat::Jpeg));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format.ok_or("is neither PNG nor JPEG")?);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX);
    limits.max_image_height = Some(MAX_SIDE_PX);
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    let unread = |error: ImageError| format!("cannot be decoded as a picture: {error}");
    let mut decoder = reader.into_decoder().map_err(unread)?;
    if decoder.total_bytes() > MAX_DECODED_BYTES {
        return Err(format!("has more than {MAX_DECODED_BYTES} bytes when it is decoded"));
    }
    // A phone that was held upright stores its picture lying on its side, and notes that in the orientation.
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
    fn decode_picture_applies_the_orientation_of_the_camera() {
        let lying = RgbImage::from_fn(32, 16, |x, _| Rgb([if x < 16 { 250 } else { 5 }; 3]));
        for (orientation, size, top_left) in
            [(1, (32, 16), 250), (6, (16, 32), 250), (8, (16, 32), 5), (3, (32, 16), 5)]
        {
            let mut bytes = Vec::new();
            let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 95);
            encoder.set_exif_metadata(exif(orientation)).unwrap();
            encoder.write_image(lying.as_raw(), 32, 16, image::ExtendedColorType::Rgb8).unwrap();
            let read = decode_picture(&bytes).unwrap();
            assert_eq!((read.width_px(), read.height_px()), size, "{orientation}");
            assert!(read.rgb_bytes()[0].abs_diff(top_left) < 10, "{orientation}: {}", read.rgb_bytes()[0]);
        }
    }

    /// Writes bytes to a file and reads them back as text.
    fn read(bytes: &[u8]) -> Result<Option<String>, String> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("poses.csv");
        fs::write(&file, bytes).unwrap();
        text_if_there(&file, 100, "?").map_err(|error| error.to_string())
    }

    #[test]
    fn decode_utf8_skips_a_byte_order_mark_and_names_utf_16() {
        assert_eq!(read(b"\xef\xbb\xbfx,y"), Ok(Some("x,y".to_owned())));
        assert_eq!(read(b"x,y"), Ok(Some("x,y".to_owned())));
        assert!(read(b"\xff\xfex\0").unwrap_err().contains("UTF-16"));
        assert!(read(b"x\xff").unwrap_err().contains("not text in UTF-8"));
        assert!(read(&[b'x'; 101]).unwrap_err().contains("more than 100 bytes"));
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_refused_and_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for (file, told) in [(pipe.as_path(), "is a pipe or a device"), (folder.path(), "is a folder")] {
            assert!(bytes_if_there(file, 100, "?").unwrap_err().to_string().contains(told));
            assert!(open_plain_file(file, "?").unwrap_err().to_string().contains(told));
        }
        assert!(bytes_if_there(&folder.path().join("none"), 100, "?").unwrap().is_none());
    }

    #[test]
    fn decode_picture_refuses_other_files() {
        assert!(decode_picture(b"GIF89a").unwrap_err().contains("neither PNG nor JPEG"));
        assert!(decode_picture(b"\x89PNG\r\n\x1a\n").unwrap_err().contains("is cut off"));
        let without_header = b"\x89PNG\r\n\x1a\n\0\0\0\0IEND\xae\x42\x60\x82";
        assert!(decode_picture(without_header).unwrap_err().contains("cannot be decoded as a picture"));
    }
}
