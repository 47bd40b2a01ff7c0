//! Finds picture files that break off. Decoders fill what is missing with grey, or stop with words that nobody understands.

/// The marks of JPEG that are used here: end of the picture, start of a scan, and those without a length.
const JPEG_END: u8 = 0xd9;
const JPEG_SCAN: u8 = 0xda;
const JPEG_RESTARTS: std::ops::RangeInclusive<u8> = 0xd0..=0xd7;
/// The length of PNG's signature, and of a chunk's length, type and checksum together.
const PNG_START_BYTES: usize = 8;
const PNG_CHUNK_BYTES: usize = 12;

/// Whether a JPEG or PNG file breaks off before the end of its picture. A file of another structure is left to its decoder.
#[must_use]
pub fn is_cut_off(bytes: &[u8]) -> bool {
    let ends = if bytes.starts_with(&[0xff, 0xd8]) {
        jpeg_ends(bytes)
    } else if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        png_ends(bytes)
    } else {
        Some(true)
    };
    ends.is_none()
}

/// Follows the marks of a JPEG file; `None` where it breaks off. A picture in its metadata has an end of its own, which does not
/// count.
fn jpeg_ends(bytes: &[u8]) -> Option<bool> {
    let mut at = 2;
    loop {
        if *bytes.get(at)? != 0xff {
            return Some(false);
        }
        match *bytes.get(at + 1)? {
            JPEG_END => return Some(true),
            // A mark may have any number of these bytes before it.
            0xff => at += 1,
            0x01 | 0xd8 => at += 2,
            restart if JPEG_RESTARTS.contains(&restart) => at += 2,
            mark => {
                let length = bytes.get(at + 2..)?.first_chunk::<2>()?;
                at += 2 + usize::from(u16::from_be_bytes(*length)).max(2);
                if mark == JPEG_SCAN {
                    at += bytes.get(at..)?.array_windows().position(|pair| is_jpeg_mark(*pair))?;
                }
            }
        }
    }
}

/// Whether two bytes in the data of a scan are a mark that ends it.
fn is_jpeg_mark([first, second]: [u8; 2]) -> bool {
    first == 0xff && !matches!(second, 0 | 0xff) && !JPEG_RESTARTS.contains(&second)
}

/// Follows the chunks of a PNG file; `None` where it breaks off.
fn png_ends(bytes: &[u8]) -> Option<bool> {
    let mut at = PNG_START_BYTES;
    loop {
        let chunk = bytes.get(at..)?;
        let length = usize::try_from(u32::from_be_bytes(*chunk.first_chunk::<4>()?)).ok()?;
        let end = length.checked_add(PNG_CHUNK_BYTES)?;
        chunk.get(..end)?;
        if chunk.get(4..8)? == b"IEND" {
            return Some(true);
        }
        at += end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageEncoder, ImageFormat, Rgb, RgbImage, codecs::jpeg::JpegEncoder};

    fn picture() -> RgbImage {
        RgbImage::from_fn(64, 48, |x, y| Rgb([(x * 3) as u8, (y * 5) as u8, (x * y % 251) as u8]))
    }

    fn encoded(format: ImageFormat) -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        DynamicImage::ImageRgb8(picture()).write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn pictures_that_break_off_anywhere_are_found() {
        for format in [ImageFormat::Jpeg, ImageFormat::Png] {
            let whole = encoded(format);
            assert!(!is_cut_off(&whole));
            // Cameras append what they like.
            assert!(!is_cut_off(&[&whole, &b"\0\0more"[..]].concat()));
            for share in [0.1, 0.3, 0.5, 0.9, 0.99] {
                let length = (whole.len() as f64 * share) as usize;
                assert!(is_cut_off(&whole[..length]), "{format:?} {share}");
                // The place of the file on the disk was set aside before.
                let padded = [&whole[..length], &vec![0; whole.len() - length]].concat();
                let is_known = format == ImageFormat::Jpeg && share > 0.4;
                assert!(!is_known || is_cut_off(&padded), "{share}");
            }
        }
    }

    #[test]
    fn the_end_of_a_small_picture_inside_does_not_count() {
        let mut whole = Vec::new();
        let mut encoder = JpegEncoder::new(&mut whole);
        encoder.set_exif_metadata([b"II*\0\x08\0\0\0\0\0", encoded(ImageFormat::Jpeg).as_slice()].concat()).unwrap();
        encoder.write_image(picture().as_raw(), 64, 48, image::ExtendedColorType::Rgb8).unwrap();
        assert!(!is_cut_off(&whole));
        assert!(is_cut_off(&whole[..whole.len() - 100]));
    }

    #[test]
    fn files_of_another_structure_are_left_to_their_decoder() {
        for bytes in [&b""[..], b"GIF89a", b"\xff\xd8 no mark", b"RIFF\x24\0\0\0WEBPVP8 "] {
            assert!(!is_cut_off(bytes), "{bytes:?}");
        }
    }
}
