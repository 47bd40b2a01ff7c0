//! The command line of `wayword perceive`.

use clap::Args;
use std::path::PathBuf;
use wayword_run::settings::{
    AskedFrames, AskedPlatform, AskedRoles, AskedSettings, Draw, Perception, Service, Walks, Writing,
};

/// `wayword perceive`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword perceive --platform house --views 100 --llm ollama/qwen3 --see ollama/llava
      Compare fixed queries, a single request, the structured request and the dialogue on the same 100 views, and say
      which pays.
  wayword perceive --platform matterport --data DATA --see openai/gpt-4.1-mini --perception single --max-usd 1
  wayword perceive --platform matterport --data DATA --detector hf/google/owlv2-base-patch16-ensemble \\
      --frames panoramic --figures owl.toml
      How much of what the labels list a detector finds, and how often it finds what is not there, in four directions.
  wayword perceive --perception dialogue --show 5
      Without a model: ground-truth labels answer, and rules ask and summarise.")]
pub struct PerceiveArgs {
    /// Settings as TOML, as `generate` takes them. A flag wins over the file.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// The platform. It must have labels.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// Number of different views.
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub views: usize,
    /// Take the views along the paths of a dataset, instead of along random paths.
    #[arg(long, value_name = "FILE")]
    pub episodes: Option<PathBuf>,
    /// Use only this scene. May be given several times.
    #[arg(long, alias = "scene", value_name = "SCENE")]
    pub scan: Option<Vec<String>>,
    /// At each frame, look along the heading, or in all four directions, as `check` does with a detector. [default: central]
    #[arg(long)]
    pub frames: Option<AskedFrames>,
    /// Use only this kind of perception. May be given several times. [default: all; a model in process is not asked for JSON]
    #[arg(long)]
    pub perception: Option<Vec<Perception>>,
    /// Ask at most this many questions per view in a dialogue. [default: 9]
    #[arg(long, value_name = "N")]
    pub questions: Option<usize>,
    /// Seed of the random paths. [default: 0]
    #[arg(long)]
    pub seed: Option<u64>,
    /// Write what was measured of --detector to this file, for --detector-figures of `generate` and `check`.
    #[arg(long, value_name = "FILE", requires = "detector")]
    pub figures: Option<PathBuf>,
    /// Show this many captions of each kind of perception.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub show: usize,
    /// Who asks, sees and summarises.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}

impl PerceiveArgs {
    /// The flags in the form from which all commands make their settings, without the number of random paths.
    #[must_use]
    pub fn asked_settings(&self) -> AskedSettings {
        AskedSettings {
            platform: self.platform.clone(),
            walks: Walks { episodes: self.episodes.clone(), scan: self.scan.clone(), ..Walks::default() },
            writing: Writing { frames: self.frames, questions: self.questions, ..Writing::default() },
            draw: Draw { seed: self.seed, ..Draw::default() },
            roles: self.roles.clone(),
            service: self.service.clone(),
            ..AskedSettings::default()
        }
    }
}
