//! Interpolates the colours of a picture between the centres of its pixels.

use glam::Vec3;

/// The colour at a pixel position ((0, 0) is the top left corner of the picture), 0..=255 per channel: bilinear between
/// pixel centres, clamped at the edges. `rgb` holds three bytes for each of `width * height` pixels; there is at least
/// one pixel.
pub(crate) fn sample_bilinear(rgb: &[u8], [width, height]: [usize; 2], [x_px, y_px]: [f32; 2]) -> Vec3 {
    let split = |at_px: f32, side: usize| {
        let position = (at_px - 0.5).clamp(0.0, (side - 1) as f32);
        let index = position as usize;
        (index, (index + 1).min(side - 1), position - index as f32)
    };
    let (left, right, across) = split(x_px, width);
    let (above, below, down) = split(y_px, height);
    let at = |x: usize, y: usize| {
        let i = 3 * (y * width + x);
        Vec3::new(f32::from(rgb[i]), f32::from(rgb[i + 1]), f32::from(rgb[i + 2]))
    };
    let top = at(left, above) + (at(right, above) - at(left, above)) * across;
    let bottom = at(left, below) + (at(right, below) - at(left, below)) * across;
    top + (bottom - top) * down
}
