//! Agents by their names, and their thresholds.

use super::kept::Kept;
use crate::{cli::AskedPrior, error::Error, text_file};
use std::{collections::BTreeMap, path::Path};
use wayword_navigation::{
    agents::{Back, Limits, Parameters, Prior},
    comparison::{AgentKind, Walker},
};

/// The agent that reads, and its fellow that knows the map.
pub(super) const READER: &str = "reader";
pub(super) const READER_MAP: &str = "reader-map";
/// The agent by a language model.
pub(super) const TOOLS: &str = "tools";
/// The agent that uses a detector.
pub(super) const BY_DETECTOR: &str = "glip-nav";

/// Hops of the random baselines.
pub(super) const RANDOM_HOPS: [usize; 2] = [5, 10];
/// Most hops of the baseline that walks straight ahead.
pub(super) const STRAIGHT_HOPS: usize = 10;
/// Random walks per item.
pub(super) const RANDOM_WALKS: usize = 10;

/// An agent.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Agent {
    /// Walks by phrases, with the grounder of boxes or that of whole views.
    Phrases { name: String, parameters: Parameters, by_detector: bool },
    /// Reads, and knows only where it was. Things are labels, or what scores at least a threshold.
    Reader(Option<f32>),
    /// A language model that looks around and steps.
    Tools,
    /// Reads, and knows the map.
    ReaderMap(Prior),
    /// This many random hops.
    Random(usize),
    /// At most this many hops straight ahead.
    Straight(usize),
    /// To the nearest room of the kind that the text names.
    NearestRoom,
    /// To the goal.
    Oracle,
}

impl Agent {
    /// The agents that were asked for, with the lower-bound baselines and upper bounds.
    pub(super) fn all(kept: &Kept, prior: AskedPrior) -> Vec<Self> {
        let agent = |name: &String| match name.as_str() {
            READER => Some(Self::Reader(kept.reader_threshold)),
            READER_MAP => None,
            TOOLS => Some(Self::Tools),
            _ => {
                let parameters = *kept.parameters.get(name)?;
                Some(Self::Phrases { name: name.clone(), parameters, by_detector: name == BY_DETECTOR })
            }
        };
        let mut all: Vec<Self> = kept.agents.iter().filter_map(agent).collect();
        all.extend(RANDOM_HOPS.map(Self::Random));
        all.push(Self::Straight(STRAIGHT_HOPS));
        all.extend(kept.knows_map().then_some(Self::ReaderMap(prior.0)));
        all.extend([Self::NearestRoom, Self::Oracle]);
        all
    }

    /// Its name.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Phrases { name, .. } => name.clone(),
            Self::Reader(_) => READER.to_owned(),
            Self::Tools => TOOLS.to_owned(),
            Self::ReaderMap(_) => READER_MAP.to_owned(),
            Self::Random(hops) => format!("random/{hops}"),
            Self::Straight(hops) => format!("straight/{hops}"),
            Self::NearestRoom => "nearest-room".to_owned(),
            Self::Oracle => "oracle".to_owned(),
        }
    }

    /// The agent as the comparison takes it.
    pub(super) fn walker(&self) -> Walker {
        let (kind, reads) = match self {
            Self::Phrases { .. } | Self::Reader(_) | Self::Tools => (AgentKind::Agent, true),
            Self::Random(_) | Self::Straight(_) => (AgentKind::LowerBound, false),
            Self::ReaderMap(_) | Self::NearestRoom => (AgentKind::Informed, true),
            Self::Oracle => (AgentKind::UpperBound, false),
        };
        Walker { name: self.name(), kind, reads, has_floors: matches!(self, Self::ReaderMap(_)) }
    }
}

/// The thresholds of the agents.
#[derive(Debug, Default)]
pub(super) struct Thresholds {
    /// Of those that walk by phrases.
    pub(super) of_phrases: BTreeMap<String, Parameters>,
    /// From which score on a thing counts as seen by the agent that reads; `None` where labels say what is there.
    pub(super) of_reader: Option<f32>,
    /// What a walk of the agent by a language model may take.
    pub(super) of_tools: Limits,
}

/// The thresholds of each agent: the defaults of its grounder, changed by a file.
///
/// # Errors
/// When an agent is named twice, or the file names an unknown agent or threshold.
pub(super) fn parameters(
    names: &[String],
    (grounder, detector): (&str, Option<&str>),
    file: Option<&Path>,
) -> Result<Thresholds, Error> {
    if let Some(name) = (1..names.len()).find(|at| names[..*at].contains(&names[*at])).map(|at| &names[at]) {
        return Err(Error::usage(format!("--agents {name}: this agent is named twice"), "name it once"));
    }
    let mut tables = toml::Table::new();
    if let Some(file) = file {
        let wrong = |error: toml::de::Error| wrong(file, error.to_string().trim());
        tables = text_file::read(file, "read the parameters")?.parse().map_err(wrong)?;
    }
    let mut all = Thresholds::default();
    for name in names {
        let default = Parameters::default_of(name, scored_by(name, grounder, detector));
        let own = tables.remove(name);
        if name == TOOLS {
            let limits = own.map_or(Ok(Limits::default()), limits);
            all.of_tools = limits.map_err(|problem| wrong(file.unwrap_or(Path::new("")), &problem))?;
            continue;
        }
        let is_reader = name == READER && !grounder.starts_with("labels");
        let changed = match (name.as_str(), own) {
            (_, None) => Ok(default),
            (READER, Some(own)) if is_reader => changed_for_reader(&default, own),
            (READER | READER_MAP, Some(_)) => Err(format!("{name} has no thresholds here: it is told the labels")),
            (_, Some(own)) => changed(&default, own),
        };
        let changed = changed.map_err(|problem| wrong(file.unwrap_or(Path::new("")), &problem))?;
        match name.as_str() {
            READER if is_reader => all.of_reader = Some(changed.phrase_threshold),
            READER | READER_MAP => {}
            _ => drop(all.of_phrases.insert(name.clone(), changed)),
        }
    }
    match (tables.keys().next(), file) {
        (Some(unused), Some(file)) => Err(wrong(file, &format!("no agent of this command is named {unused}"))),
        _ => Ok(all),
    }
}

/// What scores phrases for an agent, by the name that its default thresholds have: one that walks by boxes takes the
/// detector's scores.
pub(super) fn scored_by<'a>(agent: &str, grounder: &'a str, detector: Option<&str>) -> &'a str {
    let by_boxes = agent == BY_DETECTOR && detector.is_some();
    if by_boxes || detector == Some(grounder) { super::kept::BY_NAME } else { grounder }
}

fn wrong(file: &Path, problem: &str) -> Error {
    let hint = "write a table per agent, as in: [clip-nav] on one line and stop_threshold = 0.7 on the next";
    Error::usage(format!("{}: {problem}", file.display()), hint)
}

/// What a walk of the agent by a language model may take.
fn limits(own: toml::Value) -> Result<Limits, String> {
    let limits: Limits = own.try_into().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let are_sane = limits.max_hops <= 1000 && (1..=1000).contains(&limits.max_calls) && limits.memory <= 12;
    let is_money = limits.max_usd.is_none_or(|usd| usd.is_finite() && usd > 0.0);
    if are_sane && is_money {
        return Ok(limits);
    }
    Err("[tools]: max_hops must be at most 1000, max_calls from 1 to 1000, memory at most 12, and max_usd above 0"
        .to_owned())
}

/// The same for the agent that reads, which has one threshold.
fn changed_for_reader(default: &Parameters, own: toml::Value) -> Result<Parameters, String> {
    let has_other = |own: &toml::Table| own.keys().any(|key| key != "phrase_threshold");
    match own {
        toml::Value::Table(own) if has_other(&own) => Err("reader has no threshold but phrase_threshold".to_owned()),
        own => changed(default, own),
    }
}

/// Parameters with some of their values changed.
fn changed(default: &Parameters, own: toml::Value) -> Result<Parameters, String> {
    let mut table = toml::Table::try_from(default).map_err(|error| error.to_string())?;
    let toml::Value::Table(own) = own else { return Err("the thresholds of an agent must be a table".to_owned()) };
    for (name, value) in own {
        match (table.get_mut(&name), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(own)) => inner.extend(own),
            (_, value) => drop(table.insert(name, value)),
        }
    }
    let parameters: Parameters =
        toml::Value::Table(table).try_into().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let Back { window, threshold, .. } = parameters.back.unwrap_or(Back { window: 1, threshold: 0.0, nodes: 0 });
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
