//! Skyboxes: walls of one colour per direction, a light ceiling and a dark floor.

use image::{ImageEncoder as _, ImageError, Rgb, RgbImage, codecs::jpeg::JpegEncoder};
use std::io;

/// Side of a face, pixels.
const SIDE_PX: u32 = 64;

/// The sRGB colours of the faces in Matterport3D's order. With the poses of this building, face 0 is up, 1 south, 2 west, 3 north,
/// 4 east, 5 down.
const FACE_COLOURS: [[u8; 3]; 6] =
    [[230, 230, 225], [60, 70, 190], [190, 170, 50], [180, 60, 50], [60, 150, 70], [110, 85, 60]];

/// The colour of the wall to the north, east, south and west (0 to 3), sRGB. JPEG changes it by a few levels.
#[must_use]
pub fn wall_colour(quarter: usize) -> [u8; 3] {
    FACE_COLOURS[[3, 4, 1, 2][quarter % 4]]
}

/// A strip of six faces as JPEG. `mark` shades each face a little, so that viewpoints with different marks look
/// different.
pub(crate) fn skybox_jpeg(mark: u8) -> io::Result<Vec<u8>> {
    let shade = |[red, green, blue]: [u8; 3]| Rgb([red, green, blue.wrapping_add(mark)]);
    let strip = RgbImage::from_fn(6 * SIDE_PX, SIDE_PX, |x, _| shade(FACE_COLOURS[(x / SIDE_PX) as usize]));
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 95)
        .write_image(&strip, strip.width(), strip.height(), image::ExtendedColorType::Rgb8)
        .map_err(|error: ImageError| io::Error::other(error))?;
    Ok(bytes)
}
