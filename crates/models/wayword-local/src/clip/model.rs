//! The whole CLIP: the text tower, the vision tower, and the projections into the space in which they are compared.

use super::{
    config::{Config, Family},
    text::TextTower,
    vision::VisionTower,
};
use crate::{
    Device, LocalError, Precision, error::FETCH_AGAIN, ops::Linear, picture::Processor, text::Tokenizer,
    weights::Weights,
};
use candle_core::{DType, Result as Computed, Tensor};
use std::path::Path;
use wayword_core::Image;

/// The number of pictures or texts that are computed together.
pub(super) const BATCH: usize = 32;

/// Turns pictures and texts into vectors of length 1. The larger their dot product, the better a text fits a picture.
pub struct Clip {
    name: String,
    processor: Processor,
    tokenizer: Tokenizer,
    vision: VisionTower,
    text: TextTower,
    visual_projection: Linear,
    text_projection: Linear,
    /// The most tokens of a text.
    longest: usize,
    device: Device,
}

impl Clip {
    /// Reads `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint of a folder. `name` is the
    /// model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(name: &str, folder: &Path, device: &Device, precision: Precision) -> Result<Self, LocalError> {
        let config = Config::read(folder, Family::Clip)?;
        let processor = Processor::load(folder)?;
        let edge = config.vision.image_size;
        if processor.size_px() != (edge, edge) {
            let (height, width) = processor.size_px();
            return Err(LocalError::File {
                file: folder.join("preprocessor_config.json"),
                problem: format!(
                    "it belongs to another checkpoint: it makes pictures of {width} x {height} pixels, but the model sees {edge} x {edge}"
                ),
                hint: FETCH_AGAIN,
            });
        }
        let tokenizer = Tokenizer::load(folder)?;
        let weights = Weights::open(folder, device, precision)?;
        let all = weights.scope("");
        let (vision, text, size) = (&config.vision, &config.text, config.projection_dim);
        Ok(Self {
            name: name.to_owned(),
            processor,
            tokenizer,
            // The checkpoints have this misspelling.
            vision: VisionTower::load(&weights.scope("vision_model"), vision, "pre_layrnorm")?,
            text: TextTower::load(&weights.scope("text_model"), text)?,
            visual_projection: all.linear("visual_projection", vision.layers.hidden_size, size)?,
            text_projection: all.linear("text_projection", text.layers.hidden_size, size)?,
            longest: text.max_position_embeddings,
            device: device.clone(),
        })
    }

    /// `hf/ORG/NAME`.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Unit vectors of pictures, in their order.
    ///
    /// # Errors
    /// When a picture has no pixels, or the computation fails.
    pub fn image_features(&self, images: &[&Image]) -> Result<Vec<Vec<f32>>, LocalError> {
        let mut vectors = Vec::with_capacity(images.len());
        for batch in images.chunks(BATCH) {
            let pictures = self.processor.tensor(batch, &self.device)?;
            let found = self.vision.of(&pictures).and_then(|states| units(&self.visual_projection.of(&states)?));
            vectors.extend(found.map_err(|error| self.failed(&error))?);
        }
        Ok(vectors)
    }

    /// Unit vectors of texts, in their order. Texts are used as they are: the caller may add "a photo of ..". Texts of
    /// similar length are computed together, so that there is little padding.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn text_features(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, LocalError> {
        let ids = texts.iter().map(|text| self.tokenizer.ids(text, self.longest));
        let ids: Vec<Vec<u32>> = ids.collect::<Result<_, _>>()?;
        let mut order: Vec<usize> = (0..texts.len()).collect();
        order.sort_by_key(|&at| ids[at].len());
        let mut vectors = vec![Vec::new(); texts.len()];
        for batch in order.chunks(BATCH) {
            let of_batch: Vec<&[u32]> = batch.iter().map(|&at| &ids[at][..]).collect();
            let states = self.text.of(&of_batch, &self.device.0);
            let found = states.and_then(|states| units(&self.text_projection.of(&states)?));
            for (&at, vector) in batch.iter().zip(found.map_err(|error| self.failed(&error))?) {
                vectors[at] = vector;
            }
        }
        Ok(vectors)
    }

    /// Whether the model reads a text to its end. The end of a text that is too long is cut off.
    ///
    /// # Errors
    /// When the text cannot be made into tokens.
    pub fn holds(&self, text: &str) -> Result<bool, LocalError> {
        Ok(self.tokenizer.ids(text, usize::MAX)?.len() <= self.longest)
    }

    fn failed(&self, error: &candle_core::Error) -> LocalError {
        LocalError::Compute { model: self.name.clone(), problem: error.to_string() }
    }
}

/// Scales vectors [batch, 1, size] to length 1.
fn units(vectors: &Tensor) -> Computed<Vec<Vec<f32>>> {
    let vectors = vectors.squeeze(1)?.to_dtype(DType::F32)?;
    let length = vectors.sqr()?.sum_keepdim(1)?.sqrt()?;
    vectors.broadcast_div(&length.maximum(1e-12)?)?.to_vec2()
}
