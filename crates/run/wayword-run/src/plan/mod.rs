//! A run before it begins: its platform, paths, styles and models, resolved from the settings. No model has been called and no
//! file written yet.

mod bill;
mod estimate;
mod inputs;
mod views;

use crate::{
    calls::ModelCalls,
    error::CommandError,
    item::{RunItem, check_names, run_items},
    lookout::{self, DetectorLookout},
    output::CommandOutput,
    settings::{RunJob, RunSettings},
    styles::{self, MeasuredStyle},
};
use std::collections::BTreeMap;
use wayword_core::Platform;
use wayword_remote::ModelPrice;

pub use bill::{CallLoad, ModelBill, picture_tokens};
pub use estimate::RunEstimate;
pub use estimate::seeing_load;

/// Number of items from which the calls of all items are extrapolated, because an estimate of each would take too long.
const SAMPLED_ITEMS: usize = 8;

/// The items, styles and models of a run.
pub struct RunPlan<'a> {
    /// The settings, and how models are reached.
    pub job: &'a RunJob,
    /// The platform.
    pub platform: &'a dyn Platform,
    /// The paths, in their order.
    pub items: Vec<RunItem>,
    /// The styles to write in; empty for a run that only looks.
    pub styles: Vec<MeasuredStyle>,
    /// The models, over a network or in process.
    pub models: JobModels<'a>,
}

impl<'a> RunPlan<'a> {
    /// A run that only looks along its paths, without writing texts.
    ///
    /// # Errors
    /// When the platform has no paths of this kind, or a model is not known.
    pub fn for_looking(job: &'a RunJob, platform: &'a dyn Platform) -> Result<Self, CommandError> {
        let items = run_items(&job.settings, platform)?;
        Ok(Self { job, platform, items, styles: Vec::new(), models: JobModels::for_job(job)? })
    }

    /// A run that writes instructions for paths.
    ///
    /// # Errors
    /// When a style or a detector's file cannot be read, the platform has no paths of this kind, two items share a name, or a
    /// model is not known.
    pub fn for_writing(job: &'a RunJob, platform: &'a dyn Platform) -> Result<Self, CommandError> {
        let styles = styles::find_run_styles(&job.settings)?;
        if job.settings.roles.write.model_name().is_none() {
            styles::refuse_foreign_styles(&job.settings.style, &styles)?;
        }
        lookout::check_detector_files(&job.settings, &styles)?;
        let items = run_items(&job.settings, platform)?;
        check_names(&items)?;
        Ok(Self { job, platform, items, styles, models: JobModels::for_job(job)? })
    }

    /// The settings as a run folder keeps them: with hashes of the files and tables that they only name.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn settings_with_hashes(&self) -> Result<RunSettings, CommandError> {
        Ok(RunSettings { inputs: inputs::hash_inputs(self.job, &self.styles)?, ..self.job.settings.clone() })
    }

    /// The expected number of calls per item: the mean of the first few of these items, without repeated calls. A lookout adds
    /// the calls of its detector for each view.
    ///
    /// # Errors
    /// When a prompt cannot be used.
    pub fn calls_per_item(&self, items: &[&RunItem], lookout: Option<&DetectorLookout>) -> Result<f64, CommandError> {
        let sampled = &items[..items.len().min(SAMPLED_ITEMS)];
        let calls = RunEstimate::for_items(self, sampled.iter().copied(), None)?
            .call_count(lookout.map_or(0, DetectorLookout::calls_per_view));
        Ok(calls as f64 / sampled.len().max(1) as f64)
    }

    /// Estimates the calls and the cost of the run. With `chunk`, the number of items in a chunk, also the surplus of shards
    /// over a queue.
    ///
    /// # Errors
    /// When a prompt cannot be used.
    pub fn estimate_calls(&self, chunk: Option<usize>) -> Result<RunEstimate, CommandError> {
        RunEstimate::for_plan(self, chunk)
    }
}

/// The models that a job names: known, priced, and not asked yet.
pub struct JobModels<'a> {
    job: &'a RunJob,
    /// By model; `None` if the price is not known.
    prices: BTreeMap<String, Option<ModelPrice>>,
}

impl<'a> JobModels<'a> {
    /// The models of a job.
    ///
    /// # Errors
    /// When one is not known, has no price and needs one, or a file for the calls is not there.
    pub fn for_job(job: &'a RunJob) -> Result<Self, CommandError> {
        Ok(Self { job, prices: ModelCalls::rehearse_job(job)? })
    }

    /// Opens ledger and services for the models; `None` if there are none. The calls are booked under the name `run`.
    ///
    /// # Errors
    /// When the ledger cannot be opened.
    pub fn open_calls(&self, run: &str, output: &CommandOutput) -> Result<Option<ModelCalls>, CommandError> {
        if self.is_empty() { Ok(None) } else { ModelCalls::open(self.job, run, output) }
    }

    /// Whether no model takes part.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.prices.is_empty()
    }

    /// The price of a model, if it is known.
    #[must_use]
    pub fn model_price(&self, model: &str) -> Option<&ModelPrice> {
        self.prices.get(model)?.as_ref()
    }
}
