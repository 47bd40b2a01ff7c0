//! Writing: what a writer gets, and the writer that works by rules.

mod dice;
mod draft;
mod landmarks;
mod naming;
mod object;
mod phrases;
mod place;
mod route;
mod rules;
mod task;
mod telling;

use crate::{style::Profile, walk::Walk};
use std::sync::Arc;
use wayword_checks::Memory;
use wayword_core::{Finding, Image, ModelError, Style, rng};

pub use rules::RulesWriter;

/// People say more of a place than labels show, such as how things look. Texts that name a place are as long as this share of
/// a style's texts, the shorter ones: longer ones would only pile up what tells a target apart.
const SHORTER: f64 = 0.55;

/// Writes instructions.
pub trait Writer: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;

    /// A text for the brief.
    ///
    /// # Errors
    /// When the walk gives nothing to write about, or a model gave nothing that can be used.
    fn write(&self, brief: &Brief<'_>) -> Result<String, WriteError>;
}

/// All that a writer gets.
#[derive(Debug, Clone, Copy)]
pub struct Brief<'a> {
    /// The path and what was seen along it; its target, where one is given.
    pub walk: &'a Walk,
    /// What stays in mind of the walk.
    pub memory: &'a Memory,
    /// The style to write in.
    pub style: &'a Style,
    /// What the style's references are like.
    pub profile: &'a Profile,
    /// The run's seed.
    pub seed: u64,
    /// Which of several texts for the walk it is, from 0: each is another draw.
    pub candidate: u32,
    /// What was wrong with earlier texts for this walk, oldest first.
    pub complaints: &'a [Complaint],
    /// Texts that this walk already has, in the same style: this one has to differ.
    pub earlier: &'a [String],
    /// Pictures of frames, for a writer that sees; in the order of the frames.
    pub pictures: &'a [FramePicture],
}

/// The picture ahead of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FramePicture {
    /// Number of the frame.
    pub frame: usize,
    /// What is seen ahead of it.
    pub image: Arc<Image>,
}

impl<'a> Brief<'a> {
    /// A first text for a walk: nothing was written yet, and no pictures are shown.
    #[must_use]
    pub fn new(walk: &'a Walk, memory: &'a Memory, style: &'a Style, profile: &'a Profile, seed: u64) -> Self {
        Self { walk, memory, style, profile, seed, candidate: 0, complaints: &[], earlier: &[], pictures: &[] }
    }

    /// How many words the text should have. All candidates for a walk share it, so that the choice among them does not
    /// change how long the style's texts are.
    fn length(&self) -> usize {
        self.length_among(&self.profile.words)
    }

    /// The same, among the shorter of its style's lengths, where the style does not say itself how long its texts are.
    fn shorter_length(&self) -> usize {
        let words = &self.profile.words;
        let shorter = (words.len() as f64 * SHORTER).ceil() as usize;
        self.length_among(if self.style.words.is_empty() { &words[..shorter.min(words.len())] } else { words })
    }

    fn length_among(&self, words: &[usize]) -> usize {
        phrases::drawn(words, &mut rng(self.seed, &["length", &self.style.name, &self.walk.path.id]))
    }
}

/// A text that failed its checks.
#[derive(Debug, Clone, PartialEq)]
pub struct Complaint {
    /// The text.
    pub text: String,
    /// What was wrong with it.
    pub findings: Vec<Finding>,
}

/// A writer gave no text that can be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum WriteError {
    /// The style ends in a task, and no object is known at the end.
    #[error(
        "this style needs an object at the end of the path, but none is known there: use a platform or data folder with objects, or another --style"
    )]
    NoObject,
    /// The text is unusable; another attempt may be better.
    #[error("the text cannot be used: {reason}")]
    Unusable {
        /// The text.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The model that writes gave nothing.
    #[error(transparent)]
    Model(#[from] ModelError),
}
