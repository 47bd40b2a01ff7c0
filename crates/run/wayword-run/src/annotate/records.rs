//! The record of an annotated episode: a line of `annotations.jsonl`.

use crate::{pairs::PairPartState, pictures::WrittenPicture};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An annotated episode.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EpisodeAnnotation {
    /// Its number in the dataset.
    pub episode: i64,
    /// The task that the dataset gives it.
    pub tasks: Vec<String>,
    /// What its motion is known from: `poses`, `pictures`, or `unknown`.
    pub motion: String,
    /// Its parts in order, from the first frame on.
    pub parts: Vec<AnnotatedPart>,
    /// Texts about the whole that were kept.
    pub texts: Vec<EpisodeText>,
    /// Questions about frames.
    pub questions: Vec<AnnotatedQuestion>,
    /// What was not kept, and why.
    pub dropped: Vec<DroppedText>,
    /// The frames that were looked at.
    pub frames: Vec<AnnotatedFrame>,
}

/// A part of an episode.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AnnotatedPart {
    /// Its first frame in the episode.
    pub from: usize,
    /// Why it begins there.
    pub start: String,
    /// Its text.
    pub text: String,
    /// Who wrote it: a model, `rules`, or `motion` for words about the motion alone.
    pub by: String,
    /// Whether every claim of the text was confirmed.
    pub state: PairPartState,
}

/// A text about a whole episode.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct EpisodeText {
    /// Its words.
    pub text: String,
    /// Whether every check passed, or some could not be decided.
    pub state: PairPartState,
}

/// A question about a frame.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AnnotatedQuestion {
    /// The frame in the episode.
    pub frame: usize,
    /// The question.
    pub question: String,
    /// The answer, in one of LeRobot's forms.
    pub answer: Value,
}

/// A text that was not kept.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DroppedText {
    /// Its words; empty where none were written.
    pub text: String,
    /// Why.
    pub why: String,
}

/// A frame that was looked at.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct AnnotatedFrame {
    /// Its number in the episode.
    pub frame: usize,
    /// The file of its picture, with its width and height in pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture: Option<WrittenPicture>,
    /// The things that were seen.
    pub seen: Vec<String>,
    /// The room.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
}
