//! The flags of `wayword doctor`.

use clap::Args;
use std::path::PathBuf;
use wayword_run::settings::{AskedPlatform, AskedRoles, AskedSettings, Service};

/// `wayword doctor`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword doctor --llm ollama/qwen3 --see ollama/llava
  wayword doctor --see server/llava --base-url http://127.0.0.1:8000/v1
  wayword doctor --platform matterport --data DATA
  wayword doctor --platform habitat --data SCENES --connectivity GRAPHS --scenes")]
pub struct DoctorArgs {
    /// Settings as TOML, as `generate` takes them. A flag wins over the file.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// Examine every scene of the data, and list what it has, what it lacks, and whether its viewpoint graph lies in it (platform
    /// habitat).
    #[arg(long)]
    pub scenes: bool,
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// The models to check.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How they are reached.
    #[command(flatten)]
    pub service: Service,
}

impl DoctorArgs {
    /// These flags as the settings of a run.
    #[must_use]
    pub fn to_asked(&self) -> AskedSettings {
        AskedSettings {
            platform: self.platform.clone(),
            roles: self.roles.clone(),
            service: self.service.clone(),
            ..AskedSettings::default()
        }
    }
}
