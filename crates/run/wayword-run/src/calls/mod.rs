//! The calls of a command to models: over HTTP or in process, kept in the ledger, and limited by a budget.

mod configured;
mod gguf;
mod keeping;
#[cfg(feature = "local")]
mod local;
#[cfg(not(feature = "local"))]
#[path = "no_local.rs"]
mod local;
mod ready;
mod spent;

use crate::{
    error::Error,
    in_order::cores,
    output::Output,
    settings::{Job, is_in_process},
};
use configured::{concurrency, config};
use local::Local;
use std::{
    collections::BTreeMap,
    fs::File,
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{Detector, LanguageModel};
use wayword_ledger::{Ledger, Limits, Run};
use wayword_remote::{Finding, Price, Services};
use wayword_synthesis::prompts::Manner;

pub use configured::ledger_path;
pub use keeping::Keeping;
pub use spent::Spent;

/// The models that one command may call.
pub struct Calls {
    services: Services,
    /// `Some` if a model in process is named.
    local: Option<Local>,
    run: Run,
    /// The ledger, if it keeps the calls of each chunk in a recording of its own.
    in_chunks: Option<Ledger>,
    record: Option<PathBuf>,
    workers: usize,
    /// Whether calls wait for a network.
    waits: bool,
}

impl Calls {
    /// Makes the checks of [`Calls::open`] on names, prices, providers and files, before a file is written. Gives each model's
    /// price, if it is known.
    ///
    /// # Errors
    /// When a provider is not known, a price is needed and not known, the ledger would be on a network file system, the
    /// recording to replay is missing, or the folder for a new recording is.
    pub fn rehearse(job: &Job) -> Result<BTreeMap<String, Option<Price>>, Error> {
        let Job { settings, service, .. } = job;
        let nowhere = Ledger::in_memory()?.run("rehearsal", Limits::default())?;
        let services = Services::new(config(job)?, nowhere)?;
        let price = |name: &str| -> Result<Option<Price>, Error> {
            if let Some(refused) = gguf::refused(name) {
                return Err(refused);
            }
            if settings.roles.detector.as_deref() == Some(name) {
                Local::rehearse_detector(job, name)?;
                return Ok(Some(Price::nothing()));
            }
            if is_in_process(name) {
                Local::rehearse(job, name)?;
                return Ok(Some(Price::nothing()));
            }
            Ok(services.model(name)?.price().cloned())
        };
        let priced = |name: &str| Ok((name.to_owned(), price(name)?));
        let prices = settings.roles.models().into_iter().map(priced).collect::<Result<_, Error>>()?;
        settings.roles.shown_pictures().into_iter().try_for_each(|name| services.takes_pictures(name))?;
        if let Some(recording) = &service.replay {
            File::open(recording).map_err(Error::io(recording, "read the recording"))?;
        } else if !settings.roles.models().is_empty() {
            job.keeping.check(service)?;
        }
        let folder = service.record.as_deref().and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
        if let Some(missing) = folder.filter(|folder| !folder.is_dir()) {
            return Err(Error::usage(
                format!("--record: the folder {} does not exist", missing.display()),
                "make it, or give another file",
            ));
        }
        Ok(prices)
    }

    /// Opens ledger and services for the models that the settings name; `None` if they name none. `run` is the name under which
    /// the calls are booked: the limits apply to its spending, including earlier commands. Shows downloads on `output`.
    ///
    /// # Errors
    /// When the ledger cannot be opened, a provider is not known, or a price is needed and not known.
    pub fn open(job: &Job, run: &str, output: &Output) -> Result<Option<Self>, Error> {
        let Job { settings, service, .. } = job;
        if settings.roles.models().is_empty() {
            return Ok(None);
        }
        let ledger = match &service.replay {
            Some(recording) => Ledger::replay(recording)?,
            None => job.keeping.open(service)?,
        };
        let is_in_chunks = service.replay.is_none() && matches!(job.keeping, Keeping::Chunks(_));
        let in_chunks = is_in_chunks.then(|| ledger.clone());
        let run = ledger.run(run, Limits { max_usd: service.max_usd, max_calls: service.max_calls })?;
        let services = Services::new(config(job)?, run.clone())?;
        let models = settings.roles.models();
        if let Some(refused) = models.iter().find_map(|name| gguf::refused(name)) {
            return Err(refused);
        }
        let in_process = models.iter().any(|name| is_in_process(name));
        let local = if in_process { Some(Local::open(job, run.clone(), output)?) } else { None };
        // A command that does not wait for a network has no use for more items than cores.
        let waits = models.iter().any(|name| !is_in_process(name));
        let workers = if waits { concurrency(service).threads() } else { cores() };
        Ok(Some(Self { services, local, run, in_chunks, record: service.record.clone(), workers, waits }))
    }

    /// A model by its name.
    ///
    /// # Errors
    /// When its provider is not known, or it has no price and one is needed.
    pub fn model(&self, name: &str) -> Result<Arc<dyn LanguageModel>, Error> {
        match self.local.as_ref().filter(|_| is_in_process(name)) {
            Some(local) => local.model(name),
            None => Ok(self.services.model(name)?),
        }
    }

    /// The detector of the settings, by its name.
    ///
    /// # Errors
    /// When it cannot be loaded, or does not detect.
    pub fn detector(&self, name: &str) -> Result<Arc<dyn Detector>, Error> {
        match &self.local {
            Some(local) => local.detector(name),
            None => Err(Error::not_built(format!("{name} cannot be asked: this build runs no models in process"))),
        }
    }

    /// The manner in which a model that sees is asked.
    ///
    /// # Errors
    /// As for [`Calls::model`].
    pub fn manner(&self, name: &str) -> Result<Manner, Error> {
        match self.local.as_ref().filter(|_| is_in_process(name)) {
            Some(local) => local.manner(name),
            None => Ok(Manner::Chat),
        }
    }

    /// Tries a model out for `wayword doctor`. With `sees` it is shown a picture.
    #[must_use]
    pub fn check(&self, name: &str, sees: bool) -> Vec<Finding> {
        match self.local.as_ref().filter(|_| is_in_process(name)) {
            Some(local) => local.check(name, sees),
            None => self.services.check(name, sees),
        }
    }

    /// Keeps the calls from now on in a chunk's recording, if each chunk has its own. No call may be in flight.
    ///
    /// # Errors
    /// When the recording cannot be read or written.
    pub fn turn_to(&self, recording: &Path) -> Result<(), Error> {
        self.in_chunks.as_ref().map_or(Ok(()), |ledger| Ok(ledger.turn_to(recording)?))
    }

    /// The calls, tokens and money of this command so far.
    #[must_use]
    pub fn spent(&self) -> Spent {
        let totals = self.run.totals();
        Spent {
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
    pub fn workers(&self) -> usize {
        self.workers
    }

    /// How many views of one path to describe at the same time while this many items are left. Many items keep all workers busy
    /// with one view each; the views of a last single path are spread over all workers.
    #[must_use]
    pub fn views_at_once(&self, items_left: usize) -> usize {
        if self.waits { self.workers.div_ceil(items_left.clamp(1, self.workers.max(1))) } else { 1 }
    }

    /// A function that stops the sending. Calls in flight are finished, and their answers kept.
    pub fn ending(&self) -> impl Fn() + Send + 'static {
        let run = self.run.stopper();
        move || run.stop()
    }

    /// Writes the recording, if one was asked for.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn record(&self) -> Result<(), Error> {
        if let Some(file) = &self.record {
            self.run.record(file)?;
        }
        Ok(())
    }
}
