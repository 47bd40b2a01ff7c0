//! The flags of `wayword models`.

use clap::{Args, Subcommand};

/// `wayword models`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword models list
  wayword models fetch hf/Salesforce/blip-vqa-base
  wayword models fetch --tokenizer hf/google-bert/bert-base-uncased
  wayword models path hf/Salesforce/blip-vqa-base@main

Models are kept in Hugging Face's cache, which its Python client shares: $HF_HUB_CACHE, else $HF_HOME/hub, else
~/.cache/huggingface/hub. HF_ENDPOINT names another hub, HF_TOKEN holds a token for private and gated models, and with
WAYWORD_OFFLINE=1 nothing is fetched. A model in a folder of your own is named hf/PATH, where PATH begins with / or ., as in
hf/./models/blip.")]
pub struct ModelsArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: ModelsCommand,
}

/// What to do with models in process.
#[derive(Debug, Subcommand)]
pub enum ModelsCommand {
    /// List the models on this machine.
    #[command(after_long_help = "Examples:\n  wayword models list")]
    List,
    /// Fetch a model. If it is here already, update it to the newest version of its branch. A fetch that was cut off continues
    /// where it ended.
    #[command(
        after_long_help = "Examples:\n  wayword models fetch hf/Salesforce/blip-vqa-base\n  wayword models fetch --tokenizer hf/google-bert/bert-base-uncased"
    )]
    Fetch {
        /// Its name: hf/ORG/NAME or hf/ORG/NAME@REVISION.
        name: String,
        /// Fetch only its tokenizer.json, a small file, as `wayword export --tokenizer` needs it.
        #[arg(long)]
        tokenizer: bool,
    },
    /// Print a model's folder, or the file that it lacks, without fetching it.
    #[command(after_long_help = "Examples:\n  wayword models path hf/Salesforce/blip-vqa-base")]
    Path {
        /// Its name.
        name: String,
        /// Only its tokenizer.json has to be here.
        #[arg(long)]
        tokenizer: bool,
    },
}
