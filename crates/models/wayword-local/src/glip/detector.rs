//! A whole GLIP as a [`Detector`]: from a picture and phrases to boxes with scores.

use super::{
    GlipFiles,
    boxes::{Sizes, boxes},
    config::Config,
    head::Said,
    model::Model,
    prompt::{MOST_TOKENS, Prompt, prompts},
};
use crate::{
    Device, LocalError, Precision,
    ops::conv3::Map,
    picture::{Edges, digest, of_view},
    text::Tokenizer,
    weights::Weights,
};
use candle_core::{Result as Computed, Tensor};
use std::path::Path;
use wayword_core::{Detector, Found, Image, ModelError, Recent, Scoring, View};

/// The most memory for the features of recent pictures, bytes.
pub(crate) const FEATURES_BYTES: usize = 512 << 20;

/// Means and standard deviations of the bytes of blue, green and red.
const MEAN: [f32; 3] = [103.53, 116.28, 123.675];
const DEVIATION: [f32; 3] = [57.375, 57.12, 58.395];

/// The longest edge of a picture for the model, pixels.
const LONGEST_EDGE: usize = 1333;

/// GLIP. The score of a box is the root of the phrase's probability times the box's centreness, as in the original.
/// Boxes with a probability of 0.05 or less are left out.
///
/// The features of pictures are kept, in at most 512 MiB of memory, so that further phrases only cost the time of the
/// head.
pub struct Glip {
    name: String,
    model: Model,
    tokenizer: Tokenizer,
    edges: Edges,
    most_tokens: usize,
    device: Device,
    seen: Recent<[u8; 32], Seen>,
}

/// A picture's features, and its size as the model sees it.
struct Seen {
    levels: Vec<Map>,
    size: (usize, usize),
}

impl Glip {
    /// The usual short edge of a picture for the model, pixels.
    pub const SHORT_EDGE_PX: usize = 800;

    /// Reads a checkpoint. `name` is the model's name. A shorter edge is faster and finds less.
    ///
    /// # Errors
    /// When a file is missing or damaged, or the checkpoint has another architecture.
    pub fn load(
        name: &str,
        files: &GlipFiles,
        short_edge_px: usize,
        device: &Device,
        precision: Precision,
    ) -> Result<Self, LocalError> {
        let config = Config::read(files.weights.parent().unwrap_or(Path::new(".")))?;
        let edges = Edges::new(short_edge_px, LONGEST_EDGE, 32, [2, 1, 0], MEAN, DEVIATION)?;
        let tokenizer = Tokenizer::load(&files.tokenizer)?;
        let most_words = config.text.vocab_size();
        if tokenizer.size() > most_words {
            return Err(LocalError::File {
                file: files.tokenizer.join("tokenizer.json"),
                problem: format!("it has {} words, but the model knows {most_words}", tokenizer.size()),
                hint: "GLIP needs the tokenizer of bert-base-uncased",
            });
        }
        let weights = Weights::of_file(&files.weights, device, precision)?;
        let model = Model::load(&weights, &config)?;
        let kept = (FEATURES_BYTES / model.bytes(edges.most_pixels()).max(1)).max(1);
        Ok(Self {
            name: name.to_owned(),
            model,
            tokenizer,
            edges,
            most_tokens: MOST_TOKENS.min(config.text.longest_text()),
            device: device.clone(),
            seen: Recent::one_at_a_time(kept),
        })
    }

    /// The head's outputs for a picture and one prompt of phrases: for each position of all levels, the logits of the
    /// tokens, and five numbers of its box. For comparisons with other implementations.
    ///
    /// # Errors
    /// When the phrases are too many for one prompt, or the computation fails.
    pub fn raw(&self, image: &Image, phrases: &[&str]) -> Result<(Vec<f32>, Vec<f32>), LocalError> {
        let prompts = prompts(&self.tokenizer, phrases, self.most_tokens)?;
        let [prompt] = &prompts[..] else { return Err(self.wrong("these phrases are not one prompt")) };
        let seen = self.seen(image)?;
        let said = self.said(&seen, prompt)?;
        let logits = said.iter().flat_map(|said| said.logits.iter().copied()).collect();
        Ok((logits, said.iter().flat_map(|said| said.boxes.iter().copied()).collect()))
    }

    /// Finds phrases in a picture: for each phrase its boxes, the best first.
    ///
    /// # Errors
    /// When a phrase is too long, the picture has no pixels, or the computation fails.
    pub fn find(&self, image: &Image, phrases: &[&str]) -> Result<Vec<Vec<Found>>, LocalError> {
        let prompts = prompts(&self.tokenizer, phrases, self.most_tokens)?;
        let texts = self.texts(&prompts)?;
        self.find_all(image, phrases.len(), &prompts, &texts)
    }

    fn find_all(
        &self,
        image: &Image,
        phrases: usize,
        prompts: &[Prompt],
        texts: &[Tensor],
    ) -> Result<Vec<Vec<Found>>, LocalError> {
        let mut found = vec![Vec::new(); phrases];
        if prompts.is_empty() {
            return Ok(found);
        }
        let seen = self.seen(image)?;
        let sizes = Sizes { shown: seen.size, picture: (image.width_px() as usize, image.height_px() as usize) };
        for (prompt, text) in prompts.iter().zip(texts) {
            let said = self.model.said(&seen.levels, text).map_err(|error| self.failed(&error))?;
            for ((number, _), of_phrase) in prompt.phrases.iter().zip(boxes(&said, prompt, sizes)) {
                found[*number] = of_phrase;
            }
        }
        Ok(found)
    }

    fn said(&self, seen: &Seen, prompt: &Prompt) -> Result<Vec<Said>, LocalError> {
        let texts = self.texts(std::slice::from_ref(prompt))?;
        let text = texts.first().ok_or_else(|| self.wrong("there is no prompt"))?;
        self.model.said(&seen.levels, text).map_err(|error| self.failed(&error))
    }

    /// The states of the tokens of prompts.
    fn texts(&self, prompts: &[Prompt]) -> Result<Vec<Tensor>, LocalError> {
        let states = prompts.iter().map(|prompt| self.model.states(&prompt.ids, &self.device.0));
        states.collect::<Computed<_>>().map_err(|error| self.failed(&error))
    }

    /// The features of a picture: kept ones, or else new ones, which are then kept.
    fn seen(&self, image: &Image) -> Result<std::sync::Arc<Seen>, LocalError> {
        self.seen.get_or_make(digest(image), || {
            let (pixels, size) = self.edges.tensor(image, &self.device)?;
            let levels = self.model.levels(&pixels).map_err(|error| self.failed(&error))?;
            Ok(Seen { levels, size })
        })
    }

    fn failed(&self, error: &candle_core::Error) -> LocalError {
        LocalError::compute(&self.name, error)
    }

    fn wrong(&self, problem: &str) -> LocalError {
        LocalError::Compute { model: self.name.clone(), problem: problem.to_owned() }
    }
}

impl Detector for Glip {
    fn name(&self) -> &str {
        &self.name
    }

    fn scoring(&self) -> Scoring {
        Scoring {
            means: "GLIP's: root of (mean probability of the phrase's tokens times centreness), phrases joined by \". \" into one prompt",
            found_from: 0.5,
            phrases_meet: true,
        }
    }

    fn detect(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<Found>>, ModelError>> {
        let failed = |error: LocalError| ModelError::Failed { model: self.name.clone(), reason: error.to_string() };
        let read = || {
            let prompts = prompts(&self.tokenizer, phrases, self.most_tokens)?;
            let texts = self.texts(&prompts)?;
            Ok((prompts, texts))
        };
        let read = read().map_err(failed);
        let one = |view: &&View| {
            let image = of_view(view, &self.name)?;
            let (prompts, texts) = read.as_ref().map_err(Clone::clone)?;
            self.find_all(image, phrases.len(), prompts, texts).map_err(failed)
        };
        views.iter().map(one).collect()
    }
}
