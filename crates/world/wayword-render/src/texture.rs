//! Textures as the caller gives them, with the check of their sizes, and the ways of looking them up.

/// The longest side a texture may have.
pub const MAX_TEXTURE_SIDE: u32 = 16_384;

/// An sRGB picture that is laid on triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, alpha as stored (gamma-encoded); row 0 is the top, `width * height` of them.
    pub texels: Vec<[u8; 4]>,
}

/// How a texture is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TextureFilter {
    /// Bilinear on the full picture: exact, but fine patterns shimmer in the distance.
    #[default]
    Bilinear,
    /// The nearest texel, unblended: for pictures with object ids encoded as colours.
    Nearest,
    /// Between the two levels of a mip chain that fit the pixel's footprint: no shimmer in the distance.
    Trilinear,
}

/// Why a texture cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextureError {
    /// A side is zero or too long.
    #[error("texture of {width}x{height} texels: each side must be from 1 to {MAX_TEXTURE_SIDE}")]
    Size {
        /// Texels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The texels do not fill the picture.
    #[error("texture of {width}x{height} has {texels} texels: give exactly width x height")]
    Texels {
        /// Texels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Texels given.
        texels: usize,
    },
}

impl Texture {
    /// A texture, if its sides are within bounds and filled by its texels.
    ///
    /// # Errors
    /// [`TextureError`] where they are not.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Result<Self, TextureError> {
        let texture = Self { width, height, texels };
        texture.check_texels()?;
        Ok(texture)
    }

    pub(crate) fn check_texels(&self) -> Result<(), TextureError> {
        let (width, height) = (self.width, self.height);
        let sides = 1..=MAX_TEXTURE_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            return Err(TextureError::Size { width, height });
        }
        if self.texels.len() != width as usize * height as usize {
            return Err(TextureError::Texels { width, height, texels: self.texels.len() });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_wrong_sizes() {
        assert_eq!(Texture::new(0, 1, vec![]), Err(TextureError::Size { width: 0, height: 1 }));
        assert_eq!(Texture::new(1, u32::MAX, vec![]), Err(TextureError::Size { width: 1, height: u32::MAX }));
        assert_eq!(Texture::new(2, 2, vec![[0; 4]; 3]), Err(TextureError::Texels { width: 2, height: 2, texels: 3 }));
        assert!(Texture::new(2, 2, vec![[0; 4]; 4]).is_ok());
    }
}
