//! The thresholds at which the agents of a comparison decide: the defaults for a grounder, and those of a user's file. They are
//! looked up by the names of the agents.

use std::{collections::BTreeMap, path::Path};
use wayword_navigation::agents::{BacktrackParameters, PhraseWalkParameters, ToolWalkLimits};
use wayword_run::{error::CommandError, text_file};

/// The agent that reads every clause and knows only the places where it was.
pub(super) const READER_AGENT_NAME: &str = "reader";
/// The agent that reads every clause and knows the map.
pub(super) const READER_MAP_AGENT_NAME: &str = "reader-map";
/// The agent whose moves a language model decides.
pub(super) const TOOLS_AGENT_NAME: &str = "tools";
/// The agent that walks by phrases and looks for them with a detector.
pub(super) const GLIP_NAV_AGENT_NAME: &str = "glip-nav";

/// The value of `--grounder` that means the detector of `--detector`.
pub(super) const DETECTOR_GROUNDER_NAME: &str = "detector";

/// The thresholds and limits of all agents of a comparison.
#[derive(Debug, Default)]
pub(super) struct AgentThresholds {
    /// The thresholds of the agents that walk by phrases, by agent.
    pub(super) phrase_parameters: BTreeMap<String, PhraseWalkParameters>,
    /// The lowest score with which the agent that reads counts a thing as seen; `None` if it takes things from labels.
    pub(super) reader_threshold: Option<f32>,
    /// The limits of a walk of the agent `tools`: hops, calls and money.
    pub(super) tool_limits: ToolWalkLimits,
}

/// Reads the thresholds of each agent: the defaults for its grounder, overridden by the TOML file of `--parameters`.
///
/// # Errors
/// When an agent is named twice, or the file names an unknown agent or threshold.
pub(super) fn read_thresholds(
    names: &[String],
    (grounder, detector): (&str, Option<&str>),
    file: Option<&Path>,
) -> Result<AgentThresholds, CommandError> {
    if let Some(name) = (1..names.len()).find(|at| names[..*at].contains(&names[*at])).map(|at| &names[at]) {
        return Err(CommandError::usage(format!("--agents {name}: this agent is named twice"), "name it once"));
    }
    let mut tables = toml::Table::new();
    if let Some(file) = file {
        let parse_error = |error: toml::de::Error| parameter_error(file, error.to_string().trim());
        tables = text_file::read_text_file(file, "read the parameters")?.parse().map_err(parse_error)?;
    }
    let mut thresholds = AgentThresholds::default();
    for name in names {
        let default = PhraseWalkParameters::default_of(name, scorer_name(name, grounder, detector));
        let user_values = tables.remove(name);
        if name == TOOLS_AGENT_NAME {
            let limits = user_values.map_or(Ok(ToolWalkLimits::default()), parse_tool_limits);
            thresholds.tool_limits =
                limits.map_err(|problem| parameter_error(file.unwrap_or(Path::new("")), &problem))?;
            continue;
        }
        let is_reader = name == READER_AGENT_NAME && !grounder.starts_with("labels");
        let changed = match (name.as_str(), user_values) {
            (_, None) => Ok(default),
            (READER_AGENT_NAME, Some(user_values)) if is_reader => changed_for_reader(&default, user_values),
            (READER_AGENT_NAME | READER_MAP_AGENT_NAME, Some(_)) => {
                Err(format!("{name} has no thresholds here: it is told the labels"))
            }
            (_, Some(user_values)) => change_parameters(&default, user_values),
        };
        let changed = changed.map_err(|problem| parameter_error(file.unwrap_or(Path::new("")), &problem))?;
        match name.as_str() {
            READER_AGENT_NAME if is_reader => thresholds.reader_threshold = Some(changed.phrase_threshold),
            READER_AGENT_NAME | READER_MAP_AGENT_NAME => {}
            _ => drop(thresholds.phrase_parameters.insert(name.clone(), changed)),
        }
    }
    match (tables.keys().next(), file) {
        (Some(unused), Some(file)) => {
            Err(parameter_error(file, &format!("no agent of this command is named {unused}")))
        }
        _ => Ok(thresholds),
    }
}

/// The name of the scorer for which an agent's default thresholds are looked up. It is the detector for an agent that walks by
/// boxes, and the grounder for the others.
pub(super) fn scorer_name<'a>(agent: &str, grounder: &'a str, detector: Option<&str>) -> &'a str {
    let by_boxes = agent == GLIP_NAV_AGENT_NAME && detector.is_some();
    if by_boxes || detector == Some(grounder) { DETECTOR_GROUNDER_NAME } else { grounder }
}

fn parameter_error(file: &Path, problem: &str) -> CommandError {
    let hint = "write a table per agent, as in: [clip-nav] on one line and stop_threshold = 0.7 on the next";
    CommandError::usage(format!("{}: {problem}", file.display()), hint)
}

/// The limits of a walk of the agent `tools`: hops, calls and money.
fn parse_tool_limits(user_values: toml::Value) -> Result<ToolWalkLimits, String> {
    let limits: ToolWalkLimits = user_values.try_into().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let are_sane = limits.max_hops <= 1000 && (1..=1000).contains(&limits.max_calls) && limits.memory <= 12;
    let is_money = limits.max_usd.is_none_or(|usd| usd.is_finite() && usd > 0.0);
    if are_sane && is_money {
        return Ok(limits);
    }
    Err("[tools]: max_hops must be at most 1000, max_calls from 1 to 1000, memory at most 12, and max_usd above 0"
        .to_owned())
}

/// Overrides the threshold of the agent that reads. It has only one, and no other value may be set.
fn changed_for_reader(
    default: &PhraseWalkParameters,
    user_values: toml::Value,
) -> Result<PhraseWalkParameters, String> {
    let has_other = |user_values: &toml::Table| user_values.keys().any(|key| key != "phrase_threshold");
    match user_values {
        toml::Value::Table(user_values) if has_other(&user_values) => {
            Err("reader has no threshold but phrase_threshold".to_owned())
        }
        user_values => change_parameters(default, user_values),
    }
}

/// Overrides some values of default parameters, and checks the result.
fn change_parameters(default: &PhraseWalkParameters, user_values: toml::Value) -> Result<PhraseWalkParameters, String> {
    let mut table = toml::Table::try_from(default).map_err(|error| error.to_string())?;
    let toml::Value::Table(user_values) = user_values else {
        return Err("the thresholds of an agent must be a table".to_owned());
    };
    for (name, value) in user_values {
        match (table.get_mut(&name), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(user_values)) => inner.extend(user_values),
            (_, value) => drop(table.insert(name, value)),
        }
    }
    let parameters: PhraseWalkParameters =
        toml::Value::Table(table).try_into().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let BacktrackParameters { window, threshold, .. } =
        parameters.back.unwrap_or(BacktrackParameters { window: 1, threshold: 0.0, nodes: 0 });
    let thresholds = [parameters.phrase_threshold, parameters.stop_threshold, threshold];
    let is_sane = parameters.max_hops <= 1000 && (1..=1000).contains(&window);
    if !is_sane {
        return Err("max_hops must be at most 1000, and back.window from 1 to 1000".to_owned());
    }
    if thresholds.iter().any(|threshold| !threshold.is_finite()) {
        return Err("a threshold must be a finite number".to_owned());
    }
    if default.back.is_none() && parameters.back.is_some() {
        return Err("this agent never goes back; seq-clip-nav does".to_owned());
    }
    Ok(parameters)
}
