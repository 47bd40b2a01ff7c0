//! Scores the walks of a comparison, and makes the comparison of their figures.

use super::{
    agents::{Agent, READER, TOOLS},
    file,
    kept::{Kept, last_part},
    make::Crew,
    sets::Item,
};
use crate::{demands::Demands, episodes};
use std::{collections::BTreeMap, path::Path, sync::Arc};
use wayword_metrics::{Demand, Distances, Metric, Rule, Score, Trajectory, score};
use wayword_navigation::{
    agents::Parameters,
    comparison::{About, Comparison, Results, Set, Walker, compare},
    walk::Walk,
};
use wayword_robustness::sets::Followed;
use wayword_run::{error::Error, run_folder::lines, settings::LABELS};

/// Level of the intervals.
const LEVEL: f64 = 0.95;

/// Scores walks against the paths of their items.
pub(super) struct Judge<'a> {
    /// For each item, the distances of its scene, and what a walk has to reach.
    demands: BTreeMap<&'a str, (Arc<Distances>, Demand)>,
    clusters: BTreeMap<&'a str, String>,
    /// What counts as success.
    pub(super) rule: Rule,
    /// Whether agents that walk by phrases can name an object at all, and whether the agent by a language model can.
    name_objects: [bool; 2],
    /// The first item without a target object of known place. Such an item can only be judged by distance.
    pub(super) without_object: Option<&'a str>,
}

impl<'a> Judge<'a> {
    /// Prepares to judge these items by the given rule. Without one, success means that the target is visible, if every item has
    /// a target object, and otherwise that the goal is near.
    ///
    /// # Errors
    /// When a scene cannot be read, or the rule cannot be applied.
    pub(super) fn new(kept: &Kept, items: &'a [Item], all: &Demands<'_>, rule: Option<Rule>) -> Result<Self, Error> {
        let mut demands = BTreeMap::new();
        for item in items {
            let (distances, demand) = all.of(&item.episode)?;
            if let Some(unknown) = demand.reference.iter().find(|viewpoint| !distances.has(viewpoint)) {
                let (file, id) = (kept.episodes.display(), &item.episode.id);
                let problem = format!("{file}: episode {id}: scene {} has no viewpoint {unknown}", item.episode.scene);
                return Err(Error::usage(problem, "use episodes and viewpoint graphs of the same release"));
            }
            demands.insert(item.episode.id.as_str(), (distances, demand));
        }
        let blind = items.iter().find(|item| demands[item.episode.id.as_str()].1.visible_from.is_none());
        let rule = match (rule, blind) {
            (Some(Rule::Visible), Some(blind)) => {
                let problem = format!("--rule visible: item {} names no object whose place is known", blind.episode.id);
                return Err(Error::usage(problem, "judge by distance with --rule distance"));
            }
            (Some(rule), _) => rule,
            (None, Some(_)) => Rule::Distance,
            (None, None) => Rule::Visible,
        };
        let clusters = items.iter().map(|item| (item.episode.id.as_str(), episodes::cluster(&item.episode))).collect();
        // Labels name objects, and boxes point to them; a grounder that compares whole pictures does neither.
        let grounder_names = kept.grounder.starts_with("labels") || kept.detects_views();
        let is_shown_names = kept.tools.as_ref().is_some_and(|tools| tools.see == LABELS);
        let name_objects = [grounder_names, grounder_names || is_shown_names];
        let without_object = blind.map(|item| item.episode.id.as_str());
        Ok(Self { demands, clusters, rule, name_objects, without_object })
    }

    /// Calls `take` with every walk of a folder, its score and the demand of its item.
    ///
    /// # Errors
    /// When the walks cannot be read, or one leaves the graph of its scene.
    pub(super) fn each(
        &self,
        folder: &Path,
        mut take: impl FnMut(Walk, Score, &Demand) -> Result<(), Error>,
    ) -> Result<(), Error> {
        lines::each(&folder.join(file::WALKS), |line| {
            let walk: Walk = line.parse()?;
            // The folder can contain walks of more items, if the user lowered the limit in config.toml.
            let Some((distances, demand)) = self.demands.get(walk.item.as_str()) else { return Ok(()) };
            let viewpoints = walk.steps.iter().map(|step| step.viewpoint.clone()).collect();
            let trajectory = Trajectory { viewpoints, object: walk.object.clone() };
            let mut score = score(distances, demand, &trajectory).map_err(|problems| {
                let problems: Vec<String> = problems.iter().map(ToString::to_string).collect();
                line.broken(problems.join("; "))
            })?;
            let [by_phrases, by_tools] = self.name_objects;
            let can_name = if walk.agent == TOOLS { by_tools } else { by_phrases && walk.directions.is_some() };
            if !can_name {
                score.grounding = None;
            }
            take(walk, score, demand)
        })
    }

    /// The success of a walk; `None` if the rule does not apply to it.
    pub(super) fn followed(&self, walk: &Walk, score: &Score) -> Option<Followed> {
        Some(Followed {
            agent: walk.agent.clone(),
            set: walk.set.clone(),
            scene: walk.scene.to_string(),
            path: self.cluster(&walk.item).to_owned(),
            item: walk.item.clone(),
            text_index: walk.text_index,
            success: score.get(Metric::SuccessRate, self.rule)?,
        })
    }

    /// The name of an item's path. Intervals are clustered by it.
    pub(super) fn cluster(&self, item: &str) -> &str {
        self.clusters.get(item).map_or("", String::as_str)
    }
}

/// Compares agents and sets by the results of all walks.
pub(super) fn comparison(
    kept: &Kept,
    crew: &Crew<'_>,
    sets: Vec<Set>,
    judge: &Judge<'_>,
    results: &Results,
    (resamples, failed): (usize, usize),
) -> Comparison {
    let (items, paths) = results.extent();
    let about = About {
        platform: kept.platform.clone(),
        episodes: last_part(&kept.episodes.to_string_lossy()),
        grounder: crew.grounders.views.name().to_owned(),
        detector: crew.grounders.boxes.name().to_owned(),
        detector_score: crew.grounders.score.clone(),
        encoder: kept.encoder.clone(),
        splitter: crew.splitter.name().to_owned(),
        tools: kept.tools.as_ref().map(|tools| (tools.llm.clone(), tools.see.clone())),
        rule: judge.rule,
        level: LEVEL,
        resamples,
        seed: kept.seed,
        items,
        paths,
        failed,
        swept: is_swept(kept),
        prior: kept.prior.clone(),
        parameters: parameters(kept),
        wayword: env!("CARGO_PKG_VERSION").to_owned(),
    };
    let walkers: Vec<Walker> = crew.agents.iter().map(Agent::walker).collect();
    compare(about, sets, &walkers, &kept.swaps, results)
}

/// The agents' parameters, by agent and name.
fn parameters(kept: &Kept) -> BTreeMap<String, BTreeMap<String, String>> {
    let of_phrases = kept.parameters.iter().map(|(agent, of)| (agent.clone(), of.named()));
    let named = |least: f32| BTreeMap::from([("phrase_threshold".to_owned(), least.to_string())]);
    let of_tools = kept.tools.as_ref().map(|tools| (TOOLS.to_owned(), tools.limits.named()));
    of_phrases.chain(of_tools).chain(kept.reader_threshold.map(|least| (READER.to_owned(), named(least)))).collect()
}

/// Whether the agents use thresholds that were chosen for their grounder.
fn is_swept(kept: &Kept) -> bool {
    let has_sweep =
        kept.grounder == "labels/lexical" || kept.encoder.as_deref().is_some_and(|encoder| encoder != "words");
    let is_default = |(agent, of): (&String, &Parameters)| *of == Parameters::default_of(agent, &kept.grounder);
    kept.detector.is_none() && has_sweep && kept.parameters.iter().all(is_default)
}
