//! Decodes pictures that came over a socket.

use image::{ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Longest side of an accepted picture, pixels.
const MAX_SIDE_PX: u32 = 8192;

/// The RGB pixels of a file, rows from the top; otherwise the reason why the file cannot be used.
///
/// The caller knows the size. A file of another size is refused before it is decoded, so that its header cannot make
/// the program allocate more memory than the picture needs.
pub(crate) fn decode_rgb(file: &[u8], format: ImageFormat, (width, height): (u32, u32)) -> Result<Vec<u8>, String> {
    if !(1..=MAX_SIDE_PX).contains(&width) || !(1..=MAX_SIDE_PX).contains(&height) {
        return Err(format!("a size of {width} x {height} pixels: each side must lie in 1..={MAX_SIDE_PX}"));
    }
    let mut reader = ImageReader::new(Cursor::new(file));
    reader.set_format(format);
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(width), Some(height));
    limits.max_alloc = Some((64 << 20) + u64::from(width) * u64::from(height) * 16);
    reader.limits(limits);
    let decoded = reader.decode().map_err(|error| error.to_string())?;
    let (its_width, its_height) = (decoded.width(), decoded.height());
    if (its_width, its_height) != (width, height) {
        return Err(format!("the file has {its_width} x {its_height} pixels: expected {width} x {height}"));
    }
    Ok(decoded.into_rgb8().into_raw())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut file = Cursor::new(Vec::new());
        image::RgbImage::from_pixel(width, height, image::Rgb([1, 2, 3]))
            .write_to(&mut file, ImageFormat::Png)
            .unwrap();
        file.into_inner()
    }

    #[test]
    fn rgb_accepts_only_a_whole_picture_of_the_announced_size() {
        assert_eq!(decode_rgb(&png(2, 1), ImageFormat::Png, (2, 1)), Ok(vec![1, 2, 3, 1, 2, 3]));
        assert!(decode_rgb(&png(1, 1), ImageFormat::Png, (2, 1)).unwrap_err().contains("expected 2 x 1"));
        assert!(decode_rgb(&png(300, 1), ImageFormat::Png, (2, 1)).is_err());
        assert!(decode_rgb(&png(2, 1)[..40], ImageFormat::Png, (2, 1)).is_err());
        assert!(decode_rgb(b"", ImageFormat::Png, (0, 1)).unwrap_err().contains("0 x 1"));
    }
}
