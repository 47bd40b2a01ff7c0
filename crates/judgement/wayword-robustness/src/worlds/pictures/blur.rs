//! Blurs a picture by a gaussian, in linear light.

use super::light::{linear_from_srgb, srgb_from_linear};
use wayword_core::{Image, image::WrongPixelCount};

/// Blurs a picture by a gaussian that is cut off at three standard deviations. Outside the picture, the pixels of its edge are
/// repeated.
pub(super) fn blur_image(image: &Image, sigma_px: f64) -> Result<Image, WrongPixelCount> {
    let kernel = gaussian_kernel(sigma_px);
    let [width, height] = [image.width_px(), image.height_px()].map(|side| side as usize);
    let linear: Vec<f64> = (0..=u8::MAX).map(linear_from_srgb).collect();
    let light: Vec<f64> = image.rgb_bytes().iter().map(|level| linear[usize::from(*level)]).collect();
    let along_rows = convolve_lines(&light, &kernel, (width, 3), (height, width * 3));
    let along_columns = convolve_lines(&along_rows, &kernel, (height, width * 3), (width, 3));
    Image::new(image.width_px(), image.height_px(), along_columns.into_iter().map(srgb_from_linear).collect())
}

/// The weights from the middle outwards. Over both sides they sum to 1.
fn gaussian_kernel(sigma_px: f64) -> Vec<f64> {
    let sigma_px = sigma_px.max(0.0);
    let reach = libm::ceil(3.0 * sigma_px) as usize;
    let weight = |step: usize| {
        let off = if step == 0 { 0.0 } else { step as f64 / sigma_px };
        libm::exp(-0.5 * off * off)
    };
    let half: Vec<f64> = (0..=reach).map(weight).collect();
    let sum = 2.0 * half.iter().sum::<f64>() - half[0];
    half.into_iter().map(|weight| weight / sum).collect()
}

/// Convolves three interleaved colours along one direction: `count` pixels at a `stride`, on each of `lines` lines, which begin
/// `next_line` values apart.
fn convolve_lines(
    light: &[f64],
    kernel: &[f64],
    (count, stride): (usize, usize),
    (lines, next_line): (usize, usize),
) -> Vec<f64> {
    let mut out = vec![0.0; light.len()];
    for line in 0..lines {
        for at in 0..count {
            for colour in 0..3 {
                let value = |at: usize| light[line * next_line + at * stride + colour];
                let pair = |(off, weight): (usize, &f64)| {
                    weight * (value(at.saturating_sub(off)) + value((at + off).min(count - 1)))
                };
                let sides: f64 = kernel.iter().enumerate().skip(1).map(pair).sum();
                out[line * next_line + at * stride + colour] = kernel[0] * value(at) + sides;
            }
        }
    }
    out
}
