//! Reads picture files of limited size, and re-exports the functions that read other files.

use std::path::Path;
use wayword_core::{Image, PlatformError};
use wayword_world::files;

pub(crate) use wayword_world::{
    files::{bytes_if_there, file_error, json_if_there, text_if_there},
    json_values::{check_coordinate, list_field, read_coordinate, text_field},
};

/// Largest picture file, bytes.
const MAX_PICTURE_BYTES: u64 = 32 << 20;
/// What to do about a broken picture.
pub(crate) const PICTURE_HINT: &str = "get the picture again from Matterport3D, or move it away to use only labels";

/// Decodes a JPEG or PNG file of limited size.
///
/// # Errors
/// If it is missing, too large, or not a picture.
pub(crate) fn read_picture(file: &Path) -> Result<Image, PlatformError> {
    let wrong = |reason: String| file_error(file, reason, PICTURE_HINT);
    let bytes = bytes_if_there(file, MAX_PICTURE_BYTES, PICTURE_HINT)?
        .ok_or_else(|| wrong("is missing from its set of pictures".into()))?;
    files::decode_picture(&bytes).map_err(wrong)
}
