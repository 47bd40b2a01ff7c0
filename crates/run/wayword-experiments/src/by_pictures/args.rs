//! The flags for judging texts by pictures: a CLIP model, and where its pictures come from.

use clap::Args;
use std::path::PathBuf;
use wayword_run::settings::AskedPlatform;

/// The model and the pictures by which texts are judged.
#[derive(Debug, Clone, Default, Args)]
pub struct PictureCriticArgs {
    /// Report how well the texts agree with the pictures ahead of the path's frames, by this CLIP: 2.5 times the cosine, as CLIPScore
    /// has it. The pictures are those of a run, or the platform's.
    #[arg(long, value_name = "MODEL")]
    pub clip: Option<String>,
    /// Take the pictures of this run, which has the same items or paths.
    #[arg(long, value_name = "RUN", requires = "clip", conflicts_with_all = ["platform", "data", "at"])]
    pub pictures: Option<PathBuf>,
    /// Where the pictures come from, if they are drawn anew.
    #[command(flatten)]
    pub platform: AskedPlatform,
}
