//! Decodes the passes of a picture: colours (`_img`), object colours (`_id`) and depth (`_depth`).

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

use super::{error::TdwError, output::PicturePass};
use crate::decode;
use image::ImageFormat;

/// Near and far plane of the build's cameras, metres.
const PLANES_M: [f32; 2] = [0.1, 100.0];

/// The passes that Wayword asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PassKind {
    /// Colours as an eye sees them.
    Img,
    /// The colour of the object at each pixel.
    Id,
}

impl PassKind {
    /// Its number in `imag`.
    pub(super) fn pass_mask(self) -> i32 {
        match self {
            Self::Img => 1,
            Self::Id => 2,
        }
    }

    /// Its name in commands.
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
pub(super) fn decode_pass(pass: &PicturePass<'_>, kind: PassKind, size: (u32, u32)) -> Result<Vec<u8>, TdwError> {
    let format = if pass.extension == 2 { ImageFormat::Jpeg } else { ImageFormat::Png };
    decode::decode_rgb(pass.bytes, format, size).map_err(|reason| TdwError::Picture { pass: kind.name(), reason })
}

/// Depth along the camera's forward axis from a `_depth` pass, metres, rows from the top. The pass has raw pixels with
/// the bottom row first: `(r + g / 256 + b / 65536) * (far - near) / 256` (`TDWUtils.get_depth_values`).
///
/// # Errors
/// When there are not three bytes for each pixel.
pub fn depth_m(bytes: &[u8], width: u32, height: u32) -> Result<Vec<f32>, TdwError> {
    let row = width as usize * 3;
    if row == 0 || bytes.len() as u64 != u64::from(width) * u64::from(height) * 3 {
        let reason = format!("its length is {}: expected {width} x {height} pixels of 3 bytes", bytes.len());
        return Err(TdwError::Picture { pass: "_depth", reason });
    }
    let [near, far] = PLANES_M;
    let metres =
        |[r, g, b]: &[u8; 3]| (f32::from(*r) + f32::from(*g) / 256.0 + f32::from(*b) / 65536.0) * (far - near) / 256.0;
    Ok(bytes.chunks_exact(row).rev().flat_map(|row| row.as_chunks().0.iter().map(metres)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_comes_with_its_bottom_row_first() {
        let depth = depth_m(&[0, 0, 0, 1, 0, 0, /**/ 128, 0, 0, 0, 1, 0], 2, 2).unwrap();
        let unit = 99.9 / 256.0;
        let expected = [128.0 * unit, unit / 256.0, 0.0, unit];
        assert!(depth.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{depth:?}");
        assert!(depth_m(&[0; 11], 2, 2).is_err() && depth_m(&[], 0, 0).is_err());
    }
}
