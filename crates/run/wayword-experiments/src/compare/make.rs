//! Makes all walks of one item: every agent walks by every text that is meant for it.

use super::{
    agents::{Agent, RANDOM_WALKS},
    grounders::Grounders,
    sets::{Item, Purpose, Text},
    tools::Toolbox,
};
use std::collections::BTreeMap;
use wayword_core::{Platform, PlatformError, Recent, SceneId, rng};
use wayword_navigation::{
    AgentView, Things, WalkError,
    agents::{
        MapReader, Surveyed, Walked, last_room_in, nearest_room, oracle, random, straight, walk_by_phrases,
        walk_by_reading, walk_by_tools,
    },
    comparison::UNREAD,
    directions::{Directions, Splitter},
    walk::Walk,
};
use wayword_run::at_once::at_once;
use wayword_world::survey;

/// Makes the walks of items with the agents and models of a comparison.
pub(super) struct Crew<'a> {
    pub(super) platform: &'a dyn Platform,
    pub(super) grounders: &'a Grounders,
    pub(super) splitter: &'a dyn Splitter,
    pub(super) agents: &'a [Agent],
    pub(super) toolbox: Option<&'a Toolbox>,
    pub(super) surveys: &'a Recent<SceneId, Surveyed>,
    pub(super) seed: u64,
}

impl Agent {
    /// The texts of an item that this agent walks by.
    pub(super) fn texts<'i>(&self, item: &'i Item) -> impl Iterator<Item = &'i Text> {
        let last = match self {
            Self::ReaderMap(_) => Purpose::Floor,
            Self::NearestRoom => Purpose::Set,
            _ => Purpose::Swap,
        };
        item.texts.iter().filter(move |text| text.purpose <= last)
    }
}

impl Crew<'_> {
    /// The agent, the set and the index of the text of every walk of an item, in the order in which the walks are made.
    pub(super) fn names(&self, item: &Item) -> Vec<(String, String, usize)> {
        let of_agent = |agent: &Agent| {
            let read = || agent.texts(item).map(|text| (text.set.clone(), text.index)).collect();
            let unread = |walks| (0..walks).map(|index| (UNREAD.to_owned(), index)).collect::<Vec<_>>();
            let places = match agent {
                Agent::Phrases { .. } | Agent::Reader(_) | Agent::Tools | Agent::ReaderMap(_) | Agent::NearestRoom => {
                    read()
                }
                Agent::Random(_) => unread(RANDOM_WALKS),
                Agent::Straight(_) | Agent::Oracle => unread(1),
            };
            places.into_iter().map(|(set, index)| (agent.name(), set, index)).collect::<Vec<_>>()
        };
        self.agents.iter().flat_map(of_agent).collect()
    }

    /// Makes every agent's walks for an item, in the order of agents, sets and texts.
    ///
    /// # Errors
    /// When a view cannot be had, or a model fails.
    pub(super) fn walks(&self, item: &Item) -> Result<Vec<Walk>, WalkError> {
        let directions = self.directions(item)?;
        let look_with =
            |grounder| AgentView::new(self.platform, grounder, self.grounders.need_pictures, &item.start.scene);
        let (views, boxes) = (look_with(self.grounders.views.as_ref())?, look_with(self.grounders.boxes.as_ref())?);
        let mut walks = Vec::new();
        for agent in self.agents {
            let mut add = |text: &Text, directions, walked| walks.push(walk(agent, item, text, directions, walked));
            match agent {
                Agent::Phrases { parameters, by_detector, .. } => {
                    let agent_view = if *by_detector { &boxes } else { &views };
                    for text in agent.texts(item) {
                        let directions = &directions[text.text.as_str()];
                        let walked = walk_by_phrases(agent_view, &item.start, directions, parameters)?;
                        add(text, Some(directions.clone()), walked);
                    }
                }
                Agent::Reader(threshold) => {
                    for text in agent.texts(item) {
                        let things = threshold.map_or(Things::Labels, |least| Things::named_in(&text.text, least));
                        add(text, None, walk_by_reading(&views, &item.start, &text.text, &things)?);
                    }
                }
                Agent::Tools => {
                    for (text, walked) in self.by_tools(agent, item)? {
                        add(text, None, walked);
                    }
                }
                Agent::ReaderMap(prior) => {
                    let graph = self.platform.graph(&item.start.scene)?;
                    let scene = &item.start.scene;
                    let survey = || Ok::<_, PlatformError>(Surveyed::of(&survey(self.platform, scene)?));
                    let known = self.surveys.get_or_make(scene.clone(), survey)?;
                    let reader = MapReader::new(&graph, &known, &item.start, *prior)?;
                    agent.texts(item).for_each(|text| add(text, None, reader.walk(&text.text)));
                }
                Agent::NearestRoom => {
                    for text in agent.texts(item) {
                        let walked = nearest_room(self.platform, &item.start, last_room_in(&text.text).as_deref())?;
                        add(text, None, walked);
                    }
                }
                Agent::Random(_) | Agent::Straight(_) | Agent::Oracle => walks.extend(self.blind(agent, item)?),
            }
        }
        Ok(walks)
    }

    /// Makes the walks of the agent `tools`, several at a time.
    fn by_tools<'i>(&self, agent: &Agent, item: &'i Item) -> Result<Vec<(&'i Text, Walked)>, WalkError> {
        let Some(toolbox) = self.toolbox else { return Ok(Vec::new()) };
        let (grounder, scene) = (self.grounders.views.as_ref(), &item.start.scene);
        let agent_view =
            AgentView::new(self.platform, grounder, toolbox.needs_pictures() || self.grounders.need_pictures, scene)?;
        let names_object = item.episode.target_object.is_some();
        let walk = |text: &&'i Text| {
            walk_by_tools(&agent_view, &item.start, &text.text, names_object, toolbox.walker())
                .map(|walked| (*text, walked))
        };
        let texts: Vec<&Text> = agent.texts(item).collect();
        at_once(&texts, toolbox.at_once, walk, |walked| walked.as_ref().is_err_and(WalkError::ends_run))
            .into_iter()
            .collect()
    }

    /// Splits into phrases each text that an agent follows phrase by phrase, once for all of these agents.
    fn directions<'i>(&self, item: &'i Item) -> Result<BTreeMap<&'i str, Directions>, WalkError> {
        let by_phrases = self.agents.iter().find(|agent| matches!(agent, Agent::Phrases { .. }));
        let texts = by_phrases.into_iter().flat_map(|agent| agent.texts(item));
        let mut texts: Vec<&str> = texts.map(|text| text.text.as_str()).collect();
        texts.sort_unstable();
        texts.dedup();
        let parts = self.splitter.split(&texts).into_iter().collect::<Result<Vec<_>, _>>()?;
        Ok(texts.into_iter().zip(parts).collect())
    }

    /// Makes the walks of an agent that reads no instruction.
    fn blind(&self, agent: &Agent, item: &Item) -> Result<Vec<Walk>, WalkError> {
        let graph = self.platform.graph(&item.start.scene)?;
        let goal = &item.episode.viewpoints[item.episode.viewpoints.len() - 1];
        let unread = |index| Text { set: UNREAD.to_owned(), index, text: String::new(), purpose: Purpose::Set };
        let one = |walked| vec![walk(agent, item, &unread(0), None, walked)];
        Ok(match agent {
            Agent::Random(hops) => {
                let draw = |index: usize| {
                    let mut rng =
                        rng(self.seed, &["random walk", &item.episode.id, &hops.to_string(), &index.to_string()]);
                    walk(agent, item, &unread(index), None, random(&graph, &item.start, *hops, &mut rng))
                };
                (0..RANDOM_WALKS).map(draw).collect()
            }
            Agent::Straight(hops) => one(straight(&graph, &item.start, *hops)),
            _ => one(oracle(&graph, &item.start, goal)?),
        })
    }
}

fn walk(agent: &Agent, item: &Item, text: &Text, directions: Option<Directions>, walked: Walked) -> Walk {
    Walk {
        agent: agent.name(),
        set: text.set.clone(),
        item: item.episode.id.clone(),
        text_index: text.index,
        text: text.text.clone(),
        scene: item.start.scene.clone(),
        directions,
        steps: walked.steps,
        end: walked.end,
        object: walked.object,
        effort: walked.effort,
    }
}
