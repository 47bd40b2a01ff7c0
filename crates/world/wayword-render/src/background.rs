//! The background of a picture: the colour of every pixel that no triangle covers.

/// Colour of the pixels that no triangle covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureBackground {
    /// One colour.
    Plain([u8; 3]),
    /// Three colours, blended by the sine of the elevation of the pixel's ray.
    Sky {
        /// Straight up.
        zenith: [u8; 3],
        /// At eye level.
        horizon: [u8; 3],
        /// Straight down.
        nadir: [u8; 3],
    },
}

impl Default for PictureBackground {
    /// Black, as in Habitat.
    fn default() -> Self {
        Self::Plain([0; 3])
    }
}

impl PictureBackground {
    /// Colour along a ray; `sin_elevation` lies in [-1, 1].
    pub(crate) fn colour_along(&self, sin_elevation: f32) -> [u8; 3] {
        match *self {
            Self::Plain(colour) => colour,
            Self::Sky { zenith, horizon, nadir } => {
                let end = if sin_elevation > 0.0 { zenith } else { nadir };
                let weight = sin_elevation.abs();
                std::array::from_fn(|c| {
                    let (from, to) = (f32::from(horizon[c]), f32::from(end[c]));
                    (from + (to - from) * weight + 0.5) as u8
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sky_blends_from_horizon_to_both_ends() {
        let sky = PictureBackground::Sky { zenith: [0, 0, 200], horizon: [100; 3], nadir: [50, 0, 0] };
        assert_eq!(sky.colour_along(1.0), [0, 0, 200]);
        assert_eq!(sky.colour_along(0.0), [100; 3]);
        assert_eq!(sky.colour_along(-1.0), [50, 0, 0]);
        assert_eq!(sky.colour_along(0.5), [50, 50, 150]);
        assert_eq!(PictureBackground::default().colour_along(0.3), [0; 3]);
    }
}
