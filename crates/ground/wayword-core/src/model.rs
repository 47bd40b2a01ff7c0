//! Language models: what they are told, what they say, and how they fail.

use crate::{Failure, Image};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Who speaks a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// What the model is to be.
    System,
    /// The one who wants something.
    User,
    /// The model itself, earlier.
    Assistant,
}

/// One message of a conversation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    /// Who speaks it.
    pub role: Role,
    /// Its words.
    pub text: String,
    /// The picture that goes with it, for a model that sees.
    pub image: Option<Arc<Image>>,
}

/// How a model draws its words.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampling {
    /// 0 for the likeliest words.
    pub temperature: f64,
    /// Most tokens of the reply.
    pub max_tokens: u32,
    /// Seed, for models that take one.
    pub seed: u64,
}

/// Everything that a model is told at once.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The conversation so far; the last message is the user's.
    pub messages: Vec<Message>,
    /// How the reply is drawn.
    pub sampling: Sampling,
    /// Tells equal requests apart that are to be answered anew; 0 for the first.
    pub replicate: u32,
}

/// What a model said.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reply {
    /// Its words, without any thinking aloud that the service marks as such.
    pub text: String,
    /// Why it ended.
    pub finish: Finish,
}

/// Why a reply ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finish {
    /// The model was done.
    Stop,
    /// The limit of tokens cut it off.
    Length,
}

/// Gives words for words.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait LanguageModel: Send + Sync {
    /// `provider/model`.
    fn name(&self) -> &str;

    /// One result per request, in their order. One that fails does not fail the others.
    fn complete(&self, requests: &[Request]) -> Vec<Result<Reply, ModelError>>;
}

/// A mind could not do what it was asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The view lacks what this mind looks at.
    #[error("{mind} needs {needs}, and this view has none: {hint}")]
    NothingToSee {
        /// Which mind.
        mind: String,
        /// Labels, or an image.
        needs: &'static str,
        /// What to do.
        hint: &'static str,
    },
    /// This one request came to nothing, after every attempt that made sense. Others, and this one later, may do better.
    #[error("{model}: {reason}")]
    Failed {
        /// `provider/model`.
        model: String,
        /// What happened.
        reason: String,
    },
    /// The service that was asked did not answer, however often it was tried.
    #[error("{model}: {reason}")]
    Lost {
        /// `provider/model`.
        model: String,
        /// What happened.
        reason: String,
    },
    /// Nothing more can be asked for now: a budget is spent, a key is refused, the user has interrupted. What was answered is
    /// kept.
    #[error("{reason}\nhint: {hint}")]
    Stopped {
        /// Why.
        reason: String,
        /// How to go on.
        hint: String,
    },
}

impl Message {
    /// A user's message in words alone.
    #[must_use]
    pub fn user(text: impl Into<String>) -> Self {
        Self { role: Role::User, text: text.into(), image: None }
    }
}

impl ModelError {
    /// How it is dealt with, where it does not end the run.
    #[must_use]
    pub fn failure(&self) -> Failure {
        match self {
            Self::NothingToSee { .. } => Failure::Missing,
            Self::Failed { .. } => Failure::Broken,
            Self::Lost { .. } | Self::Stopped { .. } => Failure::Lost,
        }
    }

    /// Whether every further request would fail in the same way.
    #[must_use]
    pub fn ends_run(&self) -> bool {
        matches!(self, Self::Stopped { .. })
    }
}
