//! Loads a CLIP model in process by its name.

use crate::{download_bar::DownloadBar, error::CommandError, output::CommandOutput};
use wayword_local::{
    ClipGrounder, ClipModel, HubConfig, ModelDevice, ModelHub, ModelName, NeededFiles, WeightPrecision,
};

/// Fetches a CLIP, if it is not there, and loads it: `hf/ORG/NAME`, or `hf/` and a folder.
///
/// # Errors
/// When there is no model of that name, it cannot be fetched, or it is not a CLIP.
pub fn load_grounder(name: &str, output: &CommandOutput) -> Result<ClipGrounder, CommandError> {
    let needs = NeededFiles::default()
        .with_weights()
        .with_required(&["config.json", "tokenizer.json"])
        .with_optional(&["preprocessor_config.json", "processor_config.json"]);
    let folder = ModelHub::new(HubConfig::from_env()?)?.model_folder(
        &ModelName::parse(name)?,
        &needs,
        &DownloadBar::new(output),
    )?;
    Ok(ClipGrounder::new(ClipModel::load(name, &folder.path, &ModelDevice::cpu(), WeightPrecision::F32)?))
}
