//! Uses the models of the Grounding DINO family as an [`ObjectDetector`]: turns the scores and boxes of queries into
//! finds for each phrase.

use super::{
    config::DinoFamily, decoder::DinoPredictions, model::GroundingDino, prompt::DinoPrompt, queries::sigmoid,
    text::PromptStates,
};
use crate::{LocalError, picture::picture_of_view};
use candle_core::DType;
use wayword_core::{DetectedBox, DetectorScoring, Image, MAX_BOXES_PER_PHRASE, ModelError, ObjectDetector, View};

/// The score from which the processors of these models take a box for a find.
const MIN_FIND_SCORE: f32 = 0.25;

impl GroundingDino {
    fn to_model_error(&self, error: &LocalError) -> ModelError {
        ModelError::Failed { model: self.name.clone(), reason: error.to_string() }
    }

    /// Finds phrases in a picture: for each phrase its boxes, the best first.
    ///
    /// # Errors
    /// When a phrase is too long, the picture has no pixels, or the computation fails.
    pub fn find_phrases(&self, image: &Image, phrases: &[&str]) -> Result<Vec<Vec<DetectedBox>>, LocalError> {
        self.find_in_prompts(image, &self.encode_prompts(phrases)?, phrases.len())
    }

    fn find_in_prompts(
        &self,
        image: &Image,
        prompts: &[(DinoPrompt, PromptStates)],
        phrases: usize,
    ) -> Result<Vec<Vec<DetectedBox>>, LocalError> {
        let mut found = vec![Vec::new(); phrases];
        let features = self.picture_features(image)?;
        for (prompt, text) in prompts {
            let predictions = self.predict_boxes(&features, text)?;
            let prompt_boxes = phrase_boxes(&predictions, prompt, image)
                .map_err(|error| LocalError::compute_failed(&self.name, &error))?;
            for ((at, _), boxes) in prompt.phrases.iter().zip(prompt_boxes) {
                found[*at] = boxes;
            }
        }
        Ok(found)
    }
}

/// The best boxes for each phrase of a prompt. The score of a box for a phrase is that of the phrase's best token.
fn phrase_boxes(
    predictions: &DinoPredictions,
    prompt: &DinoPrompt,
    image: &Image,
) -> candle_core::Result<Vec<Vec<DetectedBox>>> {
    let logits: Vec<Vec<f32>> = predictions.logits.to_dtype(DType::F32)?.to_vec2()?;
    let (width, height) = (image.width_px() as f32, image.height_px() as f32);
    let edges = |&[x, y, across, down]: &[f32; 4]| {
        let edge = |middle: f32, part: f32, length: f32| (middle + part).clamp(0.0, 1.0) * length;
        [
            edge(x, -across / 2.0, width),
            edge(y, -down / 2.0, height),
            edge(x, across / 2.0, width),
            edge(y, down / 2.0, height),
        ]
    };
    let edges: Vec<[f32; 4]> = predictions.boxes.iter().map(edges).collect();
    let best_boxes = |(_, tokens): &(usize, std::ops::Range<usize>)| {
        let best = |logits: &Vec<f32>| logits[tokens.clone()].iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let scores = logits.iter().map(|logits| sigmoid(best(logits)));
        let mut found: Vec<DetectedBox> = scores
            .zip(&edges)
            .map(|(score, &box_px)| DetectedBox { box_px, score })
            .filter(|found| is_finite_box(*found))
            .collect();
        found.sort_by(|a, b| b.score.total_cmp(&a.score));
        found.truncate(MAX_BOXES_PER_PHRASE);
        found
    };
    Ok(prompt.phrases.iter().map(best_boxes).collect())
}

/// Whether score and box are finite. A damaged checkpoint may give other numbers.
fn is_finite_box(found: DetectedBox) -> bool {
    found.score.is_finite() && found.box_px.iter().all(|edge| edge.is_finite())
}

impl ObjectDetector for GroundingDino {
    fn name(&self) -> &str {
        &self.name
    }

    /// A score is the maximum over the phrase's tokens of the sigmoid of a query's logit; all phrases of a call are in
    /// one prompt, or in several where they have more tokens than the model takes.
    fn scoring(&self) -> DetectorScoring {
        let means = match self.family {
            DinoFamily::Mm => {
                "MM Grounding DINO: a query's largest sigmoid over the tokens of the phrase, all phrases in one prompt"
            }
            DinoFamily::Plain => {
                "Grounding DINO: a query's largest sigmoid over the tokens of the phrase, all phrases in one prompt"
            }
        };
        DetectorScoring { means, find_threshold: MIN_FIND_SCORE, phrases_interact: true }
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        let prompts = self.encode_prompts(phrases).map_err(|error| self.to_model_error(&error));
        let detect_one = |view: &&View| {
            let image = picture_of_view(view, &self.name)?;
            let prompts = prompts.as_ref().map_err(Clone::clone)?;
            self.find_in_prompts(image, prompts, phrases.len()).map_err(|error| self.to_model_error(&error))
        };
        views.iter().map(detect_one).collect()
    }
}
