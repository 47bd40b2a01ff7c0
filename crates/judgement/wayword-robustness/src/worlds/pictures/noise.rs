//! Adds gaussian noise to a picture.

use crate::{
    draws::normal_pair,
    worlds::altered_platform::{AlteredLook, frame_key},
};
use rand::Rng;
use wayword_core::{Image, image::WrongPixelCount, seeded_rng};

/// The random generator for the picture of one view.
pub(super) fn noise_rng(look: AlteredLook<'_>, seed: u64) -> impl Rng {
    let gaze = [look.gaze.heading.rad(), look.gaze.horizontal_fov_rad].map(f64::to_bits);
    let gaze = format!("{:x} {:x}", gaze[0], gaze[1]);
    seeded_rng(seed, &["picture noise", look.scene.as_str(), &frame_key(look.from), &gaze])
}

/// Adds noise to every value. `percent` is its standard deviation, per cent of full scale.
pub(super) fn add_noise(image: &Image, percent: f64, dice: &mut impl Rng) -> Result<Image, WrongPixelCount> {
    let levels = 255.0 * percent / 100.0;
    let mut rgb = image.rgb_bytes().to_vec();
    for pair in rgb.chunks_mut(2) {
        for (level, draw) in pair.iter_mut().zip(normal_pair(dice)) {
            *level = (f64::from(*level) + levels * draw + 0.5).clamp(0.0, 255.0) as u8;
        }
    }
    Image::new(image.width_px(), image.height_px(), rgb)
}
