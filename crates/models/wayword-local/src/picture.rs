//! Turns pictures into tensors, with the steps that a checkpoint's `preprocessor_config.json` prescribes.
//!
//! The numbers are the same as those of transformers' processors of CLIP, BLIP and BLIP-2 with Pillow, because a model
//! gives other answers to slightly different pixels.

mod config;
mod padded;
pub(crate) mod resample;

pub(crate) use padded::PaddedPictureProcessor;

use crate::{LocalError, ModelDevice};
use candle_core::Tensor;
use config::PictureConfig;
use rayon::prelude::*;
use resample::{ResampleAxis, ResampleFilter, resample_picture};
use sha2::{Digest, Sha256};
use std::path::Path;
use wayword_core::{Image, ModelError, View};

/// Prepares pictures for a model.
pub(crate) struct PictureProcessor {
    size: ResizeRule,
    /// The height of the output. Together with `width_px` the size that the model takes.
    height_px: usize,
    width_px: usize,
    filter: ResampleFilter,
    /// For each colour a table with the model's input for each value of a byte.
    numbers: [[f32; 256]; 3],
}

/// The rule by which a picture is resized, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ResizeRule {
    /// The whole picture to the output size. Its proportions may change.
    Whole,
    /// The shorter edge to this length, with the same proportions. Then the middle is cut out.
    ShortestEdge(usize),
    /// The whole picture to this height and width. Then the middle is cut out.
    Cropped(usize, usize),
}

impl PictureProcessor {
    /// Reads `preprocessor_config.json` of a model's folder.
    ///
    /// # Errors
    /// When it is missing, damaged, or for a processor that is not supported.
    pub(crate) fn load(folder: &Path) -> Result<Self, LocalError> {
        PictureConfig::read_processor(folder)
    }

    /// Height and width of the output, pixels.
    pub(crate) fn size_px(&self) -> (usize, usize) {
        (self.height_px, self.width_px)
    }

    /// Pictures as a tensor [pictures, 3, height, width] in 32 bits.
    ///
    /// # Errors
    /// When a picture has no pixels, or the device has no memory left.
    pub(crate) fn to_tensor(&self, images: &[&Image], device: &ModelDevice) -> Result<Tensor, LocalError> {
        let picture_error = |problem: String| LocalError::Compute { model: "pictures".to_owned(), problem };
        if let Some(empty) = images.iter().find(|image| image.width_px() == 0 || image.height_px() == 0) {
            return Err(picture_error(format!("{empty:?} has no pixels")));
        }
        let mut numbers = vec![0.0; images.len() * 3 * self.height_px * self.width_px];
        let pictures = numbers.par_chunks_mut(3 * self.height_px * self.width_px);
        pictures.zip(images).for_each(|(numbers, image)| self.fill_picture(image, numbers));
        let shape = (images.len(), 3, self.height_px, self.width_px);
        Tensor::from_vec(numbers, shape, &device.0).map_err(|error| picture_error(error.to_string()))
    }

    /// Resizes a picture and writes the model's input for it: all its reds, then all greens, then all blues.
    fn fill_picture(&self, image: &Image, numbers: &mut [f32]) {
        let (height, width) = (image.height_px() as usize, image.width_px() as usize);
        let (to_height, to_width) = match self.size {
            ResizeRule::Whole => (self.height_px, self.width_px),
            ResizeRule::Cropped(height, width) => (height, width),
            ResizeRule::ShortestEdge(edge) => match width <= height {
                true => (longer_edge(edge, height, width), edge),
                false => (edge, longer_edge(edge, width, height)),
            },
        };
        let down = ResampleAxis::keep_middle(self.filter, height, to_height, self.height_px);
        let across = ResampleAxis::keep_middle(self.filter, width, to_width, self.width_px);
        let rgb = resample_picture(image.rgb_bytes(), &down, &across);
        let planes = numbers.chunks_mut(self.height_px * self.width_px);
        for (plane, (colour, table)) in planes.zip(self.numbers.iter().enumerate()) {
            for (number, pixel) in plane.iter_mut().zip(rgb.chunks_exact(3)) {
                *number = table[usize::from(pixel[colour])];
            }
        }
    }
}

/// The length of the longer edge when the shorter one becomes `edge`, rounded down as Python's `int` does.
fn longer_edge(edge: usize, long: usize, short: usize) -> usize {
    ((edge * long) as f64 / short as f64) as usize
}

/// The picture of a view. The error for a view without one names the model that needs it.
pub(crate) fn picture_of_view<'a>(view: &'a View, model: &str) -> Result<&'a Image, ModelError> {
    let image = view.image.as_deref().filter(|image| !image.rgb_bytes().is_empty());
    image.ok_or_else(|| ModelError::NothingToSee {
        name: model.to_owned(),
        needs: "a picture",
        hint: "use a platform or data folder with pictures",
    })
}

/// A hash of a picture's size and pixels.
pub(crate) fn picture_digest(picture: &Image) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update(picture.width_px().to_le_bytes());
    hash.update(picture.height_px().to_le_bytes());
    hash.update(picture.rgb_bytes());
    hash.finalize().into()
}

#[cfg(test)]
mod tests;
