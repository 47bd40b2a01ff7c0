//! Pictures of a number, drawn as black and white blocks like a barcode. A scripted provider reads the number and so knows
//! from the picture alone which view it was sent, even after JPEG and scaling.

use wayword_core::Image;

/// Columns of blocks. The 80 blocks of a picture have one bit each: 64 bits of the number and 16 of a checksum.
const BLOCK_COLUMNS: u32 = 10;
/// Rows of blocks.
const BLOCK_ROWS: u32 = 8;
/// Side of a block, pixels: large enough to survive JPEG and scaling to half the size.
const BLOCK_PX: u32 = 16;

/// A picture of a number, in large black and white blocks.
#[must_use]
pub fn draw_number(id: u64) -> Image {
    let (width, height) = (BLOCK_COLUMNS * BLOCK_PX, BLOCK_ROWS * BLOCK_PX);
    let bits = u128::from(id) << 16 | u128::from(checksum(id));
    let pixel = |x: u32, y: u32| {
        let bit = y / BLOCK_PX * BLOCK_COLUMNS + x / BLOCK_PX;
        if bits >> bit & 1 == 1 { [255; 3] } else { [0; 3] }
    };
    let rgb: Vec<u8> = (0..height).flat_map(|y| (0..width).flat_map(move |x| pixel(x, y))).collect();
    Image::new(width, height, rgb).unwrap_or_else(|_| unreachable!("as many pixels were made as there are"))
}

/// Reads the number of a picture that [`draw_number()`] drew, from the bytes of a JPEG or PNG file. `None` if the checksum is wrong.
#[must_use]
pub fn read_number(file: &[u8]) -> Option<u64> {
    let picture = image::load_from_memory(file).ok()?.into_luma8();
    let (width, height) = picture.dimensions();
    let mut bits = 0u128;
    for bit in 0..BLOCK_COLUMNS * BLOCK_ROWS {
        let middle = |block: u32, blocks: u32, pixels: u32| (2 * block + 1) * pixels / (2 * blocks);
        let (x, y) =
            (middle(bit % BLOCK_COLUMNS, BLOCK_COLUMNS, width), middle(bit / BLOCK_COLUMNS, BLOCK_ROWS, height));
        bits |= u128::from(picture.get_pixel_checked(x, y)?.0[0] > 127) << bit;
    }
    let id = u64::try_from(bits >> 16).ok()?;
    (u128::from(checksum(id)) == bits & 0xffff).then_some(id)
}

/// 16 bits that depend on all bits of the number.
fn checksum(id: u64) -> u16 {
    let mixed = id.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5bd1_e995;
    (mixed >> 48) as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ExtendedColorType, ImageEncoder, codecs::jpeg::JpegEncoder, imageops};

    fn jpeg(id: u64, half: bool) -> Vec<u8> {
        let drawn = draw_number(id);
        let mut picture =
            image::RgbImage::from_raw(drawn.width_px(), drawn.height_px(), drawn.rgb_bytes().to_vec()).unwrap();
        if half {
            picture = imageops::resize(&picture, drawn.width_px() / 2, drawn.height_px() / 2, imageops::Triangle);
        }
        let mut bytes = Vec::new();
        let encoder = JpegEncoder::new_with_quality(&mut bytes, 80);
        encoder.write_image(&picture, picture.width(), picture.height(), ExtendedColorType::Rgb8).unwrap();
        bytes
    }

    #[test]
    fn a_number_survives_jpeg_and_half_the_size() {
        for id in [0, 1, u64::MAX, 0x0123_4567_89ab_cdef, 0xaaaa_5555_aaaa_5555] {
            assert_eq!(read_number(&jpeg(id, false)), Some(id));
            assert_eq!(read_number(&jpeg(id, true)), Some(id));
        }
    }

    #[test]
    fn read_refuses_bytes_that_are_no_barcode() {
        assert_eq!(read_number(b"nonsense"), None);
    }
}
