//! Prepares pictures for OWLv2. The numbers are those of transformers' `Owlv2ImageProcessor`.
//!
//! The steps of the original: black is added at the right or at the bottom, so that the picture becomes a square. (Up
//! to version 4 transformers added grey.) A square that is larger than the model's is blurred first. The blur is a
//! Gaussian with a deviation of `(scale - 1) / 2` pixels, and mirrors the picture at its edges. Then each new pixel is
//! interpolated between the two nearest ones on each axis. All these steps are linear. So here each new pixel of an
//! axis has one list of weights, a window, and the black is never stored.

use crate::{LocalError, ModelDevice, json};
use candle_core::Tensor;
use rayon::prelude::*;
use serde::Deserialize;
use std::path::Path;
use wayword_core::Image;

/// CLIP's means and standard deviations of red, green and blue.
const CLIP_MEANS_RGB: [f64; 3] = [0.48145466, 0.4578275, 0.40821073];
const CLIP_DEVIATIONS_RGB: [f64; 3] = [0.26862954, 0.26130258, 0.27577711];

/// Prepares pictures.
pub(super) struct OwlPictureProcessor {
    /// Width and height of the result, pixels.
    edge: usize,
    /// The number for each value of a byte, before mean and deviation are applied.
    scaled: [f32; 256],
    mean: [f32; 3],
    deviation: [f32; 3],
}

/// `preprocessor_config.json`.
#[derive(Deserialize)]
struct OwlPictureConfig {
    image_processor_type: Option<String>,
    size: Option<OwlPictureSize>,
    do_pad: Option<bool>,
    do_resize: Option<bool>,
    do_rescale: Option<bool>,
    do_normalize: Option<bool>,
    rescale_factor: Option<f64>,
    image_mean: Option<[f64; 3]>,
    image_std: Option<[f64; 3]>,
}

/// The size to which pictures are resized, pixels.
#[derive(Deserialize)]
struct OwlPictureSize {
    height: usize,
    width: usize,
}

/// The old pixels and their weights for one new pixel.
struct OwlPixelWindow {
    /// The first old pixel.
    start: usize,
    weights: Vec<f32>,
}

impl OwlPictureProcessor {
    /// Reads `preprocessor_config.json` of a model that takes squares of `edge` pixels.
    pub(super) fn load(folder: &Path, edge: usize) -> Result<Self, LocalError> {
        let (config, file): (OwlPictureConfig, _) = json::read_picture_config(folder)?;
        config.build_processor(edge).map_err(|problem| LocalError::File {
            file,
            problem,
            hint: "choose an OWLv2 model, such as hf/google/owlv2-base-patch16-ensemble; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`",
        })
    }

    /// A picture as a tensor [1, 3, edge, edge] in 32 bits.
    pub(super) fn to_tensor(&self, image: &Image, device: &ModelDevice) -> Result<Tensor, LocalError> {
        let wrong = |problem: String| LocalError::Compute { model: "pictures".to_owned(), problem };
        if image.width_px() == 0 || image.height_px() == 0 {
            return Err(wrong(format!("{image:?} has no pixels")));
        }
        let shape = (1, 3, self.edge, self.edge);
        Tensor::from_vec(self.picture_numbers(image), shape, &device.0).map_err(|error| wrong(error.to_string()))
    }

    /// The model's input for a picture: all rows of red, then green, then blue, from the top.
    fn picture_numbers(&self, image: &Image) -> Vec<f32> {
        let (height, width, edge) = (image.height_px() as usize, image.width_px() as usize, self.edge);
        let square = height.max(width);
        let across = pixel_windows(square, edge, width);
        let down = pixel_windows(square, edge, height);
        let narrow: Vec<f32> =
            image.rgb_bytes().par_chunks(width * 3).flat_map_iter(|row| self.resize_row(row, &across)).collect();
        let mut numbers = vec![0.0; 3 * edge * edge];
        numbers.par_chunks_mut(edge).enumerate().for_each(|(at, row)| {
            let (colour, window) = (at / edge, &down[at % edge]);
            for (old, weight) in (window.start..).zip(&window.weights) {
                let old = &narrow[(old * 3 + colour) * edge..][..edge];
                row.iter_mut().zip(old).for_each(|(number, old)| *number += old * weight);
            }
            row.iter_mut().for_each(|number| *number = (*number - self.mean[colour]) / self.deviation[colour]);
        });
        numbers
    }

    /// Resizes a row of pixels. The result has all of its red, then green, then blue.
    fn resize_row(&self, row: &[u8], windows: &[OwlPixelWindow]) -> Vec<f32> {
        let mix_window = |colour: usize, window: &OwlPixelWindow| {
            let old = row[window.start * 3..].chunks_exact(3).zip(&window.weights);
            old.fold(0.0, |sum, (pixel, weight)| sum + self.scaled[usize::from(pixel[colour])] * weight)
        };
        (0..3).flat_map(|colour| windows.iter().map(move |window| mix_window(colour, window))).collect()
    }
}

impl OwlPictureConfig {
    fn build_processor(self, edge: usize) -> Result<OwlPictureProcessor, String> {
        if let Some(kind) = self.image_processor_type.filter(|kind| !kind.starts_with("Owlv2")) {
            return Err(format!("image_processor_type: {kind} is not OWLv2's"));
        }
        let steps = [
            ("do_pad", self.do_pad),
            ("do_resize", self.do_resize),
            ("do_rescale", self.do_rescale),
            ("do_normalize", self.do_normalize),
        ];
        if let Some((step, _)) = steps.iter().find(|(_, does)| *does == Some(false)) {
            return Err(format!("{step}: pictures without this step are not supported"));
        }
        let OwlPictureSize { height, width } = self.size.unwrap_or(OwlPictureSize { height: 960, width: 960 });
        if (height, width) != (edge, edge) {
            return Err(format!(
                "it belongs to another checkpoint: it makes pictures of {width} x {height} pixels, but the model sees {edge} x {edge}"
            ));
        }
        let (mean, deviation) =
            (self.image_mean.unwrap_or(CLIP_MEANS_RGB), self.image_std.unwrap_or(CLIP_DEVIATIONS_RGB));
        let factor = self.rescale_factor.unwrap_or(1.0 / 255.0);
        if deviation.contains(&0.0) || !deviation.iter().chain(&mean).chain([&factor]).all(|number| number.is_finite())
        {
            return Err("image_mean, image_std and rescale_factor must be finite, and image_std not 0".to_owned());
        }
        Ok(OwlPictureProcessor {
            edge,
            scaled: std::array::from_fn(|byte| byte as f32 * factor as f32),
            mean: mean.map(|number| number as f32),
            deviation: deviation.map(|number| number as f32),
        })
    }
}

/// One window for each of `to` new pixels of an axis of `from` old ones. Only the first `visible` old pixels are the
/// picture's, the others are black.
fn pixel_windows(from: usize, to: usize, visible: usize) -> Vec<OwlPixelWindow> {
    let scale = from as f64 / to as f64;
    let blur = gaussian_half((scale - 1.0) / 2.0);
    (0..to).map(|at| pixel_window(at, from, scale, &blur, visible)).collect()
}

/// The weights of a Gaussian from its middle outwards. A single 1 if `sigma` is 0, and there is no blur.
fn gaussian_half(sigma: f64) -> Vec<f64> {
    let reach = if sigma > 0.0 { (3.0 * sigma).ceil() as usize } else { 0 };
    let half: Vec<f64> =
        (0..=reach).map(|at| if at == 0 { 1.0 } else { (-0.5 * (at as f64 / sigma).powi(2)).exp() }).collect();
    let sum = half.iter().sum::<f64>() * 2.0 - 1.0;
    half.iter().map(|weight| weight / sum).collect()
}

/// The window of new pixel `at` on an axis of `from` old pixels. `scale` is the number of old pixels for a new one.
fn pixel_window(at: usize, from: usize, scale: f64, blur: &[f64], visible: usize) -> OwlPixelWindow {
    // Computed in 32 bits, as in PyTorch. Far from the corner the rounding is visible.
    let centre = ((at as f32 + 0.5) * scale as f32 - 0.5).max(0.0);
    let first = (centre as usize).min(from - 1);
    let share = f64::from(centre - first as f32);
    let reach = blur.len() - 1;
    let start = first.saturating_sub(reach);
    let mut weights = vec![0.0; (first + 1 + reach).min(from - 1) + 1 - start];
    for (pixel, share) in [(first, 1.0 - share), ((first + 1).min(from - 1), share)] {
        for step in 0..=2 * reach {
            let old = mirror_position(pixel as i64 + step as i64 - reach as i64, from);
            // A mirrored pixel lies on the window's side of the edge unless the blur is wider than the picture.
            if let Some(weight) = old.checked_sub(start).and_then(|old| weights.get_mut(old)) {
                *weight += share * blur[step.abs_diff(reach)];
            }
        }
    }
    weights.truncate(visible.saturating_sub(start));
    OwlPixelWindow { start: start.min(visible), weights: weights.into_iter().map(|weight| weight as f32).collect() }
}

/// The pixel that a position beyond an edge mirrors. The pixel at the edge is not repeated.
fn mirror_position(at: i64, count: usize) -> usize {
    let period = (2 * (count as i64 - 1)).max(1);
    let at = at.rem_euclid(period);
    at.min(period - at).min(count as i64 - 1) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The result of the same steps in PyTorch (`fixtures/make_owl.py`).
    #[derive(Deserialize)]
    struct Case {
        size: (u32, u32),
        edge: usize,
        step: usize,
        numbers: Vec<f32>,
    }

    fn drawn((width, height): (u32, u32)) -> Image {
        let byte = |at: u32| {
            let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
            ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
        };
        Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
    }

    fn processor(edge: usize, config: &serde_json::Value) -> Result<OwlPictureProcessor, LocalError> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("preprocessor_config.json"), config.to_string()).unwrap();
        OwlPictureProcessor::load(folder.path(), edge)
    }

    fn sized(edge: usize) -> serde_json::Value {
        serde_json::json!({ "image_processor_type": "Owlv2ImageProcessor", "size": { "height": edge, "width": edge } })
    }

    #[test]
    fn numbers_are_transformers() {
        let cases: Vec<Case> = serde_json::from_str(include_str!("../../fixtures/owl/pictures.json")).unwrap();
        assert!(cases.len() > 5);
        for Case { size, edge, step, numbers } in cases {
            let ours = processor(edge, &sized(edge)).unwrap().picture_numbers(&drawn(size));
            assert_eq!(ours.len(), 3 * edge * edge);
            assert_eq!(ours.len().div_ceil(step), numbers.len());
            for (at, (ours, theirs)) in ours.iter().step_by(step).zip(&numbers).enumerate() {
                assert!((ours - theirs).abs() < 5e-6, "{size:?} to {edge}, {at}: {ours} for {theirs}");
            }
        }
    }

    #[test]
    fn a_pixel_beyond_an_edge_is_its_mirror_image() {
        assert_eq!([-2, -1, 0, 3, 4, 5, 6].map(|at| mirror_position(at, 4)), [2, 1, 0, 3, 2, 1, 0]);
        assert_eq!([-3, 0, 9].map(|at| mirror_position(at, 1)), [0, 0, 0]);
    }

    #[test]
    fn a_thin_picture_takes_no_more_memory_than_a_square_one() {
        let numbers = processor(16, &sized(16)).unwrap().picture_numbers(&drawn((1, 50_000)));
        assert_eq!(numbers.len(), 3 * 16 * 16);
        assert!(numbers.iter().all(|number| number.is_finite()));
    }

    #[test]
    fn processor_reports_settings_it_does_not_support() {
        let mut cases = vec![(sized(8), "sees 16 x 16")];
        for (key, value, told) in [
            ("image_processor_type", "CLIPImageProcessor".into(), "CLIPImageProcessor"),
            ("do_pad", false.into(), "do_pad"),
            ("image_std", serde_json::json!([0.2, 0.0, 0.2]), "image_std"),
        ] {
            let mut config = sized(16);
            config[key] = value;
            cases.push((config, told));
        }
        for (config, told) in cases {
            let error = processor(16, &config).err().expect("it is refused").to_string();
            assert!(error.contains(told) && error.contains("preprocessor_config.json"), "{error}");
        }
        let empty = Image::new(0, 7, Vec::new()).unwrap();
        let error = processor(16, &sized(16)).unwrap().to_tensor(&empty, &ModelDevice::cpu()).unwrap_err().to_string();
        assert!(error.contains("0 x 7"), "{error}");
    }
}
