//! Replaces `local.rs` in a build that runs no models in process.

use crate::{error::Error, output::Output, settings::Job};
use std::sync::Arc;
use wayword_core::{Detector, LanguageModel};
use wayword_ledger::Run;
use wayword_remote::Finding;
use wayword_synthesis::prompts::Manner;

/// Has no values: a build without the feature `local` has no models in process.
pub(super) enum Local {}

impl Local {
    pub(super) fn rehearse(_: &Job, name: &str) -> Result<(), Error> {
        Err(refused(name))
    }

    pub(super) fn open(_: &Job, _: Run, _: &Output) -> Result<Self, Error> {
        Err(refused("a model in process"))
    }

    pub(super) fn ready(&self, _: &str) -> Result<(), Error> {
        match *self {}
    }

    pub(super) fn model(&self, _: &str) -> Result<Arc<dyn LanguageModel>, Error> {
        match *self {}
    }

    pub(super) fn rehearse_detector(_: &Job, name: &str) -> Result<(), Error> {
        Err(refused(name))
    }

    pub(super) fn detector_ready(&self, _: &str) -> Result<(), Error> {
        match *self {}
    }

    pub(super) fn detector(&self, _: &str) -> Result<Arc<dyn Detector>, Error> {
        match *self {}
    }

    pub(super) fn manner(&self, _: &str) -> Result<Manner, Error> {
        match *self {}
    }

    pub(super) fn check(&self, _: &str, _: bool) -> Vec<Finding> {
        match *self {}
    }
}

fn refused(name: &str) -> Error {
    Error::not_built(format!("{name} cannot be asked: this build runs no models in process"))
}
