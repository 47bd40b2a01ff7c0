//! A run before it begins: its platform, paths, styles and models, resolved from the settings. No model has been called and no
//! file written yet.

mod bill;
mod estimate;
mod inputs;
mod views;

use crate::{
    calls::Calls,
    error::Error,
    item::{Item, check_names, items},
    looking_for::{self, Lookout},
    output::Output,
    settings::{Job, Settings},
    styles::{self, Measured},
};
use std::collections::BTreeMap;
use wayword_core::Platform;
use wayword_remote::Price;

pub use bill::{Bill, Load, picture_tokens};
pub use estimate::Estimate;
pub use estimate::seeing;

/// Number of items from which the calls of the other items are extrapolated.
const FEW: usize = 8;

/// The items, styles and models of a run.
pub struct Plan<'a> {
    /// The settings, and how models are reached.
    pub job: &'a Job,
    /// The platform.
    pub platform: &'a dyn Platform,
    /// The paths, in their order.
    pub items: Vec<Item>,
    /// The styles to write in; empty for a run that only looks.
    pub styles: Vec<Measured>,
    /// The models, over a network or in process.
    pub models: Models<'a>,
}

impl<'a> Plan<'a> {
    /// A run that only looks along its paths, without writing texts.
    ///
    /// # Errors
    /// When the platform has no paths of this kind, or a model is not known.
    pub fn looking(job: &'a Job, platform: &'a dyn Platform) -> Result<Self, Error> {
        let items = items(&job.settings, platform)?;
        Ok(Self { job, platform, items, styles: Vec::new(), models: Models::of(job)? })
    }

    /// A run that writes instructions for paths.
    ///
    /// # Errors
    /// When a style or a detector's file cannot be read, the platform has no paths of this kind, two items share a name, or a
    /// model is not known.
    pub fn writing(job: &'a Job, platform: &'a dyn Platform) -> Result<Self, Error> {
        let styles = styles::find(&job.settings.style)?;
        looking_for::check(&job.settings, &styles)?;
        let items = items(&job.settings, platform)?;
        check_names(&items)?;
        Ok(Self { job, platform, items, styles, models: Models::of(job)? })
    }

    /// The settings as a run folder keeps them: with hashes of the files and tables that they only name.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn settings(&self) -> Result<Settings, Error> {
        Ok(Settings { inputs: inputs::inputs(self.job, &self.styles)?, ..self.job.settings.clone() })
    }

    /// The expected number of calls per item: the mean of the first few of these items, without repeated calls. A lookout adds
    /// the calls of its detector for each view.
    ///
    /// # Errors
    /// When a prompt cannot be used.
    pub fn calls_per_item(&self, items: &[&Item], lookout: Option<&Lookout>) -> Result<f64, Error> {
        let few = &items[..items.len().min(FEW)];
        let calls =
            Estimate::of_items(self, few.iter().copied(), None)?.calls(lookout.map_or(0, Lookout::calls_per_view));
        Ok(calls as f64 / few.len().max(1) as f64)
    }

    /// Estimates the calls and the cost of the run. With `chunk`, the number of items in a chunk, also the surplus of shards
    /// over a queue.
    ///
    /// # Errors
    /// When a prompt cannot be used.
    pub fn estimate(&self, chunk: Option<usize>) -> Result<Estimate, Error> {
        Estimate::of(self, chunk)
    }
}

/// The models that a job names: known, priced, and not asked yet.
pub struct Models<'a> {
    job: &'a Job,
    /// By model; `None` if the price is not known.
    prices: BTreeMap<String, Option<Price>>,
}

impl<'a> Models<'a> {
    /// The models of a job.
    ///
    /// # Errors
    /// When one is not known, has no price and needs one, or a file for the calls is not there.
    pub fn of(job: &'a Job) -> Result<Self, Error> {
        Ok(Self { job, prices: Calls::rehearse(job)? })
    }

    /// Opens ledger and services for the models; `None` if there are none. The calls are booked under the name `run`.
    ///
    /// # Errors
    /// When the ledger cannot be opened.
    pub fn open(&self, run: &str, output: &Output) -> Result<Option<Calls>, Error> {
        if self.is_empty() { Ok(None) } else { Calls::open(self.job, run, output) }
    }

    /// Whether no model takes part.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.prices.is_empty()
    }

    /// The price of a model, if it is known.
    #[must_use]
    pub fn price(&self, model: &str) -> Option<&Price> {
        self.prices.get(model)?.as_ref()
    }
}
