//! The pictures of a run's frames, as files.

use crate::error::Error;
use image::{ExtendedColorType, ImageEncoder, ImageError, codecs::jpeg::JpegEncoder};
use std::{
    fs,
    path::{Path, PathBuf},
};
use wayword_core::{Image, View};

/// JPEG quality of the pictures, percent.
const JPEG_QUALITY: u8 = 80;

/// The picture of a frame as the bytes of a JPEG file.
#[derive(Debug, Clone)]
pub struct Picture {
    frame: usize,
    jpeg: Vec<u8>,
}

/// Encodes the picture ahead of each frame, if the platform has pictures.
///
/// # Errors
/// When a picture cannot be encoded as JPEG.
pub fn encode(ahead: &[View]) -> Result<Vec<Picture>, Error> {
    let images = ahead.iter().enumerate().filter_map(|(frame, view)| Some((frame, view.image.as_deref()?)));
    let encoded = images.map(|(frame, image)| {
        let jpeg = jpeg(image).map_err(|error| {
            Error::usage(
                format!("the picture of frame {frame} cannot be written as JPEG: {error}"),
                "report this as a bug",
            )
        })?;
        Ok(Picture { frame, jpeg })
    });
    encoded.collect()
}

fn jpeg(image: &Image) -> Result<Vec<u8>, ImageError> {
    let mut jpeg = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY);
    encoder.write_image(image.rgb(), image.width_px(), image.height_px(), ExtendedColorType::Rgb8)?;
    Ok(jpeg)
}

/// The file of the picture of a frame.
#[must_use]
pub fn file(folder: &Path, item: &str, frame: usize) -> PathBuf {
    folder.join(format!("{item}_{frame}.jpg"))
}

/// Writes pictures as ITEM_FRAME.jpg. The caller has checked that `item` can be part of a file name. Returns whether there were any.
///
/// # Errors
/// When a file cannot be written.
pub fn keep(folder: &Path, item: &str, pictures: &[Picture]) -> Result<bool, Error> {
    if pictures.is_empty() {
        return Ok(false);
    }
    fs::create_dir_all(folder).map_err(Error::io(folder, "make"))?;
    for Picture { frame, jpeg } in pictures {
        let path = file(folder, item, *frame);
        fs::write(&path, jpeg).map_err(Error::io(&path, "write"))?;
    }
    Ok(true)
}
