//! Replaces `local.rs` in a build that runs no models in process.

use crate::{error::CommandError, output::CommandOutput, settings::RunJob};
use std::sync::Arc;
use wayword_core::{LanguageModel, ObjectDetector};
use wayword_ledger::LedgerRun;
use wayword_remote::ServiceFinding;
use wayword_synthesis::prompts::PromptManner;

/// Has no values: a build without the feature `local` has no models in process.
pub(super) enum LocalCalls {}

impl LocalCalls {
    pub(super) fn rehearse_model(_: &RunJob, name: &str) -> Result<(), CommandError> {
        Err(not_built_error(name))
    }

    pub(super) fn open(_: &RunJob, _: LedgerRun, _: &CommandOutput) -> Result<Self, CommandError> {
        Err(not_built_error("a model in process"))
    }

    pub(super) fn model_ready(&self, _: &str) -> Result<(), CommandError> {
        match *self {}
    }

    pub(super) fn open_model(&self, _: &str) -> Result<Arc<dyn LanguageModel>, CommandError> {
        match *self {}
    }

    pub(super) fn rehearse_detector(_: &RunJob, name: &str) -> Result<(), CommandError> {
        Err(not_built_error(name))
    }

    pub(super) fn detector_ready(&self, _: &str) -> Result<(), CommandError> {
        match *self {}
    }

    pub(super) fn open_detector(&self, _: &str) -> Result<Arc<dyn ObjectDetector>, CommandError> {
        match *self {}
    }

    pub(super) fn prompt_manner(&self, _: &str) -> Result<PromptManner, CommandError> {
        match *self {}
    }

    pub(super) fn check_model(&self, _: &str, _: bool) -> Vec<ServiceFinding> {
        match *self {}
    }
}

fn not_built_error(name: &str) -> CommandError {
    CommandError::not_built(format!("{name} cannot be asked: this build runs no models in process"))
}
