//! What a comparison was asked for: kept in its folder, so that it is continued as it was begun.

use crate::{cli::Compare, error::Error, run::hash_of_file};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_metrics::Rule;
use wayword_navigation::{agents::Parameters, swap::Swap};

/// A comparison as it was asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plan {
    /// The platform's name.
    pub(crate) platform: String,
    /// Folder of its data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) data: Option<PathBuf>,
    /// The items.
    pub(crate) episodes: PathBuf,
    /// Sets of instructions: name and source, in order; no source for the episodes' own.
    pub(crate) instructions: Vec<(String, String)>,
    /// Who walks.
    pub(crate) agents: Vec<String>,
    /// Who scores views.
    pub(crate) grounder: String,
    /// The sentence encoder, where the grounder needs one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) encoder: Option<String>,
    /// Who takes instructions apart.
    pub(crate) split: String,
    /// Where that model is reached, where not at its provider's own address.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) base_url: Option<String>,
    /// What counts as success; decided by the items where nobody says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) rule: Option<Rule>,
    /// Swaps of the first set.
    pub(crate) swaps: Vec<Swap>,
    /// Only so many items.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) limit: Option<usize>,
    /// Resamples of the intervals.
    pub(crate) resamples: usize,
    /// Seed of everything random.
    pub(crate) seed: u64,
    /// What the agents decide by.
    pub(crate) parameters: BTreeMap<String, Parameters>,
    /// Hashes of the files that are read; a comparison is not continued with others.
    pub(crate) inputs: BTreeMap<String, String>,
}

/// The set of the episodes' own instructions.
pub(super) const ORIGINAL: &str = "original";

impl Plan {
    /// What the flags ask for.
    ///
    /// # Errors
    /// When a set is named twice or not as it should be, an agent is not known, or a file cannot be read.
    pub(super) fn of(args: &Compare) -> Result<Self, Error> {
        let asked = if args.instructions.is_empty() { &vec![ORIGINAL.to_owned()] } else { &args.instructions };
        let mut instructions: Vec<(String, String)> = Vec::new();
        let mut inputs = BTreeMap::from([("episodes".to_owned(), hash_of_file(&args.episodes)?)]);
        for set in asked {
            let (name, source) = named(set)?;
            if instructions.iter().any(|(other, _)| *other == name) {
                return Err(Error::usage(format!("--instructions: {name} comes twice"), "give each set its own name"));
            }
            if !source.is_empty() {
                inputs.insert(format!("instructions {name}"), hash_of_file(&crate::texts::file_of(&source))?);
            }
            instructions.push((name, source));
        }
        let parameters = super::agents::parameters(&args.agents, &args.grounder, args.parameters.as_deref())?;
        Ok(Self {
            platform: args.world.platform.clone().unwrap_or_else(|| "house".to_owned()),
            data: args.world.data.clone(),
            episodes: args.episodes.clone(),
            instructions,
            agents: args.agents.clone(),
            grounder: args.grounder.clone(),
            encoder: (args.grounder == "labels").then(|| args.encoder.clone()),
            split: args.split.clone(),
            base_url: args.base_url.clone(),
            rule: args.rule.map(Into::into),
            swaps: args.swaps.iter().filter_map(|swap| swap.swap()).collect(),
            limit: args.limit,
            resamples: args.resamples as usize,
            seed: args.seed,
            parameters,
            inputs,
        })
    }
}

/// A set as it is typed: its name and its source.
fn named(set: &str) -> Result<(String, String), Error> {
    if set == ORIGINAL {
        return Ok((set.to_owned(), String::new()));
    }
    let is_name =
        |name: &str| !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || matches!(c, '-' | '_' | '.'));
    match set.split_once('=') {
        Some((name, source)) if is_name(name) && name != ORIGINAL && !source.is_empty() => {
            Ok((name.to_owned(), source.to_owned()))
        }
        _ => Err(Error::usage(
            format!("--instructions {set}: that names no set"),
            "write original, or NAME=RUN#STYLE, as in --instructions central=runs/central#reverie",
        )),
    }
}

/// A source's last part, for a page that is passed on should not tell of its maker's machine.
pub(super) fn last_part(source: &str) -> String {
    Path::new(source).file_name().map_or_else(|| source.to_owned(), |name| name.to_string_lossy().into_owned())
}
