//! Images in memory, as pixels. Other crates decode and encode image files.

/// An 8-bit sRGB image.
#[derive(Clone, PartialEq, Eq)]
pub struct Image {
    width_px: u32,
    height_px: u32,
    rgb: Vec<u8>,
}

/// The pixel buffer does not fit the size that was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("an image of {width_px} x {height_px} pixels needs {} bytes of RGB, not {actual}", u64::from(*width_px) * u64::from(*height_px) * 3)]
pub struct WrongPixelCount {
    width_px: u32,
    height_px: u32,
    actual: usize,
}

impl Image {
    /// An image from `width_px * height_px * 3` bytes, rows from the top, RGB.
    ///
    /// # Errors
    /// When the buffer has another length.
    pub fn new(width_px: u32, height_px: u32, rgb: Vec<u8>) -> Result<Self, WrongPixelCount> {
        if rgb.len() as u64 == u64::from(width_px) * u64::from(height_px) * 3 {
            Ok(Self { width_px, height_px, rgb })
        } else {
            Err(WrongPixelCount { width_px, height_px, actual: rgb.len() })
        }
    }

    /// Width in pixels.
    #[must_use]
    pub fn width_px(&self) -> u32 {
        self.width_px
    }

    /// Height in pixels.
    #[must_use]
    pub fn height_px(&self) -> u32 {
        self.height_px
    }

    /// The pixels: rows from the top, RGB.
    #[must_use]
    pub fn rgb_bytes(&self) -> &[u8] {
        &self.rgb
    }
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Image({} x {})", self.width_px, self.height_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_buffer_must_fit_the_size() {
        assert!(Image::new(2, 1, vec![0; 6]).is_ok());
        let error = Image::new(2, 2, vec![0; 6]).unwrap_err().to_string();
        assert_eq!(error, "an image of 2 x 2 pixels needs 12 bytes of RGB, not 6");
    }
}
