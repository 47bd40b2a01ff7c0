//! Prepares pictures for the models of the Grounding DINO family. The numbers are those of transformers' processor with
//! Pillow.

use crate::{
    LocalError, ModelDevice, json,
    picture::resample::{ResampleAxis, ResampleFilter, resample_picture},
};
use candle_core::Tensor;
use serde::Deserialize;
use std::path::Path;
use wayword_core::Image;

/// The longest edge of a picture that a configuration may ask for, pixels. A longer one is refused.
const MAX_EDGE_PX: usize = 2048;

/// ImageNet's means and standard deviations of red, green and blue.
const IMAGENET_MEANS_RGB: [f64; 3] = [0.485, 0.456, 0.406];
const IMAGENET_DEVIATIONS_RGB: [f64; 3] = [0.229, 0.224, 0.225];

/// `preprocessor_config.json`.
#[derive(Debug, Deserialize)]
struct DinoPictureConfig {
    #[serde(alias = "feature_extractor_type")]
    image_processor_type: Option<String>,
    size: Option<DinoEdgeLimits>,
    max_size: Option<usize>,
    do_resize: Option<bool>,
    do_rescale: Option<bool>,
    do_normalize: Option<bool>,
    resample: Option<u32>,
    rescale_factor: Option<f64>,
    image_mean: Option<[f64; 3]>,
    image_std: Option<[f64; 3]>,
}

/// A size, in the forms that files use.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum DinoEdgeLimits {
    /// The length of the shorter edge, and the most for the longer one, pixels.
    Both { shortest_edge: usize, longest_edge: usize },
    /// The length of the shorter edge, pixels. The most for the longer one is in `max_size`.
    One(usize),
}

/// Prepares pictures: resizes them until the shorter edge has `shortest` pixels, or fewer where the longer edge would
/// otherwise exceed `longest` pixels.
#[derive(Debug)]
pub(super) struct DinoPictureProcessor {
    shortest: usize,
    longest: usize,
    /// For each colour a table with the model's input for each value of a byte.
    numbers: [[f32; 256]; 3],
}

impl DinoPictureProcessor {
    pub(super) fn load(folder: &Path) -> Result<Self, LocalError> {
        let (config, file): (DinoPictureConfig, _) = json::read_picture_config(folder)?;
        config.build_processor().map_err(|problem| LocalError::File {
            file,
            problem,
            hint: "choose a model of Grounding DINO's architecture, such as hf/iSEE-Laboratory/llmdet_tiny; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`",
        })
    }

    /// The most pixels of a picture for the model.
    pub(super) fn max_pixels(&self) -> usize {
        self.shortest * self.longest
    }

    /// A picture as a tensor [1, 3, height, width] in 32 bits.
    pub(super) fn to_tensor(&self, image: &Image, device: &ModelDevice) -> Result<Tensor, LocalError> {
        let wrong = |problem: String| LocalError::Compute { model: "pictures".to_owned(), problem };
        let (from_height, from_width) = (image.height_px() as usize, image.width_px() as usize);
        if from_height == 0 || from_width == 0 {
            return Err(wrong(format!("{image:?} has no pixels")));
        }
        let (height, width) = self.resized_size(from_height, from_width);
        let axis = |from, to| ResampleAxis::keep_middle(ResampleFilter::Bilinear, from, to, to);
        let rgb = resample_picture(image.rgb_bytes(), &axis(from_height, height), &axis(from_width, width));
        let mut numbers = vec![0.0; 3 * height * width];
        for (colour, (numbers, table)) in numbers.chunks_mut(height * width).zip(&self.numbers).enumerate() {
            for (number, pixel) in numbers.iter_mut().zip(rgb.chunks_exact(3)) {
                *number = table[usize::from(pixel[colour])];
            }
        }
        Tensor::from_vec(numbers, (1, 3, height, width), &device.0).map_err(|error| wrong(error.to_string()))
    }

    /// The height and width to which a picture is resized, rounded as Python rounds them.
    fn resized_size(&self, height: usize, width: usize) -> (usize, usize) {
        let (short, long) = (height.min(width), height.max(width));
        let (mut edge, mut exact) = (self.shortest, self.shortest as f64);
        if long as f64 / short as f64 * edge as f64 > self.longest as f64 {
            exact = self.longest as f64 * short as f64 / long as f64;
            edge = exact.round_ties_even() as usize;
        }
        if short == edge {
            return (height, width);
        }
        // A very narrow picture would otherwise get an edge of 0 pixels.
        let edge = edge.max(1);
        let other = ((exact * long as f64 / short as f64) as usize).max(1);
        if width < height { (other, edge) } else { (edge, other) }
    }
}

impl DinoPictureConfig {
    fn build_processor(&self) -> Result<DinoPictureProcessor, String> {
        if let Some(name) = self.image_processor_type.as_deref().filter(|name| !name.contains("GroundingDino")) {
            return Err(format!("image_processor_type: {name} is not Grounding DINO's"));
        }
        if self.do_resize == Some(false) {
            return Err("do_resize: pictures that are not resized are not supported".to_owned());
        }
        if let Some(other) = self.resample.filter(|&filter| filter != 2) {
            return Err(format!("resample: {other} is not 2 (bilinear)"));
        }
        let (shortest, longest) = match self.size {
            None => (800, 1333),
            Some(DinoEdgeLimits::One(edge)) => (edge, self.max_size.unwrap_or(1333)),
            Some(DinoEdgeLimits::Both { shortest_edge, longest_edge }) => (shortest_edge, longest_edge),
        };
        if shortest == 0 || shortest > longest || longest > MAX_EDGE_PX {
            return Err(format!("size: edges of {shortest} and {longest} pixels are not between 1 and {MAX_EDGE_PX}"));
        }
        Ok(DinoPictureProcessor { shortest, longest, numbers: self.byte_values()? })
    }

    /// The model's input for each value of a byte, for each colour.
    fn byte_values(&self) -> Result<[[f32; 256]; 3], String> {
        let factor = if self.do_rescale == Some(false) { 1.0 } else { self.rescale_factor.unwrap_or(1.0 / 255.0) };
        let (mean, deviation) = match self.do_normalize {
            Some(false) => ([0.0; 3], [1.0; 3]),
            _ => (self.image_mean.unwrap_or(IMAGENET_MEANS_RGB), self.image_std.unwrap_or(IMAGENET_DEVIATIONS_RGB)),
        };
        let is_finite = deviation.iter().chain(&mean).chain([&factor]).all(|number| number.is_finite());
        if deviation.contains(&0.0) || !is_finite {
            return Err("image_mean, image_std and rescale_factor must be finite, and image_std not 0".to_owned());
        }
        Ok(std::array::from_fn(|colour| {
            std::array::from_fn(|byte| ((byte as f64 * factor) as f32 - mean[colour] as f32) / deviation[colour] as f32)
        }))
    }
}
