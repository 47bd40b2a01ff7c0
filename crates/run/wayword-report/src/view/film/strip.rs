//! Writes pictures of a path side by side, as one PNG or JPEG.

use super::{
    super::{file_kind::FileKind, picture},
    FilmWriter,
};
use image::{Rgb, RgbImage, imageops};
use std::path::PathBuf;
use wayword_core::Image;
use wayword_run::{error::CommandError, written_files::write_file};

/// White between two pictures, pixels.
const GAP_PX: u32 = 4;

/// The pictures of a strip, from left to right.
pub(super) struct PictureStrip {
    file: PathBuf,
    kind: FileKind,
    pictures: Vec<RgbImage>,
}

impl PictureStrip {
    /// A strip for a file of this kind, [`FileKind::Png`] or [`FileKind::Jpeg`].
    pub(super) fn new(file: PathBuf, kind: FileKind) -> Self {
        Self { file, kind, pictures: Vec::new() }
    }
}

impl FilmWriter for PictureStrip {
    fn add_picture(&mut self, picture: &Image) -> Result<(), CommandError> {
        let pixels = RgbImage::from_raw(picture.width_px(), picture.height_px(), picture.rgb_bytes().to_vec());
        self.pictures.extend(pixels);
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<Vec<PathBuf>, CommandError> {
        let gaps = GAP_PX * (self.pictures.len() as u32).saturating_sub(1);
        let width = self.pictures.iter().map(RgbImage::width).sum::<u32>() + gaps;
        let height = self.pictures.iter().map(RgbImage::height).max().unwrap_or_default();
        let mut strip = RgbImage::from_pixel(width, height, Rgb([255; 3]));
        let mut left = 0;
        for picture in &self.pictures {
            imageops::replace(&mut strip, picture, i64::from(left), 0);
            left += picture.width() + GAP_PX;
        }
        let too_large =
            |_| CommandError::usage("the strip has too many pixels", "give a smaller --width or --pictures");
        let strip = Image::new(width, height, strip.into_raw()).map_err(too_large)?;
        let bytes = match self.kind {
            FileKind::Png => picture::encode_png(&strip)?,
            _ => picture::encode_jpeg(&strip)?,
        };
        write_file(&self.file, &bytes)?;
        Ok(vec![self.file])
    }
}
