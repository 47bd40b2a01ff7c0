//! The interface of writers, their input ([`WritingBrief`]), and the writer that works by rules ([`RulesWriter`]).
//!
//! The rules writer goes from a plan to words: `route` plans clauses from the turns, doors and rooms of the walk;
//! `landmarks` chooses things for the places that the plan offers; `naming` and `draft` put the clauses into the words
//! of the style. For ways and for places, a module of its own tries several versions and takes the one that fits the
//! style's length and copies no reference.

mod dice;
mod draft;
mod landmarks;
mod naming;
mod object;
mod other_language;
mod phrases;
mod place;
mod route;
mod rules;
mod shape_needs;
mod task;
mod way;

use crate::{style::StyleProfile, walk::ObservedWalk};
use std::sync::Arc;
use wayword_checks::WalkMemory;
use wayword_core::{CheckFinding, Image, InstructionStyle, ModelError, seeded_rng};

pub use other_language::RulesInLanguage;
pub use rules::RulesWriter;

/// Texts that name a place draw their length from this share of a style's lengths, the shorter ones. People mention
/// more of a place than labels show, such as its looks; with labels alone, a long text would only pile up properties of
/// the target.
const SHORTER_TEXTS_SHARE: f64 = 0.55;

/// Writes instructions.
pub trait InstructionWriter: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;

    /// A text for the brief.
    ///
    /// # Errors
    /// When the walk offers no object for a required task, or a model gave no usable text.
    fn write(&self, brief: &WritingBrief<'_>) -> Result<String, WriteError>;
}

/// The input of a writer for one text.
#[derive(Debug, Clone, Copy)]
pub struct WritingBrief<'a> {
    /// The path and what was seen along it; its target, where one is given.
    pub walk: &'a ObservedWalk,
    /// The memory of the walk, by what the writer may know of it.
    pub memory: &'a WalkMemory,
    /// The memory of the walk by all evidence, for where the target is.
    pub known: &'a WalkMemory,
    /// The style to write in.
    pub style: &'a InstructionStyle,
    /// The measured properties of the style's references.
    pub profile: &'a StyleProfile,
    /// The run's seed.
    pub seed: u64,
    /// The number of this candidate among several texts for the walk, from 0. Each draws anew.
    pub candidate: u32,
    /// Earlier failed texts for this walk with their findings, oldest first.
    pub complaints: &'a [TextComplaint],
    /// Texts that this walk already has, in the same style: this one has to differ.
    pub earlier: &'a [String],
    /// Pictures of frames, for a vision model; in the order of the frames.
    pub pictures: &'a [FramePicture],
}

/// The picture ahead of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FramePicture {
    /// Number of the frame.
    pub frame: usize,
    /// The picture in walking direction.
    pub image: Arc<Image>,
}

impl<'a> WritingBrief<'a> {
    /// The brief of a first text for a walk, without earlier texts and pictures.
    #[must_use]
    pub fn new(
        walk: &'a ObservedWalk,
        memory: &'a WalkMemory,
        style: &'a InstructionStyle,
        profile: &'a StyleProfile,
        seed: u64,
    ) -> Self {
        Self {
            walk,
            memory,
            known: memory,
            style,
            profile,
            seed,
            candidate: 0,
            complaints: &[],
            earlier: &[],
            pictures: &[],
        }
    }

    /// Number of words that the text should have. It is the same for all candidates of a walk, so that the choice among
    /// them does not change the distribution of lengths.
    fn target_words(&self) -> usize {
        self.length_among(&self.profile.words)
    }

    /// The same, drawn from the shorter lengths of the style, unless the style gives its lengths explicitly.
    fn shorter_length(&self) -> usize {
        let words = &self.profile.words;
        let shorter = (words.len() as f64 * SHORTER_TEXTS_SHARE).ceil() as usize;
        self.length_among(if self.style.words.is_empty() { &words[..shorter.min(words.len())] } else { words })
    }

    fn length_among(&self, words: &[usize]) -> usize {
        phrases::draw_measure(
            words,
            &mut seeded_rng(self.seed, &["length", self.style.draw_name(), &self.walk.path.id]),
        )
    }
}

/// A text that failed its checks.
#[derive(Debug, Clone, PartialEq)]
pub struct TextComplaint {
    /// The text.
    pub text: String,
    /// What the checks found.
    pub findings: Vec<CheckFinding>,
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
        /// The fault.
        reason: String,
    },
    /// The writing model failed.
    #[error(transparent)]
    Model(#[from] ModelError),
}
