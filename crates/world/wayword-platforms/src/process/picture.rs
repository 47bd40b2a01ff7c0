//! Reads the pictures of a child: in base64 within its answer, or in a file in the folder that its greeting names. The
//! child is not trusted, so no path leads out of that folder, and sizes are checked before a picture is decoded.

use base64::{Engine, engine::general_purpose::STANDARD};
use image::{ImageFormat, ImageReader, Limits};
use serde::Deserialize;
use std::{
    fs::File,
    io::{Cursor, Read},
    path::{Component, Path, PathBuf},
};
use wayword_core::Image;

/// Largest file, bytes.
const MAX_FILE_BYTES: u64 = 32 << 20;
/// Most memory that decoding one picture may take, bytes: enough for 4096 x 4096 pixels and intermediate data.
const MAX_DECODED_BYTES: u64 = 256 << 20;

/// A picture as the child sends it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(crate) enum SentPicture {
    /// A PNG or JPEG file in base64.
    Base64(String),
    /// A PNG or JPEG file, as a path relative to the child's folder.
    File(PathBuf),
}

impl SentPicture {
    /// The bytes of the PNG or JPEG file.
    pub(crate) fn into_bytes(self, folder: Option<&Path>) -> Result<Vec<u8>, String> {
        match self {
            Self::Base64(text) => STANDARD.decode(text).map_err(|error| format!("`image` is not base64: {error}")),
            Self::File(file) => {
                let folder = folder.ok_or("`image` is a file, but the greeting named no folder `images`")?;
                read_confined(folder, &file).map_err(|reason| format!("`image` {}: {reason}", file.display()))
            }
        }
    }
}

/// The bytes of a file, which must lie in the folder after all links are resolved. The folder's own path has no links.
fn read_confined(folder: &Path, file: &Path) -> Result<Vec<u8>, String> {
    if !file.components().all(|part| matches!(part, Component::Normal(_))) {
        return Err("is not a plain path within the folder `images`".into());
    }
    let found = folder.join(file).canonicalize().map_err(|error| error.to_string())?;
    if !found.starts_with(folder) {
        return Err("leads out of the folder `images`".into());
    }
    // Reading anything else, such as a pipe, could block for ever.
    if !found.is_file() {
        return Err("is not a file".into());
    }
    let opened = File::open(&found).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    opened.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(format!("has more than {MAX_FILE_BYTES} bytes"));
    }
    Ok(bytes)
}

/// Decodes a picture, which must have the requested size. The size is read first, so a picture of another size is not
/// decoded.
pub(crate) fn decode_child_picture(bytes: &[u8], (width_px, height_px): (u32, u32)) -> Result<Image, String> {
    // Only these two formats are allowed, even if the build contains decoders for others.
    let format =
        image::guess_format(bytes).ok().filter(|format| matches!(format, ImageFormat::Png | ImageFormat::Jpeg));
    let format = format.ok_or("`image` is neither PNG nor JPEG")?;
    let reader = || ImageReader::with_format(Cursor::new(bytes), format);
    let (width, height) = reader().into_dimensions().map_err(|error| format!("`image`: {error}"))?;
    if (width, height) != (width_px, height_px) {
        return Err(format!("`image` has {width} x {height} pixels, expected {width_px} x {height_px}"));
    }
    let mut reader = reader();
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    let rgb = reader.decode().map_err(|error| format!("`image`: {error}"))?.into_rgb8();
    Image::new(width, height, rgb.into_raw()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::fs;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image::RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, 7]))
            .write_to(&mut bytes, image::ImageFormat::Png)
            .unwrap();
        bytes.into_inner()
    }

    #[test]
    fn a_picture_comes_in_base64_or_from_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        fs::create_dir(root.join("sub")).unwrap();
        fs::write(root.join("sub/view.png"), png(4, 3)).unwrap();
        let from_file = SentPicture::File("sub/view.png".into()).into_bytes(Some(&root)).unwrap();
        let from_text = SentPicture::Base64(STANDARD.encode(png(4, 3))).into_bytes(None).unwrap();
        assert_eq!(from_file, from_text);
        let image = decode_child_picture(&from_file, (4, 3)).unwrap();
        assert_eq!(&image.rgb_bytes()[3 * 5..3 * 6], [1, 1, 7]);
    }

    #[cfg(unix)]
    #[test]
    fn no_path_and_no_link_leads_out_of_the_folder() {
        let outside = tempfile::tempdir().unwrap();
        fs::write(outside.path().join("secret.png"), png(4, 3)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().canonicalize().unwrap();
        std::os::unix::fs::symlink(outside.path(), root.join("link")).unwrap();
        std::os::unix::fs::symlink(outside.path().join("secret.png"), root.join("view.png")).unwrap();
        let absolute = outside.path().join("secret.png").display().to_string();
        for bad in
            ["link/secret.png", "view.png", "../secret.png", "a/../../x", "./..", "", ".", &absolute, "link", "none"]
        {
            assert!(SentPicture::File(bad.into()).into_bytes(Some(&root)).is_err(), "{bad} was read");
        }
        assert!(SentPicture::File("view.png".into()).into_bytes(None).unwrap_err().contains("images"));
    }

    #[test]
    fn a_huge_picture_is_refused_by_its_first_bytes() {
        // A PNG's width and height are bytes 16 to 24; the checksum after the header must match them.
        let mut bomb = png(4, 3);
        bomb[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
        let sum = crc(&bomb[12..29]).to_be_bytes();
        bomb[29..33].copy_from_slice(&sum);
        let error = decode_child_picture(&bomb, (640, 480)).unwrap_err();
        assert!(error.contains("65535 x 65535") && error.contains("640 x 480"), "{error}");
    }

    fn crc(bytes: &[u8]) -> u32 {
        let step = |sum: u32, byte: &u8| {
            (0..8).fold(sum ^ u32::from(*byte), |sum, _| (sum >> 1) ^ (0xedb8_8320 & (sum & 1).wrapping_neg()))
        };
        !bytes.iter().fold(!0, step)
    }

    proptest! {
        #[test]
        fn a_broken_picture_is_a_picture_of_that_size_or_an_error(at in 0usize..80, byte in any::<u8>(), cut in 0usize..80) {
            let mut bytes = png(4, 3);
            let last = bytes.len() - 1;
            bytes[at.min(last)] = byte;
            bytes.truncate(bytes.len().saturating_sub(cut));
            if let Ok(image) = decode_child_picture(&bytes, (4, 3)) {
                prop_assert_eq!(image.rgb_bytes().len(), 36);
            }
        }
    }
}
