//! `wayword models` as it is typed.

use clap::{Args, Subcommand};

/// `wayword models`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword models list
  wayword models fetch hf/Salesforce/blip-vqa-base
  wayword models path hf/Salesforce/blip-vqa-base@main

Models lie in the cache of the hub's own client for Python, which shares them: HF_HUB_CACHE, else hub in HF_HOME, else
~/.cache/huggingface/hub. HF_ENDPOINT names another hub, HF_TOKEN holds a token for private and gated models, and with
WAYWORD_OFFLINE=1 nothing is fetched. A folder on this machine has the name hf/PATH, where PATH begins with / or . as in
hf/./models/blip.")]
pub struct Models {
    /// What to do.
    #[command(subcommand)]
    pub command: ModelsCommand,
}

/// What to do with models in process.
#[derive(Debug, Subcommand)]
pub enum ModelsCommand {
    /// What is on this machine.
    List,
    /// Fetch a model, or what its branch stands for now; a fetch that was cut off goes on where it ended.
    Fetch {
        /// Its name: hf/ORG/NAME or hf/ORG/NAME@REVISION.
        name: String,
    },
    /// Where a model lies, or which file is missing where. Nothing is fetched.
    Path {
        /// Its name.
        name: String,
    },
}
