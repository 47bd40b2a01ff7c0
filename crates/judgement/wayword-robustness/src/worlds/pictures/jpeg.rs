//! Pictures that went through a JPEG file.

use super::PictureChangeError;
use image::{ExtendedColorType, ImageEncoder, ImageFormat, codecs::jpeg::JpegEncoder};
use wayword_core::Image;

/// The picture as it comes back from a JPEG file of this quality, per cent; 100 leaves it as it is.
pub(super) fn through_jpeg(image: &Image, quality_percent: u8) -> Result<Image, PictureChangeError> {
    if quality_percent >= 100 {
        return Ok(image.clone());
    }
    let mut file = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut file, quality_percent.max(1));
    encoder.write_image(image.rgb_bytes(), image.width_px(), image.height_px(), ExtendedColorType::Rgb8)?;
    let back = image::load_from_memory_with_format(&file, ImageFormat::Jpeg)?.into_rgb8();
    Ok(Image::new(back.width(), back.height(), back.into_raw())?)
}
