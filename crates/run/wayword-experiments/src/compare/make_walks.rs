//! Makes all walks of one item: every agent walks by every text that is meant for it.

use super::{
    agents::{RANDOM_WALKS, WalkingAgent},
    grounders::ComparisonGrounders,
    instruction_sets::{ComparisonItem, ComparisonText, TextPurpose},
    tools::AgentToolbox,
};
use std::collections::BTreeMap;
use wayword_core::{Platform, PlatformError, RecentCache, SceneId, seeded_rng};
use wayword_navigation::{
    AgentView, ThingSource, WalkError,
    agents::{
        AgentWalk, MapReader, MappedScene, last_room_in, walk_by_phrases, walk_by_reading, walk_by_tools,
        walk_randomly, walk_shortest_path, walk_straight, walk_to_nearest_room,
    },
    comparison::UNREAD_SET_NAME,
    directions::{InstructionSplitter, SplitInstruction},
    walk::AgentWalkRecord,
};
use wayword_run::parallel::make_in_parallel;
use wayword_world::survey_scene;

/// Makes the walks of items with the agents and models of a comparison.
pub(super) struct ItemWalkMaker<'a> {
    pub(super) platform: &'a dyn Platform,
    pub(super) grounders: &'a ComparisonGrounders,
    /// Splits instructions into phrases, for the agents that walk by phrases.
    pub(super) splitter: &'a dyn InstructionSplitter,
    pub(super) agents: &'a [WalkingAgent],
    /// The agent `tools` with its model, if it takes part.
    pub(super) toolbox: Option<&'a AgentToolbox>,
    /// The agent `reader-map` gets these maps of scenes; those of the last scenes are kept.
    pub(super) surveys: &'a RecentCache<SceneId, MappedScene>,
    pub(super) seed: u64,
}

impl WalkingAgent {
    /// The texts of an item that this agent walks by.
    pub(super) fn texts_of_item<'i>(&self, item: &'i ComparisonItem) -> impl Iterator<Item = &'i ComparisonText> {
        // The purposes are in order: an agent walks by the texts of all purposes up to this one.
        let last = match self {
            Self::ReaderMap(_) => TextPurpose::Floor,
            Self::NearestRoom => TextPurpose::Set,
            _ => TextPurpose::Swap,
        };
        item.texts.iter().filter(move |text| text.purpose <= last)
    }
}

impl ItemWalkMaker<'_> {
    /// The agent, the set and the index of the text of every walk of an item, in the order in which the walks are made.
    pub(super) fn walk_names(&self, item: &ComparisonItem) -> Vec<(String, String, usize)> {
        let names_for_agent = |agent: &WalkingAgent| {
            let read = || agent.texts_of_item(item).map(|text| (text.set.clone(), text.index)).collect();
            let unread = |count| (0..count).map(|index| (UNREAD_SET_NAME.to_owned(), index)).collect::<Vec<_>>();
            let walks = match agent {
                WalkingAgent::Phrases { .. }
                | WalkingAgent::Reader(_)
                | WalkingAgent::Tools
                | WalkingAgent::ReaderMap(_)
                | WalkingAgent::NearestRoom => read(),
                WalkingAgent::Random(_) => unread(RANDOM_WALKS),
                WalkingAgent::Straight(_) | WalkingAgent::Oracle => unread(1),
            };
            walks.into_iter().map(|(set, index)| (agent.name(), set, index)).collect::<Vec<_>>()
        };
        self.agents.iter().flat_map(names_for_agent).collect()
    }

    /// Makes every agent's walks for an item, in the order of agents, sets and texts.
    ///
    /// # Errors
    /// When a view cannot be had, or a model fails.
    pub(super) fn make_walks(&self, item: &ComparisonItem) -> Result<Vec<AgentWalkRecord>, WalkError> {
        let directions = self.split_texts(item)?;
        let look_with =
            |grounder| AgentView::new(self.platform, grounder, self.grounders.need_pictures, &item.start.scene);
        let (views, boxes) = (look_with(self.grounders.views.as_ref())?, look_with(self.grounders.boxes.as_ref())?);
        let mut walks = Vec::new();
        for agent in self.agents {
            let mut add = |text: &ComparisonText, directions, walked| {
                walks.push(walk_record(agent, item, text, directions, walked));
            };
            match agent {
                WalkingAgent::Phrases { parameters, by_detector, .. } => {
                    let agent_view = if *by_detector { &boxes } else { &views };
                    for text in agent.texts_of_item(item) {
                        let directions = &directions[text.text.as_str()];
                        let walked = walk_by_phrases(agent_view, &item.start, directions, parameters)?;
                        add(text, Some(directions.clone()), walked);
                    }
                }
                WalkingAgent::Reader(threshold) => {
                    for text in agent.texts_of_item(item) {
                        let things =
                            threshold.map_or(ThingSource::Labels, |least| ThingSource::named_in(&text.text, least));
                        add(text, None, walk_by_reading(&views, &item.start, &text.text, &things)?);
                    }
                }
                WalkingAgent::Tools => {
                    for (text, walked) in self.make_tool_walks(agent, item)? {
                        add(text, None, walked);
                    }
                }
                WalkingAgent::ReaderMap(prior) => {
                    let graph = self.platform.graph_for_scene(&item.start.scene)?;
                    let scene = &item.start.scene;
                    let survey =
                        || Ok::<_, PlatformError>(MappedScene::from_survey(&survey_scene(self.platform, scene)?));
                    let mapped_scene = self.surveys.get_or_make(scene.clone(), survey)?;
                    let reader = MapReader::new(&graph, &mapped_scene, &item.start, *prior)?;
                    agent.texts_of_item(item).for_each(|text| add(text, None, reader.best_walk(&text.text)));
                }
                WalkingAgent::NearestRoom => {
                    for text in agent.texts_of_item(item) {
                        let walked =
                            walk_to_nearest_room(self.platform, &item.start, last_room_in(&text.text).as_deref())?;
                        add(text, None, walked);
                    }
                }
                WalkingAgent::Random(_) | WalkingAgent::Straight(_) | WalkingAgent::Oracle => {
                    walks.extend(self.walk_unread(agent, item)?);
                }
            }
        }
        Ok(walks)
    }

    /// Makes the walks of the agent `tools`, several at a time.
    fn make_tool_walks<'i>(
        &self,
        agent: &WalkingAgent,
        item: &'i ComparisonItem,
    ) -> Result<Vec<(&'i ComparisonText, AgentWalk)>, WalkError> {
        let Some(toolbox) = self.toolbox else { return Ok(Vec::new()) };
        let (grounder, scene) = (self.grounders.views.as_ref(), &item.start.scene);
        let agent_view =
            AgentView::new(self.platform, grounder, toolbox.needs_pictures() || self.grounders.need_pictures, scene)?;
        let names_object = item.episode.target_object.is_some();
        let walk = |text: &&'i ComparisonText| {
            walk_by_tools(&agent_view, &item.start, &text.text, names_object, toolbox.model_walker())
                .map(|walked| (*text, walked))
        };
        let texts: Vec<&ComparisonText> = agent.texts_of_item(item).collect();
        make_in_parallel(&texts, toolbox.at_once, walk, |walked| walked.as_ref().is_err_and(WalkError::ends_run))
            .into_iter()
            .collect()
    }

    /// Splits into phrases each text that an agent follows phrase by phrase, once for all of these agents.
    fn split_texts<'i>(&self, item: &'i ComparisonItem) -> Result<BTreeMap<&'i str, SplitInstruction>, WalkError> {
        let by_phrases = self.agents.iter().find(|agent| matches!(agent, WalkingAgent::Phrases { .. }));
        let texts = by_phrases.into_iter().flat_map(|agent| agent.texts_of_item(item));
        let mut texts: Vec<&str> = texts.map(|text| text.text.as_str()).collect();
        texts.sort_unstable();
        texts.dedup();
        let parts = self.splitter.split_instructions(&texts).into_iter().collect::<Result<Vec<_>, _>>()?;
        Ok(texts.into_iter().zip(parts).collect())
    }

    /// Makes the walks of an agent that reads no instruction.
    fn walk_unread(&self, agent: &WalkingAgent, item: &ComparisonItem) -> Result<Vec<AgentWalkRecord>, WalkError> {
        let graph = self.platform.graph_for_scene(&item.start.scene)?;
        let goal = &item.episode.viewpoints[item.episode.viewpoints.len() - 1];
        let unread = |index| ComparisonText {
            set: UNREAD_SET_NAME.to_owned(),
            index,
            text: String::new(),
            purpose: TextPurpose::Set,
        };
        let only_walk = |walked| vec![walk_record(agent, item, &unread(0), None, walked)];
        Ok(match agent {
            WalkingAgent::Random(hops) => {
                let draw = |index: usize| {
                    let mut rng = seeded_rng(
                        self.seed,
                        &["random walk", &item.episode.id, &hops.to_string(), &index.to_string()],
                    );
                    walk_record(agent, item, &unread(index), None, walk_randomly(&graph, &item.start, *hops, &mut rng))
                };
                (0..RANDOM_WALKS).map(draw).collect()
            }
            WalkingAgent::Straight(hops) => only_walk(walk_straight(&graph, &item.start, *hops)),
            _ => only_walk(walk_shortest_path(&graph, &item.start, goal)?),
        })
    }
}

fn walk_record(
    agent: &WalkingAgent,
    item: &ComparisonItem,
    text: &ComparisonText,
    directions: Option<SplitInstruction>,
    walked: AgentWalk,
) -> AgentWalkRecord {
    AgentWalkRecord {
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
