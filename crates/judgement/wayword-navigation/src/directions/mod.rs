//! An instruction as an agent follows it: key phrases in their order, and what is to be done at the end.

use serde::{Deserialize, Serialize};
use wayword_core::ModelError;

/// An instruction taken apart (arXiv 2211.16649, section 3: navigation component and activity component).
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Directions {
    /// The navigation component: key phrases in the order in which they are met. Empty where the text only names a task.
    pub phrases: Vec<String>,
    /// The activity component: the task or the place of arrival ("wipe the sink", "stop at the sink"). Never empty.
    pub activity: String,
}

/// Takes instructions apart.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait Splitter: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;

    /// One result per instruction, in their order. One that fails does not fail the others.
    fn split(&self, instructions: &[&str]) -> Vec<Result<Directions, ModelError>>;
}
