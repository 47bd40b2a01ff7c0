//! Changes of pictures: exposure, colour of the light, blur, noise and JPEG compression. Labels and other data stay as they are.

mod blur;
mod jpeg;
mod light;
mod noise;

use super::{WorldAlteration, altered_platform::AlteredLook};
use std::sync::Arc;
use wayword_core::{Image, PlatformError, View, image::WrongPixelCount};

/// A change of every picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PictureChange {
    /// More light or less: linear light times two to the power of `stops`. What gets brighter than white is white.
    Exposure {
        /// Stops; 0 changes nothing.
        stops: f64,
    },
    /// Light of another colour, for a camera that is set to 6500 K: lower is more orange. A grey keeps its luminance.
    ColourTemperature {
        /// Kelvin, 1667 to 25000; 6500 changes nothing.
        kelvin: f64,
    },
    /// A gaussian blur of the linear light, as by a lens that is out of focus.
    Blur {
        /// Standard deviation, pixels; 0 changes nothing.
        sigma_px: f64,
    },
    /// Gaussian noise on each pixel and colour. It depends on the scene, the place, the gaze and the seed, so the same view always
    /// has the same noise. The noise of two doses is proportional, except where values are clipped.
    Noise {
        /// Standard deviation, per cent of full scale; 0 changes nothing.
        percent: f64,
        /// The seed of the draws.
        seed: u64,
    },
    /// Compression and decompression as a JPEG file.
    Jpeg {
        /// Quality on the scale of the IJG's library, 1 to 99; 100 makes no file and leaves the picture as it is.
        quality_percent: u8,
    },
}

/// A picture could not be changed.
#[derive(Debug, thiserror::Error)]
enum PictureChangeError {
    #[error(transparent)]
    Size(#[from] WrongPixelCount),
    #[error("its picture cannot be made a JPEG file: {0}")]
    Jpeg(#[from] image::ImageError),
}

impl WorldAlteration for PictureChange {
    fn view_after(&self, look: AlteredLook<'_>, mut view: View) -> Result<View, PlatformError> {
        let Some(image) = &view.image else { return Ok(view) };
        let after = self.apply_to(look, image);
        let after =
            after.map_err(|why| PlatformError::NotDrawn { scene: look.scene.clone(), reason: why.to_string() })?;
        view.image = Some(Arc::new(after));
        Ok(view)
    }
}

impl PictureChange {
    fn apply_to(self, look: AlteredLook<'_>, image: &Image) -> Result<Image, PictureChangeError> {
        Ok(match self {
            Self::Exposure { stops } => light::scale_light(image, [libm::exp2(stops); 3])?,
            Self::ColourTemperature { kelvin } => light::scale_light(image, light::temperature_gains(kelvin))?,
            Self::Blur { sigma_px } => blur::blur_image(image, sigma_px)?,
            Self::Noise { percent, seed } => noise::add_noise(image, percent, &mut noise::noise_rng(look, seed))?,
            Self::Jpeg { quality_percent } => jpeg::through_jpeg(image, quality_percent)?,
        })
    }
}

#[cfg(test)]
mod tests;
