//! Scores the walks of a comparison, and makes the comparison of their figures.

use super::{
    agents::WalkingAgent,
    file,
    instruction_sets::ComparisonItem,
    make_walks::ItemWalkMaker,
    settings::{ComparisonSettings, last_part},
    thresholds::{READER_AGENT_NAME, TOOLS_AGENT_NAME},
};
use crate::{demands::PlatformDemands, episodes};
use std::{collections::BTreeMap, path::Path, sync::Arc};
use wayword_metrics::{
    AgentTrajectory, EpisodeDemand, SceneDistances, TrajectoryMetric, TrajectoryScore, TrajectorySuccessRule,
    score_trajectory,
};
use wayword_navigation::{
    agents::PhraseWalkParameters,
    comparison::{AgentComparison, ComparedAgent, ComparisonInfo, InstructionSet, WalkScores, compare_agents},
    walk::AgentWalkRecord,
};
use wayword_robustness::sets::FollowResult;
use wayword_run::{error::CommandError, run_folder::lines};

/// Level of the intervals.
const CONFIDENCE_LEVEL: f64 = 0.95;

/// Scores walks against the paths of their items.
pub(super) struct WalkJudge<'a> {
    /// For each item, the distances of its scene, and what a walk has to reach.
    demands: BTreeMap<&'a str, (Arc<SceneDistances>, EpisodeDemand)>,
    /// For each item, the name of its path. Intervals are clustered by path.
    clusters: BTreeMap<&'a str, String>,
    /// What counts as success.
    pub(super) rule: TrajectorySuccessRule,
    /// Whether agents that walk by phrases can name an object at all, and whether the agent `tools` can.
    name_objects: [bool; 2],
    /// The first item without a target object of known place. Such an item can only be judged by distance.
    pub(super) without_object: Option<&'a str>,
}

impl<'a> WalkJudge<'a> {
    /// Prepares to judge these items by the given rule. Without one, success means that the target is visible, if every item has
    /// a target object, and otherwise that the goal is near.
    ///
    /// # Errors
    /// When a scene cannot be read, or the rule cannot be applied.
    pub(super) fn new(
        config: &ComparisonSettings,
        items: &'a [ComparisonItem],
        platform_demands: &PlatformDemands<'_>,
        rule: Option<TrajectorySuccessRule>,
    ) -> Result<Self, CommandError> {
        let mut demands = BTreeMap::new();
        for item in items {
            let (distances, demand) = platform_demands.for_episode(&item.episode)?;
            if let Some(unknown) = demand.reference.iter().find(|viewpoint| !distances.has_viewpoint(viewpoint)) {
                let (file, id) = (config.episodes.display(), &item.episode.id);
                let problem = format!("{file}: episode {id}: scene {} has no viewpoint {unknown}", item.episode.scene);
                return Err(CommandError::usage(problem, "use episodes and viewpoint graphs of the same release"));
            }
            demands.insert(item.episode.id.as_str(), (distances, demand));
        }
        let item_without_object = items.iter().find(|item| demands[item.episode.id.as_str()].1.visible_from.is_none());
        let rule = match (rule, item_without_object) {
            (Some(TrajectorySuccessRule::Visible), Some(item_without_object)) => {
                let problem = format!(
                    "--rule visible: item {} names no object whose place is known",
                    item_without_object.episode.id
                );
                return Err(CommandError::usage(problem, "judge by distance with --rule distance"));
            }
            (Some(rule), _) => rule,
            (None, Some(_)) => TrajectorySuccessRule::Distance,
            (None, None) => TrajectorySuccessRule::Visible,
        };
        let clusters =
            items.iter().map(|item| (item.episode.id.as_str(), episodes::episode_path_name(&item.episode))).collect();
        // Labels name objects, and boxes point to them; a grounder that compares whole pictures does neither.
        let grounder_names = config.grounder.starts_with("labels") || config.detects_views();
        let is_shown_labels = config.tools.as_ref().is_some_and(|tools| tools.see.are_labels());
        let name_objects = [grounder_names, grounder_names || is_shown_labels];
        let without_object = item_without_object.map(|item| item.episode.id.as_str());
        Ok(Self { demands, clusters, rule, name_objects, without_object })
    }

    /// Calls `take` with every walk of a folder, its score and the demand of its item.
    ///
    /// # Errors
    /// When the walks cannot be read, or one leaves the graph of its scene.
    pub(super) fn for_each_walk(
        &self,
        folder: &Path,
        mut take: impl FnMut(AgentWalkRecord, TrajectoryScore, &EpisodeDemand) -> Result<(), CommandError>,
    ) -> Result<(), CommandError> {
        lines::each_line(&folder.join(file::WALKS), |line| {
            let walk: AgentWalkRecord = line.parse()?;
            // The folder can contain walks of more items, if the user lowered the limit in config.toml.
            let Some((distances, demand)) = self.demands.get(walk.item.as_str()) else { return Ok(()) };
            let viewpoints = walk.steps.iter().map(|step| step.viewpoint.clone()).collect();
            let trajectory = AgentTrajectory { viewpoints, object: walk.object.clone() };
            let mut score = score_trajectory(distances, demand, &trajectory).map_err(|problems| {
                let problems: Vec<String> = problems.iter().map(ToString::to_string).collect();
                line.broken_line(problems.join("; "))
            })?;
            let [by_phrases, by_tools] = self.name_objects;
            let can_name =
                if walk.agent == TOOLS_AGENT_NAME { by_tools } else { by_phrases && walk.directions.is_some() };
            if !can_name {
                score.grounding = None;
            }
            take(walk, score, demand)
        })
    }

    /// The success of a walk; `None` if the rule does not apply to it.
    pub(super) fn follow_result(&self, walk: &AgentWalkRecord, score: &TrajectoryScore) -> Option<FollowResult> {
        Some(FollowResult {
            agent: walk.agent.clone(),
            set: walk.set.clone(),
            scene: walk.scene.to_string(),
            path: self.path_of_item(&walk.item).to_owned(),
            item: walk.item.clone(),
            text_index: walk.text_index,
            success: score.get(TrajectoryMetric::SuccessRate, self.rule)?,
        })
    }

    /// The name of an item's path. Intervals are clustered by it.
    pub(super) fn path_of_item(&self, item: &str) -> &str {
        self.clusters.get(item).map_or("", String::as_str)
    }
}

/// Compares agents and sets by the results of all walks.
pub(super) fn build_comparison(
    config: &ComparisonSettings,
    walk_maker: &ItemWalkMaker<'_>,
    sets: Vec<InstructionSet>,
    judge: &WalkJudge<'_>,
    results: &WalkScores,
    (resamples, failed): (usize, usize),
) -> AgentComparison {
    let (items, paths) = results.count_items_and_paths();
    let about = ComparisonInfo {
        platform: config.platform.clone(),
        episodes: last_part(&config.episodes.to_string_lossy()),
        grounder: walk_maker.grounders.views.name().to_owned(),
        detector: walk_maker.grounders.boxes.name().to_owned(),
        detector_score: walk_maker.grounders.score.clone(),
        encoder: config.encoder.clone(),
        splitter: walk_maker.splitter.name().to_owned(),
        tools: config.tools.as_ref().map(|tools| (tools.llm.clone(), tools.see.to_string())),
        rule: judge.rule,
        level: CONFIDENCE_LEVEL,
        resamples,
        seed: config.seed,
        items,
        paths,
        failed,
        swept: is_swept(config),
        prior: config.prior.clone(),
        parameters: named_parameters(config),
        wayword: env!("CARGO_PKG_VERSION").to_owned(),
    };
    let walkers: Vec<ComparedAgent> = walk_maker.agents.iter().map(WalkingAgent::as_compared_agent).collect();
    compare_agents(about, sets, &walkers, &config.swaps, results)
}

/// The agents' parameters, by agent and name.
fn named_parameters(config: &ComparisonSettings) -> BTreeMap<String, BTreeMap<String, String>> {
    let of_phrases = config.parameters.iter().map(|(agent, parameters)| (agent.clone(), parameters.by_name()));
    let threshold_by_name = |threshold: f32| BTreeMap::from([("phrase_threshold".to_owned(), threshold.to_string())]);
    let of_tools = config.tools.as_ref().map(|tools| (TOOLS_AGENT_NAME.to_owned(), tools.limits.by_name()));
    of_phrases
        .chain(of_tools)
        .chain(config.reader_threshold.map(|threshold| (READER_AGENT_NAME.to_owned(), threshold_by_name(threshold))))
        .collect()
}

/// Whether the agents use thresholds that were chosen for their grounder.
fn is_swept(config: &ComparisonSettings) -> bool {
    let has_sweep =
        config.grounder == "labels/lexical" || config.encoder.as_deref().is_some_and(|encoder| encoder != "words");
    let is_default = |(agent, parameters): (&String, &PhraseWalkParameters)| {
        *parameters == PhraseWalkParameters::default_of(agent, &config.grounder)
    };
    config.detector.is_none() && has_sweep && config.parameters.iter().all(is_default)
}
