//! Models that compare texts and views: text encoders and grounders.

use crate::{ModelError, ObjectId, View};

/// Turns texts into vectors. The dot product of two vectors is the similarity of their texts.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait TextEncoder: Send + Sync {
    /// `provider/model`.
    fn name(&self) -> &str;

    /// One vector of length 1 per text, in their order. All vectors have the same number of dimensions.
    ///
    /// # Errors
    /// When the model fails. Then no text has a vector.
    fn encode_texts(&self, texts: &[&str]) -> Result<Vec<Vec<f32>>, ModelError>;
}

/// Scores how well phrases fit what views show.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait PhraseGrounder: Send + Sync {
    /// `provider/model`, or `labels`.
    fn name(&self) -> &str;

    /// One result per view, in their order: a score for each phrase, in their order. A higher score is a better fit,
    /// and scores of the same grounder can be compared between views and phrases. A view that fails does not fail the
    /// others.
    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>>;

    /// The object in these views that a phrase fits best; `None` where no object fits, or where the grounder cannot
    /// tell objects apart.
    ///
    /// # Errors
    /// When the model fails.
    fn point_to_object(&self, _views: &[&View], _phrase: &str) -> Result<Option<ObjectId>, ModelError> {
        Ok(None)
    }
}
