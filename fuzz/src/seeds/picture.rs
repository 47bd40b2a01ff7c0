//! Small pictures.

use image::{ExtendedColorType, ImageEncoder, codecs};

fn pixels(width: u32, height: u32, channels: u32) -> Vec<u8> {
    (0..width * height * channels).map(|index| (index * 37 % 251) as u8).collect()
}

/// A PNG.
pub fn png(width: u32, height: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = codecs::png::PngEncoder::new(&mut file);
    encoder.write_image(&pixels(width, height, 3), width, height, ExtendedColorType::Rgb8).expect("a PNG");
    file
}

/// A JPEG.
pub fn jpeg(width: u32, height: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = codecs::jpeg::JpegEncoder::new_with_quality(&mut file, 60);
    encoder.write_image(&pixels(width, height, 3), width, height, ExtendedColorType::Rgb8).expect("a JPEG");
    file
}

/// PNGs and JPEGs of several kinds.
pub fn all() -> Vec<Vec<u8>> {
    let mut all = vec![png(1, 1), png(7, 5), jpeg(16, 16), jpeg(9, 3)];
    let kinds = [(ExtendedColorType::L8, 1), (ExtendedColorType::La8, 2), (ExtendedColorType::Rgba8, 4)];
    let deep = [(ExtendedColorType::L16, 2), (ExtendedColorType::Rgba16, 8)];
    for (kind, channels) in kinds.into_iter().chain(deep) {
        let mut file = Vec::new();
        let encoder = codecs::png::PngEncoder::new(&mut file);
        encoder.write_image(&pixels(4, 3, channels), 4, 3, kind).expect("a PNG");
        all.push(file);
    }
    let mut grey = Vec::new();
    let encoder = codecs::jpeg::JpegEncoder::new_with_quality(&mut grey, 90);
    encoder.write_image(&pixels(8, 8, 1), 8, 8, ExtendedColorType::L8).expect("a JPEG");
    all.push(grey);
    all
}
