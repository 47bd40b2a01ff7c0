//! Encodes, writes and reads the pictures of a run's frames, JPEG files named ITEM_FRAME.jpg.

use crate::error::CommandError;
use image::{
    ExtendedColorType, ImageEncoder, ImageError, ImageFormat, ImageReader, RgbImage, codecs::jpeg::JpegEncoder,
    imageops::thumbnail,
};
use std::{
    collections::BTreeSet,
    fs::{self, File},
    io::{Cursor, Read},
    path::{Component, Path, PathBuf},
};
use wayword_core::{Image, View};

/// JPEG quality of the pictures, percent.
const JPEG_QUALITY: u8 = 80;

/// The picture of a frame as the bytes of a JPEG file.
#[derive(Debug, Clone)]
pub struct FrameJpeg {
    frame: usize,
    jpeg: Vec<u8>,
}

/// Encodes the picture ahead of each frame, if the platform has pictures.
///
/// # Errors
/// When a picture cannot be encoded as JPEG.
pub fn encode_pictures(ahead: &[View]) -> Result<Vec<FrameJpeg>, CommandError> {
    let images = ahead.iter().enumerate().filter_map(|(frame, view)| Some((frame, view.image.as_deref()?)));
    let encoded = images.map(|(frame, image)| {
        let jpeg = encode_jpeg(image, JPEG_QUALITY).map_err(|error| {
            CommandError::usage(
                format!("the picture of frame {frame} cannot be written as JPEG: {error}"),
                "report this as a bug",
            )
        })?;
        Ok(FrameJpeg { frame, jpeg })
    });
    encoded.collect()
}

/// A picture as the bytes of a JPEG file.
///
/// # Errors
/// When it has no pixels, or too many for JPEG.
pub fn encode_jpeg(image: &Image, quality: u8) -> Result<Vec<u8>, ImageError> {
    let mut jpeg = Vec::new();
    let encoder = JpegEncoder::new_with_quality(&mut jpeg, quality);
    encoder.write_image(image.rgb_bytes(), image.width_px(), image.height_px(), ExtendedColorType::Rgb8)?;
    Ok(jpeg)
}

/// Longer side of the small pictures of pages, pixels.
const SMALL_PICTURE_PX: u32 = 320;
/// Their JPEG quality, percent.
const SMALL_PICTURE_QUALITY: u8 = 75;

/// Most pictures of a walk that a page shows.
pub const MOST_PICTURES: usize = 24;

/// Which of so many frames are shown, if at most `most` can be: the first, the last, and others at equal distances between them.
pub fn evenly_chosen(count: usize, most: usize) -> BTreeSet<usize> {
    let shown = count.min(most);
    (0..shown).map(|at| at * (count - 1) / shown.saturating_sub(1).max(1)).collect()
}

/// The name of a picture's file, its width and its height in pixels.
pub type WrittenPicture = (String, u32, u32);

/// Writes the picture of a view, shrunk, for a page; `None` where it has none.
///
/// # Errors
/// When it cannot be written.
pub fn write_small_picture(folder: &Path, name: String, view: &View) -> Result<Option<WrittenPicture>, CommandError> {
    let Some(image) = &view.image else { return Ok(None) };
    let image = shrink_picture(image, SMALL_PICTURE_PX);
    let jpeg = encode_jpeg(&image, SMALL_PICTURE_QUALITY).map_err(|error| {
        CommandError::usage(format!("a picture cannot be written as JPEG: {error}"), "report this as a bug")
    })?;
    let file = folder.join(&name);
    fs::write(&file, jpeg).map_err(CommandError::io(&file, "write"))?;
    Ok(Some((name, image.width_px(), image.height_px())))
}

/// A picture whose longer side has at most so many pixels.
fn shrink_picture(image: &Image, longer_px: u32) -> Image {
    let (width, height) = (image.width_px(), image.height_px());
    let pixels = RgbImage::from_raw(width, height, image.rgb_bytes().to_vec());
    let Some(pixels) = pixels.filter(|_| width.max(height) > longer_px) else { return image.clone() };
    let side = |side: u32| (u64::from(side) * u64::from(longer_px) / u64::from(width.max(height))).max(1) as u32;
    let small = thumbnail(&pixels, side(width), side(height));
    Image::new(small.width(), small.height(), small.into_raw()).unwrap_or_else(|_| image.clone())
}

/// The file of the picture of a frame.
#[must_use]
pub fn picture_file(folder: &Path, item: &str, frame: usize) -> PathBuf {
    folder.join(format!("{item}_{frame}.jpg"))
}

/// Largest picture that is read, bytes. A larger one counts as missing.
pub const MAX_PICTURE_BYTES: u64 = 4 << 20;
/// Largest side of a picture that is read, pixels, because a small file can hold a picture that fills the memory. A
/// larger picture counts as missing.
pub const MAX_PICTURE_SIDE_PX: u32 = 4096;

/// A picture as it lies in a run's folder.
pub struct StoredPicture {
    /// The bytes of the JPEG file.
    pub jpeg: Vec<u8>,
    /// Its width, pixels.
    pub width_px: u32,
    /// Its height, pixels.
    pub height_px: u32,
}

/// The picture of a frame (from 0) of an item; `None` if it is missing, larger than `most_bytes`, or not a JPEG.
pub fn read_picture(folder: &Path, item: &str, frame: usize, most_bytes: u64) -> Option<StoredPicture> {
    let path = file_inside(folder, &format!("{item}_{frame}.jpg"))?;
    // Links are not followed, because one could lead out of the folder.
    let found = fs::symlink_metadata(&path).ok()?;
    if !found.is_file() || found.len() > MAX_PICTURE_BYTES.min(most_bytes) {
        return None;
    }
    let mut jpeg = Vec::new();
    File::open(&path).ok()?.take(MAX_PICTURE_BYTES).read_to_end(&mut jpeg).ok()?;
    let (width_px, height_px) =
        ImageReader::with_format(Cursor::new(&jpeg), ImageFormat::Jpeg).into_dimensions().ok()?;
    let is_fit = |side: u32| (1..=MAX_PICTURE_SIDE_PX).contains(&side);
    (is_fit(width_px) && is_fit(height_px)).then_some(StoredPicture { jpeg, width_px, height_px })
}

impl StoredPicture {
    /// Its pixels; `None` if the file is damaged.
    pub fn decode_pixels(&self) -> Option<Image> {
        let decoded = image::load_from_memory_with_format(&self.jpeg, ImageFormat::Jpeg).ok()?.into_rgb8();
        Image::new(decoded.width(), decoded.height(), decoded.into_raw()).ok()
    }
}

/// A file directly inside a folder, or `None` if its name leads elsewhere: ids of paths are free text.
fn file_inside(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut parts = Path::new(name).components();
    match (parts.next(), parts.next()) {
        (Some(Component::Normal(only)), None) if only == name => Some(folder.join(only)),
        _ => None,
    }
}

/// Writes pictures as ITEM_FRAME.jpg. The caller has checked that `item` can be part of a file name. Returns whether there were any.
///
/// # Errors
/// When a file cannot be written.
pub fn write_pictures(folder: &Path, item: &str, pictures: &[FrameJpeg]) -> Result<bool, CommandError> {
    if pictures.is_empty() {
        return Ok(false);
    }
    fs::create_dir_all(folder).map_err(CommandError::io(folder, "make"))?;
    for FrameJpeg { frame, jpeg } in pictures {
        let path = picture_file(folder, item, *frame);
        fs::write(&path, jpeg).map_err(CommandError::io(&path, "write"))?;
    }
    Ok(true)
}
