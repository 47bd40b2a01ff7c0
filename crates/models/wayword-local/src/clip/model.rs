//! The whole CLIP: the text tower, the vision tower, and the projections into the space in which they are compared.

use super::{
    config::{ClipConfig, TowerFamily},
    text::TextTower,
    vision::VisionTower,
};
use crate::{
    LocalError, ModelDevice, WeightPrecision, error::FETCH_AGAIN, ops::LinearLayer, picture::PictureProcessor,
    tokenizer::TextTokenizer, weights::CheckpointWeights,
};
use candle_core::{DType, Result as Computed, Tensor};
use std::path::Path;
use wayword_core::Image;

/// The number of pictures or texts that are computed together.
pub(super) const ITEMS_PER_BATCH: usize = 32;

/// Turns pictures and texts into vectors of length 1. The larger their dot product, the better a text fits a picture.
pub struct ClipModel {
    name: String,
    processor: PictureProcessor,
    tokenizer: TextTokenizer,
    vision: VisionTower,
    text: TextTower,
    visual_projection: LinearLayer,
    text_projection: LinearLayer,
    /// The most tokens of a text.
    max_text_tokens: usize,
    device: ModelDevice,
}

impl ClipModel {
    /// Reads `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint of a folder. `name` is the
    /// model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(
        name: &str,
        folder: &Path,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<Self, LocalError> {
        let config = ClipConfig::from_folder(folder, TowerFamily::Clip)?;
        let processor = PictureProcessor::load(folder)?;
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
        let tokenizer = TextTokenizer::load(folder)?;
        let weights = CheckpointWeights::open(folder, device, precision)?;
        let root = weights.scope_under("");
        let (vision, text, size) = (&config.vision, &config.text, config.projection_dim);
        Ok(Self {
            name: name.to_owned(),
            processor,
            tokenizer,
            // `pre_layrnorm` is misspelt in the checkpoints.
            vision: VisionTower::from_weights(&weights.scope_under("vision_model"), vision, "pre_layrnorm")?,
            text: TextTower::from_weights(&weights.scope_under("text_model"), text)?,
            visual_projection: root.read_linear("visual_projection", vision.layers.hidden_size, size)?,
            text_projection: root.read_linear("text_projection", text.layers.hidden_size, size)?,
            max_text_tokens: text.max_position_embeddings,
            device: device.clone(),
        })
    }

    /// The name of the model, `hf/ORG/NAME`.
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
        for batch in images.chunks(ITEMS_PER_BATCH) {
            let pictures = self.processor.to_tensor(batch, &self.device)?;
            let batch_vectors = self
                .vision
                .encode_pictures(&pictures)
                .and_then(|states| unit_vectors(&self.visual_projection.apply_to(&states)?));
            vectors.extend(batch_vectors.map_err(|error| self.compute_error(&error))?);
        }
        Ok(vectors)
    }

    /// Unit vectors of texts, in their order. Texts are used as they are: the caller may add "a photo of ..". Texts of
    /// similar length are computed together, so that there is little padding.
    ///
    /// # Errors
    /// When the computation fails.
    pub fn text_features(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, LocalError> {
        let ids = texts.iter().map(|text| self.tokenizer.text_ids(text, self.max_text_tokens));
        let ids: Vec<Vec<u32>> = ids.collect::<Result<_, _>>()?;
        let mut order: Vec<usize> = (0..texts.len()).collect();
        order.sort_by_key(|&at| ids[at].len());
        let mut vectors = vec![Vec::new(); texts.len()];
        for batch in order.chunks(ITEMS_PER_BATCH) {
            let batch_ids: Vec<&[u32]> = batch.iter().map(|&at| &ids[at][..]).collect();
            let states = self.text.encode_texts(&batch_ids, &self.device.0);
            let batch_vectors = states.and_then(|states| unit_vectors(&self.text_projection.apply_to(&states)?));
            for (&at, vector) in batch.iter().zip(batch_vectors.map_err(|error| self.compute_error(&error))?) {
                vectors[at] = vector;
            }
        }
        Ok(vectors)
    }

    /// Whether the model reads a text to its end. The end of a text that is too long is cut off.
    ///
    /// # Errors
    /// When the text cannot be made into tokens.
    pub fn reads_whole_text(&self, text: &str) -> Result<bool, LocalError> {
        Ok(self.tokenizer.text_ids(text, usize::MAX)?.len() <= self.max_text_tokens)
    }

    fn compute_error(&self, error: &candle_core::Error) -> LocalError {
        LocalError::Compute { model: self.name.clone(), problem: error.to_string() }
    }
}

/// Scales vectors [batch, 1, size] to length 1.
fn unit_vectors(vectors: &Tensor) -> Computed<Vec<Vec<f32>>> {
    let vectors = vectors.squeeze(1)?.to_dtype(DType::F32)?;
    let length = vectors.sqr()?.sum_keepdim(1)?.sqrt()?;
    vectors.broadcast_div(&length.maximum(1e-12)?)?.to_vec2()
}
