//! Models that run in process, opened by name with the settings of a command.

use crate::{
    download_bar::DownloadBar,
    error::Error,
    output::Output,
    settings::{self, Job},
};
use std::sync::Arc;
use wayword_core::{Detector, LanguageModel};
use wayword_ledger::Run;
use wayword_local::{Device, EyeKind, Hub, HubConfig, Loading, Models, Precision};
use wayword_remote::Finding;
use wayword_synthesis::prompts::Manner;

/// The models in process of one command.
pub(super) struct Local {
    models: Models,
}

impl Local {
    /// Refuses a name that no model in process can have, and unusable settings of device or memory.
    pub(super) fn rehearse(job: &Job, name: &str) -> Result<(), Error> {
        loading(job)?;
        Ok(Models::check_name(name)?)
    }

    /// Opens the hub's cache and the device that environment and settings name.
    pub(super) fn open(job: &Job, run: Run, output: &Output) -> Result<Self, Error> {
        let mut config = HubConfig::from_env()?;
        config.trust.clone_from(&job.service.trust);
        let hub = Hub::new(config)?;
        Ok(Self { models: Models::new(hub, loading(job)?, Box::new(DownloadBar::new(output)), run) })
    }

    /// Makes sure that a model's files are on this machine.
    pub(super) fn ready(&self, name: &str) -> Result<(), Error> {
        Ok(self.models.at_hand(name)?)
    }

    /// Loads a model, once.
    pub(super) fn model(&self, name: &str) -> Result<Arc<dyn LanguageModel>, Error> {
        Ok(self.models.model(name)?)
    }

    /// Refuses a name that no detector in process can have, and unusable settings of device or memory.
    pub(super) fn rehearse_detector(job: &Job, name: &str) -> Result<(), Error> {
        loading(job)?;
        Ok(Models::check_detector_name(name)?)
    }

    /// Makes sure that a detector's files are on this machine.
    pub(super) fn detector_ready(&self, name: &str) -> Result<(), Error> {
        Ok(self.models.detector_at_hand(name)?)
    }

    /// Loads a detector, once.
    pub(super) fn detector(&self, name: &str) -> Result<Arc<dyn Detector>, Error> {
        Ok(self.models.detector(name)?)
    }

    /// The manner in which a model is asked.
    pub(super) fn manner(&self, name: &str) -> Result<Manner, Error> {
        Ok(match self.models.model(name)?.kind() {
            EyeKind::Questions => Manner::Question,
            EyeKind::Texts => Manner::Completion,
        })
    }

    /// Loads a model and tries it out.
    pub(super) fn check(&self, name: &str, is_to_see: bool) -> Vec<Finding> {
        let model = match self.models.model(name) {
            Ok(model) => model,
            Err(error) => return vec![Finding::error(&error.to_string())],
        };
        let mut findings = vec![Finding::ok(format!("{name} is loaded, {}", model.origin()))];
        if !is_to_see {
            findings.push(Finding::error(&format!(
                "{name} answers about pictures and writes no texts\nhint: use it with --see"
            )));
        }
        findings.extend(Finding::of_seeing(model.as_ref()));
        findings
    }
}

fn loading(Job { settings, service, .. }: &Job) -> Result<Loading, Error> {
    let precision = settings.roles.precision.map(|precision| match precision {
        settings::Precision::F32 => Precision::F32,
        settings::Precision::Bf16 => Precision::Bf16,
        settings::Precision::F16 => Precision::F16,
    });
    let device = Device::named(service.device.as_deref().unwrap_or("cpu"))?;
    let memory_bytes = service.memory_gib.map(|gib| (gib * f64::from(1 << 30)) as u64);
    Ok(Loading { device, precision, memory_bytes })
}
