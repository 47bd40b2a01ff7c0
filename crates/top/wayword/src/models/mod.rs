//! `wayword models`: lists, fetches and locates the files of models that run in process.

use crate::models_args::{ModelsArgs, ModelsCommand};
use indicatif::HumanBytes;
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_local::{CachedModel, HubConfig, ModelFolder, ModelHub, ModelName, NeededFiles};
use wayword_run::{
    count::count_phrase,
    download_bar::DownloadBar,
    error::{CommandError, Exit},
    output::CommandOutput,
};

/// Digits of a commit's hash that are shown.
const SHOWN_DIGITS: usize = 12;

pub(crate) fn run_models(args: &ModelsArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let mut config = HubConfig::from_env()?;
    match &args.command {
        ModelsCommand::List => {
            let hub = ModelHub::new(config)?;
            let listed = ModelListing { models: hub.list_models()?, cache: hub.cache_folder().to_owned() };
            output.print_result(&listed, &listed);
        }
        ModelsCommand::Fetch { name, tokenizer } => {
            let name = ModelName::parse(name)?;
            let folder = ModelHub::new(config)?.fetch_model(
                &name,
                &model_needs(&name, *tokenizer),
                &DownloadBar::new(output),
            )?;
            print_fetched(&name, folder, output);
        }
        ModelsCommand::Path { name, tokenizer } => {
            let name = ModelName::parse(name)?;
            config.offline = true;
            print_fetched(
                &name,
                ModelHub::new(config)?.model_folder(&name, &model_needs(&name, *tokenizer), &())?,
                output,
            );
        }
    }
    Ok(Exit::Done)
}

/// The files to fetch or to look for.
fn model_needs(name: &ModelName, tokenizer: bool) -> NeededFiles {
    if tokenizer { NeededFiles::for_tokenizer() } else { NeededFiles::for_any_architecture(name) }
}

/// The place of a model's files.
#[derive(Serialize)]
struct FetchedModel {
    name: String,
    path: PathBuf,
    /// The one file that was named, for GGUF.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    identity: String,
}

fn print_fetched(name: &ModelName, folder: ModelFolder, output: &CommandOutput) {
    let ModelFolder { path, file, identity } = folder;
    let found = FetchedModel { name: name.to_string(), path, file, identity };
    output.print_result(&found, found.file.as_ref().unwrap_or(&found.path).display());
}

/// The models on this machine.
#[derive(Serialize)]
struct ModelListing {
    models: Vec<CachedModel>,
    cache: PathBuf,
}

impl fmt::Display for ModelListing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for model in &self.models {
            let commit = model.commit.get(..SHOWN_DIGITS).unwrap_or(&model.commit);
            let bytes = HumanBytes(model.bytes).to_string();
            let revisions = model.revisions.join(", ");
            let files = count_phrase(model.files, "file");
            writeln!(f, "{:<48} {commit:<12} {bytes:>12} in {files:>8}  {revisions}", model.name)?;
        }
        write!(f, "{} in {}", count_phrase(self.models.len(), "model"), self.cache.display())
    }
}
