//! Models that run in process, opened by name with the settings of a command.

use crate::{
    download_bar::DownloadBar,
    error::CommandError,
    output::CommandOutput,
    settings::{self, RunJob},
};
use std::sync::Arc;
use wayword_core::{LanguageModel, ObjectDetector};
use wayword_ledger::LedgerRun;
use wayword_local::{EyeKind, HubConfig, LoadingOptions, LocalModels, ModelDevice, ModelHub, WeightPrecision};
use wayword_remote::ServiceFinding;
use wayword_synthesis::prompts::PromptManner;

/// The models in process of one command.
pub(super) struct LocalCalls {
    models: LocalModels,
}

impl LocalCalls {
    /// Refuses a name that no model in process can have, and unusable settings of device or memory.
    pub(super) fn rehearse_model(job: &RunJob, name: &str) -> Result<(), CommandError> {
        loading_options(job)?;
        Ok(LocalModels::check_name(name)?)
    }

    /// Opens the hub's cache and the device that environment and settings name.
    pub(super) fn open(job: &RunJob, run: LedgerRun, output: &CommandOutput) -> Result<Self, CommandError> {
        let mut config = HubConfig::from_env()?;
        config.trust.clone_from(&job.service.trust);
        let hub = ModelHub::new(config)?;
        Ok(Self { models: LocalModels::new(hub, loading_options(job)?, Box::new(DownloadBar::new(output)), run) })
    }

    /// Makes sure that a model's files are on this machine.
    pub(super) fn model_ready(&self, name: &str) -> Result<(), CommandError> {
        Ok(self.models.ensure_model_files(name)?)
    }

    /// Loads a model, once.
    pub(super) fn open_model(&self, name: &str) -> Result<Arc<dyn LanguageModel>, CommandError> {
        Ok(self.models.get_model(name)?)
    }

    /// Refuses a name that no detector in process can have, and unusable settings of device or memory.
    pub(super) fn rehearse_detector(job: &RunJob, name: &str) -> Result<(), CommandError> {
        loading_options(job)?;
        Ok(LocalModels::check_detector_name(name)?)
    }

    /// Makes sure that a detector's files are on this machine.
    pub(super) fn detector_ready(&self, name: &str) -> Result<(), CommandError> {
        Ok(self.models.ensure_detector_files(name)?)
    }

    /// Loads a detector, once.
    pub(super) fn open_detector(&self, name: &str) -> Result<Arc<dyn ObjectDetector>, CommandError> {
        Ok(self.models.get_detector(name)?)
    }

    /// The manner in which a model is asked: with a bare question, or with a text to continue.
    pub(super) fn prompt_manner(&self, name: &str) -> Result<PromptManner, CommandError> {
        Ok(match self.models.get_model(name)?.kind() {
            EyeKind::Questions => PromptManner::Question,
            EyeKind::Texts => PromptManner::Completion,
        })
    }

    /// Loads a model and tries it out.
    pub(super) fn check_model(&self, name: &str, plays_see: bool) -> Vec<ServiceFinding> {
        let model = match self.models.get_model(name) {
            Ok(model) => model,
            Err(error) => return vec![ServiceFinding::from_error_text(&error.to_string())],
        };
        let mut findings = vec![ServiceFinding::ok(format!("{name} is loaded, {}", model.origin()))];
        if !plays_see {
            findings.push(ServiceFinding::from_error_text(&format!(
                "{name} answers about pictures and writes no texts\nhint: use it with --see"
            )));
        }
        findings.extend(ServiceFinding::check_seeing(model.as_ref()));
        findings
    }
}

/// The device, number format and memory limit for weights, from the settings.
fn loading_options(RunJob { settings, service, .. }: &RunJob) -> Result<LoadingOptions, CommandError> {
    let precision = settings.roles.precision.map(|precision| match precision {
        settings::AskedPrecision::F32 => WeightPrecision::F32,
        settings::AskedPrecision::Bf16 => WeightPrecision::Bf16,
        settings::AskedPrecision::F16 => WeightPrecision::F16,
    });
    let device = ModelDevice::from_name(service.device.as_deref().unwrap_or("cpu"))?;
    let memory_bytes = service.memory_gib.map(|gib| (gib * f64::from(1 << 30)) as u64);
    Ok(LoadingOptions { device, precision, memory_bytes })
}
