//! The flags of `wayword check --by pictures`.

use clap::{Args, ValueEnum};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What texts are checked by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum CheckBy {
    /// What is known of their paths: labels, a detector's finds, the captions of a run.
    #[default]
    Evidence,
    /// The pictures along their paths, as a model, a detector or labels see them. Each text gets a chance to be wrong.
    Pictures,
}

/// What the motion of a film is taken from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum AskedMotion {
    /// Poses where there are any, else the pictures.
    #[default]
    Auto,
    /// The pictures, also where there are poses.
    Pictures,
    /// Nothing.
    None,
}

/// The flags for pairs of pictures and texts.
#[derive(Debug, Clone, Args)]
pub struct PairArgs {
    /// What the texts are checked by. With `pictures`, any pairs of a film and a text are judged: StreamVLN, NaVILA, InternNav and LeRobot
    /// folders, or a file of texts with --platform and --data.
    #[arg(long, value_enum, default_value_t, value_name = "WHAT")]
    pub by: CheckBy,
    /// With --by pictures: who sees. A model that looks at pictures, or labels.
    #[arg(long, value_name = "MODEL")]
    pub see: Option<String>,
    /// With --by pictures: base URL of the provider of --see.
    #[arg(long, value_name = "URL", requires = "see")]
    pub base_url: Option<String>,
    /// With --by pictures: environment variable that holds the key of the provider.
    #[arg(long, value_name = "NAME", requires = "see")]
    pub key_env: Option<String>,
    /// With --by pictures: stop before the costs exceed this, in US dollars.
    #[arg(long, value_name = "USD", requires = "see")]
    pub max_usd: Option<f64>,
    /// With --by pictures: number of requests at the same time.
    #[arg(long, value_name = "N", requires = "see")]
    pub concurrency: Option<usize>,
    /// With --by pictures: what the turns of a film are taken from.
    #[arg(long, value_enum, default_value_t, value_name = "WHAT")]
    pub motion: AskedMotion,
    /// With --by pictures: the share of wrong pairs that you expect, from 0 to 1. Where it is given for 50 pairs or more, the chances are moved
    /// together until their mean is this share; that changes no order. [default: 0.2, and the chances stay as they are]
    #[arg(long, value_name = "SHARE")]
    pub base_rate: Option<f64>,
    /// With --by pictures: folder for the results and the page for curators. The same command again goes on where it stopped.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}
