//! A build that reaches no models.

use super::{Price, Spent};
use crate::{
    error::Error,
    settings::{Providers, Service, Settings},
};
use std::sync::Arc;
use wayword_core::LanguageModel;

/// No build without the feature `remote` holds one.
pub enum Calls {}

/// Nobody's price is known.
///
/// # Errors
/// None.
pub fn price_of(_: &Service, _: &str) -> Result<Option<Price>, Error> {
    Ok(None)
}

impl Calls {
    /// Refuses every model.
    ///
    /// # Errors
    /// Where the settings name one.
    pub fn rehearse(settings: &Settings, service: &Service, providers: &Providers) -> Result<(), Error> {
        Self::open(settings, service, providers, "").map(drop)
    }

    /// `None` where the settings name no model.
    ///
    /// # Errors
    /// Where they name one.
    pub fn open(settings: &Settings, _: &Service, _: &Providers, _: &str) -> Result<Option<Self>, Error> {
        match settings.roles.models().first() {
            None => Ok(None),
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
    ///
    /// # Errors
    /// None.
    pub fn record(&self) -> Result<(), Error> {
        match *self {}
    }
}
