//! Hashes of files and tables that the settings only name, so that a run cannot be continued after its episodes, styles, prompts
//! or endpoints have changed.

use crate::{
    error::CommandError,
    lookout::{DetectorProposals, asked_proposals},
    run_folder::{hash_of_file, short_hex},
    settings::{ProviderTables, RunJob},
    styles::MeasuredStyle,
    team::settings_prompts,
};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// The hashes of all inputs of a job, by names such as "episodes" and "style r2r".
pub(super) fn hash_inputs(job: &RunJob, styles: &[MeasuredStyle]) -> Result<BTreeMap<String, String>, CommandError> {
    let mut inputs: BTreeMap<String, String> = styles
        .iter()
        .map(|MeasuredStyle { style, hash, .. }| (format!("style {}", style.name), hash.clone()))
        .collect();
    if let Some(file) = &job.settings.episodes {
        inputs.insert("episodes".into(), hash_of_file(file)?);
    }
    if let Some(file) = &job.settings.calibration {
        inputs.insert("calibration".into(), hash_of_file(file)?);
    }
    if let Some(file) = &job.settings.detector_figures {
        inputs.insert("detector figures".into(), hash_of_file(file)?);
    }
    if let Some(DetectorProposals::File(file)) = asked_proposals(&job.settings) {
        inputs.insert("proposals".into(), hash_of_file(file)?);
    }
    let prompts = settings_prompts(&job.settings)?;
    if !job.settings.roles.model_names().is_empty() {
        inputs.insert("prompts".into(), prompts.hash().to_owned());
    }
    if !job.providers.is_empty() {
        inputs.insert("providers".into(), hash_providers(&job.providers));
    }
    Ok(inputs)
}

/// Fields of a provider that have no influence on answers, and so may change between two commands of a run.
const FIELDS_WITHOUT_EFFECT: [&str; 3] = ["requests_per_minute", "tokens_per_minute", "key_env"];

fn hash_providers(providers: &ProviderTables) -> String {
    let mut hash = Sha256::new();
    for (name, table) in providers {
        let effective = table.iter().filter(|(field, _)| !FIELDS_WITHOUT_EFFECT.contains(&field.as_str()));
        hash.update(format!("{name}: {:?}\n", effective.collect::<Vec<_>>()));
    }
    short_hex(hash)
}
