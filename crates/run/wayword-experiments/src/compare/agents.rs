//! The agents of a comparison by name.

use super::{
    settings::ComparisonSettings,
    thresholds::{GLIP_NAV_AGENT_NAME, READER_AGENT_NAME, READER_MAP_AGENT_NAME, TOOLS_AGENT_NAME},
};
use crate::compare::args::AskedPrior;
use wayword_navigation::{
    agents::{PhraseWalkParameters, WalkPrior},
    comparison::{AgentKind, ComparedAgent},
};

/// Hops of the two random baselines, `random/5` and `random/10`.
pub(super) const RANDOM_HOPS: [usize; 2] = [5, 10];
/// Most hops of the baseline that walks straight ahead.
pub(super) const STRAIGHT_HOPS: usize = 10;
/// Random walks that each random baseline makes for an item.
pub(super) const RANDOM_WALKS: usize = 10;

/// An agent with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum WalkingAgent {
    /// Walks phrase by phrase. A grounder scores phrases by the boxes of a detector, or by whole views.
    Phrases { name: String, parameters: PhraseWalkParameters, by_detector: bool },
    /// Reads every clause, and knows only the places where it was. Without a threshold it takes things from labels; with one it
    /// counts a thing as seen if a grounder scores it at least so high.
    Reader(Option<f32>),
    /// A language model that looks around and steps.
    Tools,
    /// Reads every clause, and knows the map.
    ReaderMap(WalkPrior),
    /// Walks this many random hops.
    Random(usize),
    /// Walks at most this many hops straight ahead.
    Straight(usize),
    /// Walks to the nearest room of the kind that the text names.
    NearestRoom,
    /// Walks the shortest path to the goal, without reading.
    Oracle,
}

impl WalkingAgent {
    /// The agents that the user asked for, with the baselines and the oracle that every comparison has.
    pub(super) fn all_for_comparison(config: &ComparisonSettings, prior: AskedPrior) -> Vec<Self> {
        let agent = |name: &String| match name.as_str() {
            READER_AGENT_NAME => Some(Self::Reader(config.reader_threshold)),
            READER_MAP_AGENT_NAME => None,
            TOOLS_AGENT_NAME => Some(Self::Tools),
            _ => {
                let parameters = *config.parameters.get(name)?;
                Some(Self::Phrases { name: name.clone(), parameters, by_detector: name == GLIP_NAV_AGENT_NAME })
            }
        };
        let mut all: Vec<Self> = config.agents.iter().filter_map(agent).collect();
        all.extend(RANDOM_HOPS.map(Self::Random));
        all.push(Self::Straight(STRAIGHT_HOPS));
        all.extend(config.knows_map().then_some(Self::ReaderMap(prior.0)));
        all.extend([Self::NearestRoom, Self::Oracle]);
        all
    }

    /// The name of the agent on the command line and in the files.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Phrases { name, .. } => name.clone(),
            Self::Reader(_) => READER_AGENT_NAME.to_owned(),
            Self::Tools => TOOLS_AGENT_NAME.to_owned(),
            Self::ReaderMap(_) => READER_MAP_AGENT_NAME.to_owned(),
            Self::Random(hops) => format!("random/{hops}"),
            Self::Straight(hops) => format!("straight/{hops}"),
            Self::NearestRoom => "nearest-room".to_owned(),
            Self::Oracle => "oracle".to_owned(),
        }
    }

    /// The description of the agent for the tables: its name, its kind, and whether it reads texts.
    pub(super) fn as_compared_agent(&self) -> ComparedAgent {
        let (kind, reads) = match self {
            Self::Phrases { .. } | Self::Reader(_) | Self::Tools => (AgentKind::Agent, true),
            Self::Random(_) | Self::Straight(_) => (AgentKind::LowerBound, false),
            Self::ReaderMap(_) | Self::NearestRoom => (AgentKind::Informed, true),
            Self::Oracle => (AgentKind::UpperBound, false),
        };
        ComparedAgent { name: self.name(), kind, reads, has_extra_rows: matches!(self, Self::ReaderMap(_)) }
    }
}
