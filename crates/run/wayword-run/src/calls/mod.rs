//! The calls of a command to models: over HTTP or in process, kept in the ledger, and limited by a budget.

mod configured;
mod gguf_refusal;
#[cfg(feature = "local")]
mod local;
#[cfg(not(feature = "local"))]
#[path = "no_local.rs"]
mod local;
mod readiness;
mod spending;

use crate::{
    error::CommandError,
    in_order::core_count,
    output::CommandOutput,
    settings::{RunJob, is_in_process},
    written_files::find_output_place,
};
use configured::{check_call_store, open_ledger, service_concurrency, service_config};
use local::LocalCalls;
use std::{
    collections::BTreeMap,
    fs::{self, File},
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{LanguageModel, ObjectDetector};
use wayword_formats::{OutputFile, OutputPlace};
use wayword_ledger::{Ledger, LedgerRun, RunLimits};
use wayword_remote::{ModelPrice, ModelServices, ServiceFinding};
use wayword_synthesis::prompts::PromptManner;
use wayword_world::files;

pub use crate::settings::CallKeeping;
pub use configured::ledger_path;
pub use spending::CallSpending;

/// The models that one command may call.
pub struct ModelCalls {
    services: ModelServices,
    /// The models in process; `None` if the settings name none.
    local: Option<LocalCalls>,
    /// The name in the ledger that the calls are booked under, with its limits.
    run: LedgerRun,
    /// The ledger, if each chunk of the run keeps its calls in a recording of its own; else `None`.
    chunk_ledger: Option<Ledger>,
    /// The file of `--record`.
    record: Option<PathBuf>,
    /// Number of items to make at the same time.
    workers: usize,
    /// Whether calls wait for a network.
    waits_for_network: bool,
}

impl ModelCalls {
    /// Makes the checks of [`ModelCalls::open`] on names, prices, providers and files, before a file is written. Gives each model's
    /// price, if it is known.
    ///
    /// # Errors
    /// When a provider is not known, a price is needed and not known, the ledger would be on a network file system, the
    /// recording to replay is missing, or a new one has no place.
    pub fn rehearse_job(job: &RunJob) -> Result<BTreeMap<String, Option<ModelPrice>>, CommandError> {
        let RunJob { settings, service, .. } = job;
        let rehearsal = Ledger::in_memory()?.start_run("rehearsal", RunLimits::default())?;
        let services = ModelServices::new(service_config(job)?, rehearsal)?;
        let price = |name: &str| -> Result<Option<ModelPrice>, CommandError> {
            if let Some(refused) = gguf_refusal::refuse_gguf(name) {
                return Err(refused);
            }
            if settings.roles.detector.as_deref() == Some(name) {
                LocalCalls::rehearse_detector(job, name)?;
                return Ok(Some(ModelPrice::free_of_charge()));
            }
            if is_in_process(name) {
                LocalCalls::rehearse_model(job, name)?;
                return Ok(Some(ModelPrice::free_of_charge()));
            }
            Ok(services.model(name)?.price().cloned())
        };
        let with_price = |name: &str| Ok((name.to_owned(), price(name)?));
        let prices = settings.roles.model_names().into_iter().map(with_price).collect::<Result<_, CommandError>>()?;
        settings.roles.shown_pictures().into_iter().try_for_each(|name| services.takes_pictures(name))?;
        if let Some(recording) = &service.replay {
            let about = fs::metadata(recording).map_err(CommandError::io(recording, "read the recording"))?;
            if let Some(reason) = files::describe_irregular(&about) {
                let problem = format!("--replay {}: this {reason}", recording.display());
                return Err(CommandError::usage(problem, "give a file that --record wrote"));
            }
            File::open(recording).map_err(CommandError::io(recording, "read the recording"))?;
        } else if !settings.roles.model_names().is_empty() {
            check_call_store(&job.keeping, service)?;
        }
        if let Some(record) = &service.record
            && find_output_place(record)? == OutputPlace::StandardOutput
        {
            let problem = format!("--record {}: the results of the command go to standard output", record.display());
            return Err(CommandError::usage(problem, "give the name of a file"));
        }
        Ok(prices)
    }

    /// Opens ledger and services for the models that the settings name; `None` if they name none. `run` is the name under which
    /// the calls are booked: the limits apply to its spending, including earlier commands. Shows downloads on `output`.
    ///
    /// # Errors
    /// When the ledger cannot be opened, a provider is not known, or a price is needed and not known.
    pub fn open(job: &RunJob, run: &str, output: &CommandOutput) -> Result<Option<Self>, CommandError> {
        let RunJob { settings, service, .. } = job;
        if settings.roles.model_names().is_empty() {
            return Ok(None);
        }
        let ledger = match &service.replay {
            Some(recording) => Ledger::replay_recording(recording)?,
            None => open_ledger(&job.keeping, service)?,
        };
        let is_in_chunks = service.replay.is_none() && matches!(job.keeping, CallKeeping::Chunks(_));
        let in_chunks = is_in_chunks.then(|| ledger.clone());
        let run = ledger.start_run(run, RunLimits { max_usd: service.max_usd, max_calls: service.max_calls })?;
        let services = ModelServices::new(service_config(job)?, run.clone())?;
        let models = settings.roles.model_names();
        if let Some(refused) = models.iter().find_map(|name| gguf_refusal::refuse_gguf(name)) {
            return Err(refused);
        }
        let in_process = models.iter().any(|name| is_in_process(name));
        let local = if in_process { Some(LocalCalls::open(job, run.clone(), output)?) } else { None };
        // A command that does not wait for a network gains nothing from making more items at a time than there are
        // cores.
        let waits = models.iter().any(|name| !is_in_process(name));
        let workers = if waits { service_concurrency(service).thread_count() } else { core_count() };
        Ok(Some(Self {
            services,
            local,
            run,
            chunk_ledger: in_chunks,
            record: service.record.clone(),
            workers,
            waits_for_network: waits,
        }))
    }

    /// A model by its name.
    ///
    /// # Errors
    /// When its provider is not known, or it has no price and one is needed.
    pub fn open_model(&self, name: &str) -> Result<Arc<dyn LanguageModel>, CommandError> {
        match self.local.as_ref().filter(|_| is_in_process(name)) {
            Some(local) => local.open_model(name),
            None => Ok(self.services.model(name)?),
        }
    }

    /// The detector of the settings, by its name.
    ///
    /// # Errors
    /// When it cannot be loaded, or does not detect.
    pub fn open_detector(&self, name: &str) -> Result<Arc<dyn ObjectDetector>, CommandError> {
        match &self.local {
            Some(local) => local.open_detector(name),
            None => {
                Err(CommandError::not_built(format!("{name} cannot be asked: this build runs no models in process")))
            }
        }
    }

    /// The manner in which a model that sees is asked.
    ///
    /// # Errors
    /// As for [`ModelCalls::open_model`].
    pub fn prompt_manner(&self, name: &str) -> Result<PromptManner, CommandError> {
        match self.local.as_ref().filter(|_| is_in_process(name)) {
            Some(local) => local.prompt_manner(name),
            None => Ok(PromptManner::Chat),
        }
    }

    /// Tries a model out for `wayword doctor`. With `sees` it is shown a picture.
    #[must_use]
    pub fn check_model(&self, name: &str, sees: bool) -> Vec<ServiceFinding> {
        match self.local.as_ref().filter(|_| is_in_process(name)) {
            Some(local) => local.check_model(name, sees),
            None => self.services.check_model(name, sees),
        }
    }

    /// Keeps the calls from now on in a chunk's recording, if each chunk has its own. No call may be in flight.
    ///
    /// # Errors
    /// When the recording cannot be read or written.
    pub fn turn_to(&self, recording: &Path) -> Result<(), CommandError> {
        self.chunk_ledger.as_ref().map_or(Ok(()), |ledger| Ok(ledger.turn_to(recording)?))
    }

    /// The calls, tokens and money of this command so far.
    #[must_use]
    pub fn spent_so_far(&self) -> CallSpending {
        let totals = self.run.totals();
        CallSpending {
            requests: totals.calls,
            answered: totals.answered,
            from_ledger: totals.hits,
            failed: totals.failed,
            lost: totals.lost,
            tokens_in: totals.tokens_in,
            tokens_out: totals.tokens_out,
            usd: totals.usd,
            maybe_usd: totals.maybe_usd,
        }
    }

    /// How many items to make at a time.
    #[must_use]
    pub fn worker_count(&self) -> usize {
        self.workers
    }

    /// How many views of one path to describe at the same time while this many items are left. Many items keep all workers busy
    /// with one view each; the views of a last single path are spread over all workers.
    #[must_use]
    pub fn views_at_once(&self, items_left: usize) -> usize {
        if self.waits_for_network { self.workers.div_ceil(items_left.clamp(1, self.workers.max(1))) } else { 1 }
    }

    /// A function that stops the sending. Calls in flight are finished, and their answers kept.
    pub fn sending_stopper(&self) -> impl Fn() + Send + 'static {
        let run = self.run.stopper();
        move || run.stop()
    }

    /// Ends the calls of a command: says what the user should know of the services, and writes the recording, if one was asked
    /// for.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(&self, output: &CommandOutput) -> Result<(), CommandError> {
        for note in self.services.notes() {
            output.say(format_args!("warning: {note}"));
        }
        if let Some(file) = &self.record {
            let failed = || CommandError::io(file, "write");
            let mut recording = OutputFile::begin(file).map_err(failed())?;
            self.run.record_calls(file, &mut recording)?;
            recording.finish().map_err(failed())?;
        }
        Ok(())
    }
}
