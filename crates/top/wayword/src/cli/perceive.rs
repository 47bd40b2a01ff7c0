//! `wayword perceive` as it is typed.

use crate::settings::{Asked, AskedRoles, Draw, Perception, Service, Telling, Walks, World};
use clap::Args;
use std::path::PathBuf;

/// `wayword perceive`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword perceive --platform house --views 100 --llm ollama/qwen3 --see ollama/llava
      Fixed queries, one request, and the dialogue, on the same views.
  wayword perceive --platform matterport --data DATA --see openai/gpt-4.1-mini --perception single --max-usd 1
  wayword perceive --perception dialogue --show 5
      What labels and rules make of a view: no model takes part.")]
pub struct Perceive {
    /// Settings as TOML, with the providers and roles of `generate`; flags win.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// The world; it has to know labels.
    #[command(flatten)]
    pub world: World,
    /// How many different views.
    #[arg(long, value_name = "N", default_value_t = 100)]
    pub views: usize,
    /// Look along the paths of a dataset, and not along random ones.
    #[arg(long, value_name = "FILE")]
    pub episodes: Option<PathBuf>,
    /// Keep to this scene; may be given several times.
    #[arg(long, value_name = "SCENE")]
    pub scan: Option<Vec<String>>,
    /// Only this way of asking; may be given several times. [default: all three]
    #[arg(long)]
    pub perception: Option<Vec<Perception>>,
    /// Most questions per view in a dialogue. [default: 9]
    #[arg(long, value_name = "N")]
    pub questions: Option<usize>,
    /// Seed of the random paths. [default: 0]
    #[arg(long)]
    pub seed: Option<u64>,
    /// Show so many captions of each way of asking.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub show: usize,
    /// Who asks, sees and sums up.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}

impl Perceive {
    /// What the flags ask for, but for the number of random paths.
    #[must_use]
    pub fn asked(&self) -> Asked {
        Asked {
            world: self.world.clone(),
            walks: Walks { episodes: self.episodes.clone(), scan: self.scan.clone(), ..Walks::default() },
            telling: Telling { questions: self.questions, ..Telling::default() },
            draw: Draw { seed: self.seed, ..Draw::default() },
            roles: self.roles.clone(),
            service: self.service.clone(),
            ..Asked::default()
        }
    }
}
