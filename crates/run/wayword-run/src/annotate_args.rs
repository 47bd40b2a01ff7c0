//! The flags of `wayword annotate`.

use crate::settings::{AskedRoles, AskedSettings, Draw, Service, Writing};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `wayword annotate`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword annotate DATASET --see openai/gpt-4.1-mini --llm openai/gpt-4.1-mini --max-usd 5 --out DATASET-language
  wayword annotate DATASET --see ollama/llava --camera observation.images.front --out DATASET-language
      The rules write, and a model sees.
  wayword annotate DATASET --out DATASET-language
      Without a model: turns, stairs and stops alone, by the poses of the dataset or by its pictures.

The dataset is a folder of LeRobot v3.0. The copy has its videos and columns unchanged, and two columns of language: what is done now
(subtask), what is left to do (plan), other words for the whole (task_aug), and questions about single frames with their answers (vqa).")]
pub struct AnnotateArgs {
    /// Folder of a LeRobot v3.0 dataset.
    pub dataset: PathBuf,
    /// Folder for the copy with language. Give the same command again to continue it.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The style of the texts about a whole episode. [default: r2r]
    #[arg(long, value_name = "STYLE")]
    pub style: Option<String>,
    /// So many texts about each whole episode. [default: 2]
    #[arg(long, value_name = "N")]
    pub per_path: Option<usize>,
    /// The camera that is looked through. [default: the only one, or that with \"front\" in its name]
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Which texts are kept: those that passed every check, or also those with claims that nothing decided. [default: passed]
    #[arg(long, value_enum, default_value_t)]
    pub keep: KeptTexts,
    /// Annotate only the first episodes.
    #[arg(long, value_name = "N")]
    pub limit: Option<usize>,
    /// Seed of everything that is drawn. [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Who sees and writes.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}

/// Which texts are kept.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum KeptTexts {
    /// Those that passed every check.
    #[default]
    Passed,
    /// Also those with claims that nothing decided; annotations.jsonl marks them.
    Unverified,
}

impl AnnotateArgs {
    /// The flags as the settings of other commands.
    #[must_use]
    pub fn asked_settings(&self) -> AskedSettings {
        AskedSettings {
            platform: crate::settings::AskedPlatform {
                platform: Some("recording".into()),
                data: Some(self.dataset.clone()),
                ..Default::default()
            },
            writing: Writing {
                style: Some(vec![self.style.clone().unwrap_or_else(|| "r2r".to_owned())]),
                per_path: Some(self.per_path.unwrap_or(DEFAULT_TEXTS)),
                ..Writing::default()
            },
            draw: Draw { seed: self.seed, ..Draw::default() },
            roles: self.roles.clone(),
            service: self.service.clone(),
            ..AskedSettings::default()
        }
    }
}

/// Texts about a whole episode, if nothing else is asked for.
const DEFAULT_TEXTS: usize = 2;
