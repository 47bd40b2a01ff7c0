//! A build that reaches no models.

use super::{Price, Spent};
use crate::{
    error::Error,
    output::Output,
    settings::{Providers, Service, Settings},
};
use std::{collections::BTreeMap, sync::Arc};
use wayword_core::{LanguageModel, ModelError};
use wayword_synthesis::prompts::Manner;

/// No build without the feature `remote` holds one.
pub enum Calls {}

impl Calls {
    /// Refuses every model.
    ///
    /// # Errors
    /// Where the settings name one.
    pub fn rehearse(settings: &Settings, _: &Service, _: &Providers) -> Result<BTreeMap<String, Option<Price>>, Error> {
        Self::refuse(settings).map(|()| BTreeMap::new())
    }

    /// `None` where the settings name no model.
    ///
    /// # Errors
    /// Where they name one.
    pub fn open(settings: &Settings, _: &Service, _: &Providers, _: &str, _: &Output) -> Result<Option<Self>, Error> {
        Self::refuse(settings).map(|()| None)
    }

    fn refuse(settings: &Settings) -> Result<(), Error> {
        match settings.roles.models().first() {
            None => Ok(()),
            Some(model) => Err(Error::usage(
                format!("{model} cannot be asked: this build reaches no models"),
                "build it with `cargo build --release --features full`",
            )),
        }
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn model(&self, _: &str) -> Result<Arc<dyn LanguageModel>, Error> {
        match *self {}
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn manner(&self, _: &str) -> Result<Manner, Error> {
        match *self {}
    }

    /// Never called.
    #[must_use]
    pub fn spent(&self) -> Spent {
        match *self {}
    }

    /// Never called.
    #[must_use]
    pub fn workers(&self) -> usize {
        match *self {}
    }

    /// Never called.
    pub fn stop_on_interrupt(&self, _: impl Fn() + Send + 'static) {
        match *self {}
    }

    /// Never called.
    #[must_use]
    pub fn interrupted(&self) -> Option<ModelError> {
        match *self {}
    }

    /// Never called.
    ///
    /// # Errors
    /// None.
    pub fn record(&self) -> Result<(), Error> {
        match *self {}
    }
}
