//! Measures how sharp a picture is, and how much it differs from another one.

use wayword_core::Image;

/// Size of the small grey copies that are compared, pixels.
const SMALL_WIDTH_PX: usize = 32;
const SMALL_HEIGHT_PX: usize = 24;
/// Least width at which sharpness is measured, pixels. Pictures of twice this width or more are shrunk first: motion blur is
/// wide, and noise of single pixels is not sharpness.
const MIN_MEASURED_WIDTH_PX: usize = 320;
/// Variance that a picture of one colour gets from its noise, levels squared.
const NOISE_VARIANCE: f64 = 25.0;

/// Measurements of a picture.
#[derive(Debug, Clone)]
pub(super) struct PictureMeasure {
    /// Variance of the Laplacian over that of the picture: the share of edges in what the picture shows.
    pub(super) sharpness: f64,
    /// The small grey copy, row by row, levels of 255.
    small: Vec<f32>,
}

impl PictureMeasure {
    /// Measures a picture.
    pub(super) fn from_image(image: &Image) -> Self {
        let (width, height) = (image.width_px() as usize, image.height_px() as usize);
        let step = (width / MIN_MEASURED_WIDTH_PX).max(1);
        let grey = shrink_to_grey(image, (width / step).max(1), (height / step).max(1));
        let sharpness = variance(&laplacian(&grey, (width / step).max(1))) / (variance(&grey) + NOISE_VARIANCE);
        Self { sharpness, small: shrink_to_grey(image, SMALL_WIDTH_PX, SMALL_HEIGHT_PX) }
    }

    /// Mean absolute difference, levels of 255.
    pub(super) fn mean_difference(&self, other: &Self) -> f64 {
        let sum: f32 = self.small.iter().zip(&other.small).map(|(a, b)| (a - b).abs()).sum();
        f64::from(sum) / self.small.len() as f64
    }
}

/// The picture in grey at another size: each pixel is the mean of those that it covers.
fn shrink_to_grey(image: &Image, wide: usize, high: usize) -> Vec<f32> {
    let (width, height) = (image.width_px() as usize, image.height_px() as usize);
    // Of `length` pixels in a row or column, those that pixel `at` of `count` covers: the first, and the one after the last.
    let span = |at: usize, count: usize, length: usize| {
        (at * length / count, ((at + 1) * length / count).max(at * length / count + 1).min(length))
    };
    let mut shrunk = Vec::with_capacity(wide * high);
    for y in 0..high {
        let (top, bottom) = span(y, high, height);
        for x in 0..wide {
            let (left, right) = span(x, wide, width);
            let mut sum = 0_u32;
            for row in top..bottom {
                let pixels = &image.rgb_bytes()[3 * (row * width + left)..3 * (row * width + right)];
                // Green counts twice, because eyes see it better than red and blue.
                sum += pixels
                    .chunks_exact(3)
                    .map(|p| u32::from(p[0]) + 2 * u32::from(p[1]) + u32::from(p[2]))
                    .sum::<u32>();
            }
            let count = ((bottom - top) * (right - left)).max(1);
            shrunk.push(sum as f32 / (4 * count) as f32);
        }
    }
    shrunk
}

/// The Laplacian of a grey picture, without its border: how much the four neighbours of each pixel differ from it.
fn laplacian(grey: &[f32], width: usize) -> Vec<f32> {
    let height = grey.len() / width;
    let mut edges = Vec::with_capacity(grey.len());
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            let at = y * width + x;
            edges.push(grey[at - 1] + grey[at + 1] + grey[at - width] + grey[at + width] - 4.0 * grey[at]);
        }
    }
    edges
}

fn variance(values: &[f32]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().map(|value| f64::from(*value)).sum::<f64>() / count;
    values.iter().map(|value| (f64::from(*value) - mean).powi(2)).sum::<f64>() / count
}
