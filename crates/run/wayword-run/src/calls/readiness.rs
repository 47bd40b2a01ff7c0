//! Finds out whether a job's models can be asked, before a platform is opened or a folder made.

use super::{ModelCalls, configured::service_config, ledger_path, local::LocalCalls};
use crate::{
    error::CommandError,
    output::CommandOutput,
    settings::{RunJob, is_in_process},
    team::settings_prompts,
};
use wayword_ledger::{Ledger, RunLimits};
use wayword_remote::{ConfigError, ModelServices};

impl ModelCalls {
    /// Refuses what [`ModelCalls::rehearse_job`] refuses, templates that cannot be used, and models that cannot be asked: because the key
    /// is missing, the port is closed, files are missing and cannot be fetched, or the model is to be shown pictures and does
    /// not see. A model with answers in the ledger is not refused for a missing key or a closed port, because the run may need
    /// no new answer.
    ///
    /// # Errors
    /// With the missing thing, its place, and a hint.
    pub fn check_ready(job: &RunJob, output: &CommandOutput) -> Result<(), CommandError> {
        Self::rehearse_job(job)?;
        settings_prompts(&job.settings)?;
        let models = job.settings.roles.model_names();
        // `--ledger` is often given for all runs; no one is surprised that a run without models does not use it.
        let service = job.service.given().into_iter().filter(|flag| flag != "--ledger");
        let unused: Vec<String> = service.chain(job.settings.roles.given_for_models()).collect();
        if models.is_empty() && !unused.is_empty() {
            output.say(format_args!(
                "warning: no role has a model, so these settings have no effect: {}",
                unused.join(", ")
            ));
        }
        let rehearsal = Ledger::in_memory()?.start_run("rehearsal", RunLimits::default())?;
        let (local, remote): (Vec<&str>, Vec<&str>) = models.into_iter().partition(|name| is_in_process(name));
        if job.service.replay.is_none() && !remote.is_empty() {
            let services = ModelServices::new(service_config(job)?, rehearsal.clone())?;
            remote.iter().try_for_each(|name| {
                services.check_ready(name).or_else(|error| accept_if_answered(job, &services, name, error))
            })?;
            job.settings.roles.shown_pictures().into_iter().try_for_each(|name| services.check_sight(name))?;
        }
        if !local.is_empty() {
            let files = LocalCalls::open(job, rehearsal, output)?;
            let detector = job.settings.roles.detector.as_deref();
            let ready = |name: &&str| match detector == Some(*name) {
                true => files.detector_ready(name),
                false => files.model_ready(name),
            };
            local.iter().try_for_each(ready)?;
        }
        Ok(())
    }
}

/// Accepts a model that cannot be called now, if the ledger has answers of it.
fn accept_if_answered(
    job: &RunJob,
    services: &ModelServices,
    name: &str,
    error: ConfigError,
) -> Result<(), CommandError> {
    let path = ledger_path(&job.service)?;
    let is_kept = path.exists() && Ledger::open(&path)?.has_answers_from(name, &services.base_url(name)?)?;
    if is_kept { Ok(()) } else { Err(error.into()) }
}
