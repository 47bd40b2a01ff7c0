//! A whole model: from a picture and a prompt to the scores and boxes of its queries.

use super::{
    config::{Config, Family},
    decoder::{Decoder, Seen},
    encoder::EncoderLayer,
    features::{Eye, Features},
    picture::Shown,
    prompt::{self, Prompt},
    queries::Chooser,
    text::{Text, TextTower},
};
use crate::{Device, LocalError, Precision, picture::digest, text::Tokenizer, weights::Weights};
use candle_core::{DType, Result as Computed, Tensor};
use std::{path::Path, sync::Arc};
use wayword_core::{Image, Recent};

/// The memory that the features of recent pictures may take, bytes.
pub(crate) const KEPT_BYTES: usize = 256 << 20;

/// The edge of the patches into which the backbone cuts a picture, pixels.
const PATCH_PX: usize = 4;

/// MM Grounding DINO, LLMDet or Grounding DINO: finds things in pictures by phrases.
///
/// The features of a picture do not depend on the phrases. They are computed once, and kept for recent pictures in at
/// most 256 MiB.
pub struct Dino {
    pub(super) name: String,
    pub(super) family: Family,
    shown: Shown,
    tokenizer: Tokenizer,
    eye: Eye,
    reader: TextTower,
    encoder: Vec<EncoderLayer>,
    chooser: Chooser,
    decoder: Decoder,
    /// The most tokens of a prompt.
    longest: usize,
    device: Device,
    kept: Recent<[u8; 32], Features>,
}

/// The network's own numbers for a picture and a prompt, for comparisons with other implementations.
#[derive(Debug, Clone)]
pub struct DinoOutputs {
    /// The best candidate cells, the best first, whether or not they became queries.
    pub picked: Vec<u32>,
    /// For each query the logit of each token.
    pub logits: Vec<Vec<f32>>,
    /// The box of each query: middle, width and height, as shares of the picture's width and height.
    pub boxes: Vec<[f32; 4]>,
}

impl Dino {
    /// Reads `config.json`, `preprocessor_config.json`, `tokenizer.json` and the checkpoint of a folder. `name` is the
    /// model's name: `hf/ORG/NAME`.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(name: &str, folder: &Path, device: &Device, precision: Precision) -> Result<Self, LocalError> {
        let config = Config::read(folder)?;
        let shown = Shown::load(folder)?;
        let tokenizer = Tokenizer::load(folder)?;
        let weights = Weights::open(folder, device, precision)?;
        let (all, model) = (weights.scope(""), weights.scope("model"));
        let layer = |at: usize| EncoderLayer::load(&model.sub("encoder.layers").sub(at), &config);
        // The finest level, and a quarter as many cells for each coarser one.
        let cell_px = PATCH_PX << config.backbone.outputs.first().copied().unwrap_or_default();
        let of_one = (shown.most_pixels() / (cell_px * cell_px) + 1) * 4 / 3 * config.size * size_of::<f32>();
        Ok(Self {
            name: name.to_owned(),
            family: config.family,
            shown,
            tokenizer,
            eye: Eye::load(&model, &config)?,
            reader: TextTower::load(&model, &config)?,
            encoder: (0..config.encoder.count).map(layer).collect::<Result<_, _>>()?,
            chooser: Chooser::load(&model, &config)?,
            decoder: Decoder::load(&all, &config)?,
            longest: config.longest,
            device: device.clone(),
            kept: Recent::new((KEPT_BYTES / of_one).max(1)),
        })
    }

    /// Puts phrases into prompts, and computes the states of their texts.
    pub(super) fn prompts(&self, phrases: &[&str]) -> Result<Vec<(Prompt, Text)>, LocalError> {
        let read = |prompt: Prompt| {
            let text = self.reader.of(&prompt, &self.device.0);
            text.map(|text| (prompt, text)).map_err(|error| self.wrong(&error))
        };
        prompt::prompts(&self.name, &self.tokenizer, phrases, self.longest)?.into_iter().map(read).collect()
    }

    /// The features of a picture: kept ones, or else new ones, which are then kept.
    pub(super) fn features(&self, image: &Image) -> Result<Arc<Features>, LocalError> {
        self.kept.get_or_make(digest(image), || {
            let pixels = self.shown.tensor(image, &self.device)?;
            self.eye.of(&pixels).map_err(|error| self.wrong(&error))
        })
    }

    /// The scores and boxes of the queries, for one prompt and one picture.
    pub(super) fn seen(&self, features: &Features, text: &Text) -> Result<Seen, LocalError> {
        self.look(features, text, |best| best).map_err(|error| self.wrong(&error))
    }

    /// Like [`Dino::seen`], but `picked` may replace the best candidates, or reorder them. The order matters: each
    /// query begins with its own learned state, so that two equal candidates that change places change the result.
    pub(super) fn look(
        &self,
        features: &Features,
        text: &Text,
        picked: impl FnOnce(Vec<u32>) -> Vec<u32>,
    ) -> Computed<Seen> {
        let (cells, read) = self.encoded(features, text)?;
        let levels = &features.levels[..];
        let candidates = self.chooser.candidates(&cells, &read, levels)?;
        let picked = picked(self.chooser.best(&candidates));
        self.decoder.of(self.chooser.boxes(&candidates, &picked)?, &cells, &read, levels)
    }

    /// The states of cells and tokens after the encoder.
    pub(super) fn encoded(&self, features: &Features, text: &Text) -> Computed<(Tensor, Tensor)> {
        let levels = &features.levels[..];
        let positions = self.eye.positions(levels)?;
        let begin = (features.cells.clone(), text.states.clone());
        self.encoder
            .iter()
            .try_fold(begin, |(cells, states), layer| layer.of(&cells, &states, (&positions, levels), text))
    }

    /// The network's own numbers for a picture and phrases of one prompt. `order` replaces the best candidates by
    /// others: these cells become the queries, in this order.
    ///
    /// # Errors
    /// When the phrases are too many for one prompt, or the computation fails.
    pub fn outputs(&self, image: &Image, phrases: &[&str], order: Option<&[u32]>) -> Result<DinoOutputs, LocalError> {
        let prompts = self.prompts(phrases)?;
        let [(_, text)] = &prompts[..] else {
            let problem = "these phrases are not one prompt".to_owned();
            return Err(LocalError::Compute { model: self.name.clone(), problem });
        };
        let features = self.features(image)?;
        let mut picked = Vec::new();
        let seen = self.look(&features, text, |best| {
            picked.clone_from(&best);
            order.map_or(best, <[u32]>::to_vec)
        });
        let numbers = seen.and_then(|seen| Ok((seen.logits.to_dtype(DType::F32)?.to_vec2()?, seen.boxes)));
        let (logits, boxes) = numbers.map_err(|error| self.wrong(&error))?;
        Ok(DinoOutputs { picked, logits, boxes })
    }

    fn wrong(&self, error: &candle_core::Error) -> LocalError {
        LocalError::compute(&self.name, error)
    }
}

/// Intermediate results, for tests.
#[cfg(test)]
impl Dino {
    pub(super) fn pixels(&self, image: &Image) -> Tensor {
        self.shown.tensor(image, &self.device).unwrap()
    }

    pub(super) fn candidates(&self, features: &Features, text: &Text) -> Computed<Vec<f32>> {
        let (cells, read) = self.encoded(features, text)?;
        Ok(self.chooser.candidates(&cells, &read, &features.levels)?.scores)
    }
}
