//! From a pass's bytes to pixels.

use super::{error::TdwError, output::Pass};
use image::{ImageFormat, ImageReader, Limits};
use std::io::Cursor;

/// Longest side of a picture that is taken, pixels.
const MAX_SIDE_PX: u32 = 8192;
/// Near and far plane of the build's cameras, metres.
const PLANES_M: [f32; 2] = [0.1, 100.0];

/// The number of a pass in `imag`, and its name in commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Img,
    Id,
}

impl Kind {
    pub(super) fn mask(self) -> i32 {
        match self {
            Self::Img => 1,
            Self::Id => 2,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Img => "_img",
            Self::Id => "_id",
        }
    }
}

/// The RGB pixels of a PNG or JPEG pass, rows from the top.
///
/// # Errors
/// When it cannot be decoded, or is not of the size that was announced with it.
pub(super) fn rgb(pass: &Pass<'_>, kind: Kind, (width, height): (u32, u32)) -> Result<Vec<u8>, TdwError> {
    let refused = |reason: String| TdwError::Picture { pass: kind.name(), reason };
    if !(1..=MAX_SIDE_PX).contains(&width) || !(1..=MAX_SIDE_PX).contains(&height) {
        return Err(refused(format!("{width} x {height} pixels: each side must lie in 1..={MAX_SIDE_PX}")));
    }
    let mut reader = ImageReader::new(Cursor::new(pass.bytes));
    reader.set_format(if pass.extension == 2 { ImageFormat::Jpeg } else { ImageFormat::Png });
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(width), Some(height));
    limits.max_alloc = Some((64 << 20) + u64::from(width) * u64::from(height) * 16);
    reader.limits(limits);
    let decoded = reader.decode().map_err(|error| refused(error.to_string()))?;
    if (decoded.width(), decoded.height()) != (width, height) {
        return Err(refused(format!(
            "its file has {} x {} pixels: expected {width} x {height}",
            decoded.width(),
            decoded.height()
        )));
    }
    Ok(decoded.into_rgb8().into_raw())
}

/// Depth along the camera's forward axis from a `_depth` pass, metres, rows from the top: raw pixels with the bottom row
/// first, `(r + g / 256 + b / 65536) * (far - near) / 256` (`TDWUtils.get_depth_values`).
///
/// # Errors
/// When there are not three bytes for each pixel.
pub fn depth_m(bytes: &[u8], width: u32, height: u32) -> Result<Vec<f32>, TdwError> {
    let row = width as usize * 3;
    if row == 0 || bytes.len() as u64 != u64::from(width) * u64::from(height) * 3 {
        let reason = format!("{} bytes: expected {width} x {height} pixels of 3", bytes.len());
        return Err(TdwError::Picture { pass: "_depth", reason });
    }
    let [near, far] = PLANES_M;
    let metres =
        |[r, g, b]: &[u8; 3]| (f32::from(*r) + f32::from(*g) / 256.0 + f32::from(*b) / 65536.0) * (far - near) / 256.0;
    Ok(bytes.chunks_exact(row).rev().flat_map(|row| row.as_chunks().0.iter().map(metres)).collect())
}
