//! `wayword doctor` as it is typed.

use crate::settings::{Asked, AskedRoles, Service, World};
use clap::Args;
use std::path::PathBuf;

/// `wayword doctor`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword doctor --llm ollama/qwen3 --see ollama/llava
  wayword doctor --see server/llava --base-url http://127.0.0.1:8000/v1
  wayword doctor --platform matterport --data DATA")]
pub struct Doctor {
    /// Settings as TOML, with the providers and roles of `generate`; flags win.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The models to look at.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How they are reached.
    #[command(flatten)]
    pub service: Service,
}

impl Doctor {
    /// What the flags ask for.
    #[must_use]
    pub fn asked(&self) -> Asked {
        Asked {
            world: self.world.clone(),
            roles: self.roles.clone(),
            service: self.service.clone(),
            ..Asked::default()
        }
    }
}
