//! Language models: requests, replies and failures.

use crate::{FailureKind, Image};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The speaker of a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MessageRole {
    /// The program, with instructions on how the model is to behave.
    System,
    /// The one that asks the model.
    User,
    /// The model itself, in an earlier reply.
    Assistant,
}

/// One message of a conversation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ChatMessage {
    /// The speaker.
    pub role: MessageRole,
    /// Its words.
    pub text: String,
    /// The pictures that go with it, in order, for a model that sees.
    pub images: Vec<Arc<Image>>,
}

/// How a model samples its words.
#[derive(Debug, Clone, PartialEq)]
pub struct SamplingOptions {
    /// 0 gives the likeliest words.
    pub temperature: f64,
    /// Most tokens of the reply.
    pub max_tokens: u32,
    /// Seed, for models that accept one.
    pub seed: u64,
}

/// Everything that one call sends to a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelRequest {
    /// The conversation so far; the last message is the user's.
    pub messages: Vec<ChatMessage>,
    /// How the reply is sampled.
    pub sampling: SamplingOptions,
    /// Number of this request among equal ones that each need a new answer; 0 for the first. Without it, the ledger would
    /// answer the second from the first.
    pub replicate: u32,
    /// The form of the reply, where it is to be JSON. A service that can force replies into a schema does
    /// so.
    pub schema: Option<ReplySchema>,
    /// The tools that the model may call; empty for none. The prompt has to explain in words how to call them, because
    /// not every service has tool calls.
    pub tools: &'static [ModelTool],
}

/// A tool that a model may call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModelTool {
    /// Its name: letters and underscores.
    pub name: &'static str,
    /// Its purpose, in words for the model.
    pub does: &'static str,
    /// The form of its arguments: the JSON Schema of an object, as text.
    pub arguments: &'static str,
}

/// A form of JSON, in the words of JSON Schema.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReplySchema {
    /// Its name: letters and underscores.
    pub name: &'static str,
    /// The schema as text.
    pub json: &'static str,
}

/// A model's reply.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelReply {
    /// Its words, without reasoning that the service marks. After them, each call of a tool is a line of its own, as
    /// [`tool_line`] makes it: a model behind a service without tool calls writes the same line itself.
    pub text: String,
    /// Why it ended.
    pub finish: FinishReason,
    /// Tokens, price and time; `None` where the service does not count them.
    pub usage: Option<ModelUsage>,
}

/// The usage of one call of a model.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ModelUsage {
    /// Tokens of the request.
    pub tokens_in: u64,
    /// Tokens of the reply.
    pub tokens_out: u64,
    /// US dollars; `None` where the price is not known.
    pub usd: Option<f64>,
    /// Seconds from sending the request to the last byte of the reply, when it was made.
    pub seconds: f64,
}

/// The line of a call of a tool: its name, a space, and its arguments as JSON without line breaks.
#[must_use]
pub fn tool_line(name: &str, arguments: &str) -> String {
    let one_line = |text: &str| text.split(['\n', '\r']).collect::<Vec<_>>().join(" ");
    format!("{} {}", one_line(name), one_line(arguments))
}

/// Why a reply ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FinishReason {
    /// The model was done.
    Stop,
    /// The limit of tokens cut it off.
    Length,
}

/// The roles `ask`, `summarise` and `write`: answers text with text.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait LanguageModel: Send + Sync {
    /// `provider/model`.
    fn name(&self) -> &str;

    /// One result per request, in their order. One that fails does not fail the others.
    fn complete_requests(&self, requests: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>>;

    /// The most tokens that it reads and writes at once, where a setting says so.
    fn context_tokens(&self) -> Option<u64> {
        None
    }

    /// Tells the user something about its requests, once a run.
    fn note(&self, _note: String) {}
}

/// Why a role could not do what it was asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ModelError {
    /// The view lacks labels or a picture, which this role needs.
    #[error("{name} needs {needs}, but this view has none: {hint}")]
    NothingToSee {
        /// The role: a model's name, or the flag with its value, as in `--see labels`.
        name: String,
        /// Labels, or an image.
        needs: &'static str,
        /// Advice for the user.
        hint: &'static str,
    },
    /// This request failed after every sensible attempt. Other requests may succeed, and so may this one later.
    #[error("{model}: {reason}")]
    Failed {
        /// `provider/model`.
        model: String,
        /// The reason.
        reason: String,
    },
    /// The service did not answer, although it was tried several times.
    #[error("{model}: {reason}")]
    Lost {
        /// `provider/model`.
        model: String,
        /// The reason.
        reason: String,
    },
    /// No more requests are possible for now: a budget is spent, a key is refused, or the user has interrupted. The
    /// answers so far are kept.
    #[error("{reason}\nhint: {hint}")]
    Stopped {
        /// Why.
        reason: String,
        /// How to go on.
        hint: String,
        /// Whether the reason is a disk that is full or gone, so that answers cannot be kept.
        is_lost: bool,
    },
}

impl ChatMessage {
    /// A user's message in words alone.
    #[must_use]
    pub fn from_user(text: impl Into<String>) -> Self {
        Self { role: MessageRole::User, text: text.into(), images: Vec::new() }
    }

    /// A user's message about pictures.
    #[must_use]
    pub fn about_images(text: impl Into<String>, images: Vec<Arc<Image>>) -> Self {
        Self { role: MessageRole::User, text: text.into(), images }
    }
}

impl ModelError {
    /// Its kind of failure, where it does not end the run.
    #[must_use]
    pub fn failure_kind(&self) -> FailureKind {
        match self {
            Self::NothingToSee { .. } => FailureKind::Missing,
            Self::Failed { .. } => FailureKind::Broken,
            Self::Lost { .. } | Self::Stopped { .. } => FailureKind::Lost,
        }
    }

    /// Whether every further request would fail in the same way.
    #[must_use]
    pub fn ends_run(&self) -> bool {
        matches!(self, Self::Stopped { .. })
    }
}
