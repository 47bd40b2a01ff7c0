//! The settings of a comparison. `config.toml` in its folder stores them, so that a later command continues with the same.

use super::thresholds::{DETECTOR_GROUNDER_NAME, READER_MAP_AGENT_NAME, TOOLS_AGENT_NAME, read_thresholds};
use crate::compare::{
    args::{CompareArgs, SwapName},
    tool_agent_eyes::ToolAgentEyes,
};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::Platform;
use wayword_navigation::{
    agents::{PhraseWalkParameters, ToolWalkLimits, prompt_wording},
    comparison::UNREAD_SET_NAME,
    swap::InstructionSwap,
};
use wayword_run::{
    error::CommandError,
    own_format::OwnFormat,
    platforms::{self, PlatformPlace},
    run_folder::{hash_of_file, short_hex},
    settings::{RolePlayer, RunSettings, refuse_unnameable},
};

/// The settings of a comparison, as `config.toml` stores them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ComparisonSettings {
    /// The platform's name.
    pub(crate) platform: String,
    /// Folder of its data.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) data: Option<PathBuf>,
    /// Address of a running simulator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) at: Option<String>,
    /// The island of a Habitat navmesh, if one was named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) island: Option<usize>,
    /// Folder of the viewpoint graphs along which Habitat's scenes are walked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) connectivity: Option<PathBuf>,
    /// The items.
    pub(crate) episodes: PathBuf,
    /// Sets of instructions: name and source, in order. The source of `original` is empty.
    pub(crate) instructions: Vec<(String, String)>,
    /// The agents.
    pub(crate) agents: Vec<String>,
    /// What scores views.
    pub(crate) grounder: String,
    /// The sentence encoder, if the grounder needs one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) encoder: Option<String>,
    /// The detector, if one was named.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) detector: Option<String>,
    /// What splits instructions into phrases.
    pub(crate) split: RolePlayer,
    /// Base URL of the provider of the models, if it is not the provider's default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) base_url: Option<String>,
    /// Swaps of the first set.
    pub(crate) swaps: Vec<InstructionSwap>,
    /// Only this many items.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) limit: Option<usize>,
    /// Seed of everything random.
    pub(crate) seed: u64,
    /// The walks that the agent `reader-map` considers, if it takes part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) prior: Option<String>,
    /// The lowest score with which the agent `reader` counts a thing as seen, if a grounder scores things.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) reader_threshold: Option<f32>,
    /// The settings of the agent `tools`, if it takes part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) tools: Option<ToolAgentSettings>,
    /// Thresholds of the agents that walk by phrases.
    pub(crate) parameters: BTreeMap<String, PhraseWalkParameters>,
    /// Hashes of the input files. A comparison is not continued if one of them has changed.
    pub(crate) inputs: BTreeMap<String, String>,
}

/// The settings of the agent `tools`, which lets a language model decide.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ToolAgentSettings {
    /// Its model.
    pub(crate) llm: String,
    /// How it sees: labels, pictures, or the model that describes them.
    pub(crate) see: ToolAgentEyes,
    /// Longer side of the pictures that models are sent.
    pub(crate) picture_px: u32,
    /// The limits of a walk: hops, calls and money.
    pub(crate) limits: ToolWalkLimits,
}

/// The version also changes when agents decide otherwise than before, so that no folder mixes walks of two versions.
impl OwnFormat for ComparisonSettings {
    const NAME: &str = "wayword-comparison/1";
    const NUMBER: Option<i64> = Some(1);
}

/// The name of the set of the episodes' own instructions.
pub(super) const ORIGINAL_SET_NAME: &str = "original";

impl ComparisonSettings {
    /// Makes the settings from the flags, and hashes the input files.
    ///
    /// # Errors
    /// When a set is named twice or not as it should be, an agent is not known, or a file cannot be read.
    pub(super) fn from_args(args: &CompareArgs, settings: &RunSettings) -> Result<Self, CommandError> {
        refuse_unnameable("--episodes", Some(&args.episodes))?;
        refuse_unnameable("--data", settings.data.as_deref())?;
        refuse_unnameable("--connectivity", settings.connectivity.as_deref())?;
        let asked = if args.instructions.is_empty() { &vec![ORIGINAL_SET_NAME.to_owned()] } else { &args.instructions };
        let mut instructions: Vec<(String, String)> = Vec::new();
        let mut inputs = BTreeMap::from([("episodes".to_owned(), hash_of_file(&args.episodes)?)]);
        for set in asked {
            let (name, source) = parse_named_set(set)?;
            // Submissions are named after their set, and some file systems ignore case.
            if instructions.iter().any(|(other, _)| other.to_lowercase() == name.to_lowercase()) {
                return Err(CommandError::usage(
                    format!("--instructions: the name {name} is used twice"),
                    "give each set its own name",
                ));
            }
            if !source.is_empty() {
                crate::text_sets::refuse_other_folder(&source)?;
                inputs.insert(format!("instructions {name}"), hash_of_file(&crate::text_sets::text_set_file(&source))?);
            }
            instructions.push((name, source));
        }
        if args.llm.is_some() {
            inputs.insert("prompts of tools".to_owned(), short_hex(Sha256::new_with_prefix(prompt_wording())));
        }
        let detector = settings.roles.detector.as_deref();
        let thresholds = read_thresholds(&args.agents, (&args.grounder, detector), args.parameters.as_deref())?;
        Ok(Self {
            platform: settings.platform.clone(),
            data: settings.data.as_deref().map(absolute_path).transpose()?,
            at: settings.at.clone(),
            island: settings.island,
            connectivity: settings.connectivity.as_deref().map(absolute_path).transpose()?,
            episodes: absolute_path(&args.episodes)?,
            instructions,
            agents: args.agents.clone(),
            grounder: args.grounder.clone(),
            encoder: (args.grounder == "labels").then(|| args.encoder.clone()),
            detector: settings.roles.detector.clone(),
            split: settings.roles.ask.clone(),
            base_url: settings.roles.base_url.clone(),
            swaps: check_swaps(&args.swaps)?,
            limit: settings.limit,
            seed: settings.seed,
            prior: prior_name(args)?,
            reader_threshold: thresholds.reader_threshold,
            tools: tool_agent_settings(args, settings, thresholds.tool_limits),
            parameters: thresholds.phrase_parameters,
            inputs,
        })
    }

    /// Whether the detector scores whole views too.
    pub(super) fn detects_views(&self) -> bool {
        self.grounder == DETECTOR_GROUNDER_NAME || self.detector.as_deref() == Some(&*self.grounder)
    }

    /// Whether the agent `reader-map` takes part.
    pub(super) fn knows_map(&self) -> bool {
        self.agents.iter().any(|agent| agent == READER_MAP_AGENT_NAME)
    }

    /// The platform.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub(super) fn open_platform(&self) -> Result<Box<dyn Platform>, CommandError> {
        let Self { data, at, island, connectivity, .. } = self;
        let (data, at, connectivity) = (data.as_deref(), at.as_deref(), connectivity.as_deref());
        platforms::open_and_warn(&self.platform, PlatformPlace { data, at, island: *island, connectivity })
    }
}

/// Whether a set can have this name: it becomes part of a file name, and some names have a meaning of their own.
fn is_free_set_name(name: &str) -> bool {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let is_taken = [ORIGINAL_SET_NAME, UNREAD_SET_NAME].contains(&name.to_lowercase().as_str());
    name.starts_with(char::is_alphanumeric) && name.chars().all(is_plain) && !is_taken
}

/// The walks that the agent `reader-map` considers; `None` if it does not take part.
fn prior_name(args: &CompareArgs) -> Result<Option<String>, CommandError> {
    let knows_map = args.agents.iter().any(|agent| agent == READER_MAP_AGENT_NAME);
    if let (false, Some(prior)) = (knows_map, args.prior) {
        return Err(CommandError::usage(
            format!("--prior {prior} has no effect: it is for the agent {READER_MAP_AGENT_NAME}"),
            format!("add {READER_MAP_AGENT_NAME} to --agents, or leave --prior out"),
        ));
    }
    Ok(knows_map.then(|| args.prior.unwrap_or_default().to_string()))
}

/// Refuses flags of the agent `tools` without that agent, and the agent without a model.
///
/// # Errors
/// When they do not fit together.
pub(super) fn refuse_flags_of_tools(args: &CompareArgs) -> Result<(), CommandError> {
    let is_asked = args.agents.iter().any(|agent| agent == TOOLS_AGENT_NAME);
    let given =
        [("--llm", args.llm.is_some()), ("--see", args.see.is_some()), ("--picture-px", args.picture_px.is_some())];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) if !is_asked => Err(CommandError::usage(
            format!("{flag} has no effect: it is for the agent {TOOLS_AGENT_NAME}"),
            format!("add {TOOLS_AGENT_NAME} to --agents, or leave {flag} out"),
        )),
        _ if is_asked && args.llm.is_none() => Err(CommandError::usage(
            format!("--agents {TOOLS_AGENT_NAME}: this agent needs a language model"),
            "name one, as in --llm openai/gpt-4.1-mini",
        )),
        _ => Ok(()),
    }
}

/// The settings of the agent `tools`; `None` if it does not take part.
fn tool_agent_settings(
    args: &CompareArgs,
    settings: &RunSettings,
    limits: ToolWalkLimits,
) -> Option<ToolAgentSettings> {
    Some(ToolAgentSettings {
        llm: args.llm.clone()?,
        see: args.see.clone().unwrap_or(ToolAgentEyes::Player(RolePlayer::Labels)),
        picture_px: settings.roles.picture_px,
        limits,
    })
}

/// The swaps that were asked for. `none` cannot be combined.
fn check_swaps(asked: &[SwapName]) -> Result<Vec<InstructionSwap>, CommandError> {
    let swaps: Vec<InstructionSwap> = asked.iter().filter_map(|swap| swap.to_swap()).collect();
    let is_twice = (1..swaps.len()).any(|at| swaps[..at].contains(&swaps[at]));
    if is_twice || (swaps.len() < asked.len() && asked.len() > 1) {
        return Err(CommandError::usage(
            "--swaps names a swap twice, or `none` together with others",
            "name each swap once, or only `none`",
        ));
    }
    Ok(swaps)
}

/// The absolute path, which means the same from whatever folder `wayword report` is run later.
fn absolute_path(path: &Path) -> Result<PathBuf, CommandError> {
    std::path::absolute(path).map_err(CommandError::io(path, "find"))
}

/// Splits a set as typed into its name and its source.
fn parse_named_set(set: &str) -> Result<(String, String), CommandError> {
    if set == ORIGINAL_SET_NAME {
        return Ok((set.to_owned(), String::new()));
    }
    match set.split_once('=') {
        Some((name, source)) if is_free_set_name(name) && !source.is_empty() => {
            Ok((name.to_owned(), source.to_owned()))
        }
        _ => Err(CommandError::usage(
            format!("--instructions {set}: this does not name a set"),
            "give `original` or NAME=RUN#STYLE, as in --instructions central=runs/central#reverie",
        )),
    }
}

/// The last part of a source. A page that is passed on should not show its maker's folders.
pub(super) fn last_part(source: &str) -> String {
    Path::new(source).file_name().map_or_else(|| source.to_owned(), |name| name.to_string_lossy().into_owned())
}
