//! Loads a CLIP model in process by its name.

use crate::{download_bar::DownloadBar, error::Error, output::Output};
use wayword_local::{Clip, ClipGrounder, Device, Hub, HubConfig, ModelName, Needs, Precision};

/// Fetches a CLIP, if it is not there, and loads it: `hf/ORG/NAME`, or `hf/` and a folder.
///
/// # Errors
/// When there is no model of that name, it cannot be fetched, or it is not a CLIP.
pub fn grounder(name: &str, output: &Output) -> Result<ClipGrounder, Error> {
    let needs = Needs::default()
        .weights()
        .required(&["config.json", "tokenizer.json"])
        .optional(&["preprocessor_config.json", "processor_config.json"]);
    let folder =
        Hub::new(HubConfig::from_env()?)?.folder(&ModelName::parse(name)?, &needs, &DownloadBar::new(output))?;
    Ok(ClipGrounder::new(Clip::load(name, &folder.path, &Device::cpu(), Precision::F32)?))
}
