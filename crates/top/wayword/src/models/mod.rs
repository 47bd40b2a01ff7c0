//! `wayword models`: lists, fetches and locates the files of models that run in process.

use crate::models_args::{Models, ModelsCommand};
use indicatif::HumanBytes;
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_local::{CachedModel, Hub, HubConfig, ModelFolder, ModelName, Needs};
use wayword_run::{
    count::count,
    download_bar::DownloadBar,
    error::{Error, Exit},
    output::Output,
};

/// Digits of a commit that are shown.
const SHOWN_DIGITS: usize = 12;

pub fn run(args: &Models, output: &Output) -> Result<Exit, Error> {
    let mut config = HubConfig::from_env()?;
    match &args.command {
        ModelsCommand::List => {
            let hub = Hub::new(config)?;
            let listed = Listed { models: hub.list()?, cache: hub.cache().to_owned() };
            output.data(&listed, &listed);
        }
        ModelsCommand::Fetch { name, tokenizer } => {
            let name = ModelName::parse(name)?;
            let folder = Hub::new(config)?.fetch(&name, &needs(&name, *tokenizer), &DownloadBar::new(output))?;
            told(&name, folder, output);
        }
        ModelsCommand::Path { name, tokenizer } => {
            let name = ModelName::parse(name)?;
            config.offline = true;
            told(&name, Hub::new(config)?.folder(&name, &needs(&name, *tokenizer), &())?, output);
        }
    }
    Ok(Exit::Done)
}

/// The files to fetch or to look for.
fn needs(name: &ModelName, tokenizer: bool) -> Needs {
    if tokenizer { Needs::tokenizer() } else { Needs::of_any(name) }
}

/// The place of a model's files.
#[derive(Serialize)]
struct Found {
    name: String,
    path: PathBuf,
    /// The one file that was named, for GGUF.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<PathBuf>,
    identity: String,
}

fn told(name: &ModelName, folder: ModelFolder, output: &Output) {
    let ModelFolder { path, file, identity } = folder;
    let found = Found { name: name.to_string(), path, file, identity };
    output.data(&found, found.file.as_ref().unwrap_or(&found.path).display());
}

/// The models on this machine.
#[derive(Serialize)]
struct Listed {
    models: Vec<CachedModel>,
    cache: PathBuf,
}

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for model in &self.models {
            let commit = model.commit.get(..SHOWN_DIGITS).unwrap_or(&model.commit);
            let bytes = HumanBytes(model.bytes).to_string();
            let revisions = model.revisions.join(", ");
            let files = count(model.files, "file");
            writeln!(f, "{:<48} {commit:<12} {bytes:>12} in {files:>8}  {revisions}", model.name)?;
        }
        write!(f, "{} in {}", count(self.models.len(), "model"), self.cache.display())
    }
}
