//! Collects the scores and the efforts of walks by agent, set, item and text, for the table to average.

use super::effort_summary::{EffortsByItem, RecordedEffort};
use std::collections::{BTreeMap, BTreeSet};
use wayword_metrics::{TrajectoryMetric, TrajectoryScore, TrajectorySuccessRule};

/// The scores of one agent on one set: by item, then by the text's index in its set.
type ScoresByItem = BTreeMap<String, BTreeMap<usize, TrajectoryScore>>;

/// All scores of a comparison.
#[derive(Debug, Clone, Default)]
pub struct WalkScores {
    /// The scores of all walks, by agent and set.
    scores: BTreeMap<(String, String), ScoresByItem>,
    /// The efforts of walks in which a language model decided, by agent and set.
    efforts: BTreeMap<(String, String), EffortsByItem>,
    /// The path of each item. Items on one path are not independent, so intervals are clustered by path.
    clusters: BTreeMap<String, String>,
}

/// Indices of texts in a set, by item.
pub(super) type TextsByItem = BTreeMap<String, BTreeSet<usize>>;

impl WalkScores {
    /// Adds the score of a walk. `cluster` is the item's path.
    pub fn add_walk(&mut self, walk: &crate::walk::AgentWalkRecord, cluster: &str, score: TrajectoryScore) {
        let scores = self.scores.entry((walk.agent.clone(), walk.set.clone())).or_default();
        scores.entry(walk.item.clone()).or_default().insert(walk.text_index, score);
        if let Some(effort) = RecordedEffort::from_walk(walk) {
            let all = self.efforts.entry((walk.agent.clone(), walk.set.clone())).or_default();
            all.entry(walk.item.clone()).or_default().insert(walk.text_index, effort);
        }
        self.clusters.entry(walk.item.clone()).or_insert_with(|| cluster.to_owned());
    }

    /// How many items were walked, and on how many paths they lie.
    #[must_use]
    pub fn count_items_and_paths(&self) -> (usize, usize) {
        (self.clusters.len(), self.clusters.values().collect::<BTreeSet<_>>().len())
    }

    /// Whether an item was walked.
    #[must_use]
    pub fn has_item(&self, item: &str) -> bool {
        self.clusters.contains_key(item)
    }

    /// The texts of a set by which an agent walked.
    pub(super) fn texts_walked(&self, agent: &str, set: &str) -> TextsByItem {
        let scores = self.scores_for_set(agent, set).into_iter().flatten();
        scores.map(|(item, texts)| (item.clone(), texts.keys().copied().collect())).collect()
    }

    /// An agent's figure for each item: the mean over the item's texts, or over those in `only`.
    pub(super) fn figures_by_item(
        &self,
        agent: &str,
        set: &str,
        metric: TrajectoryMetric,
        rule: TrajectorySuccessRule,
        only: Option<&TextsByItem>,
    ) -> BTreeMap<&str, f64> {
        let scores = self.scores_for_set(agent, set).into_iter().flatten();
        let is_wanted =
            |item: &str, text: &usize| only.is_none_or(|only| only.get(item).is_some_and(|texts| texts.contains(text)));
        let mean_figure = |(item, texts): (&'_ String, &BTreeMap<usize, TrajectoryScore>)| {
            let texts = texts.iter().filter(|(text, _)| is_wanted(item, text));
            let figures: Vec<f64> = texts.filter_map(|(_, score)| score.get(metric, rule)).collect();
            (!figures.is_empty()).then(|| figures.iter().sum::<f64>() / figures.len() as f64)
        };
        scores.filter_map(|entry| Some((entry.0.as_str(), mean_figure(entry)?))).collect()
    }

    /// Whether an agent succeeds by the first text of each item, or by the first of those in `only`.
    pub(super) fn first_successes(
        &self,
        agent: &str,
        set: &str,
        rule: TrajectorySuccessRule,
        only: Option<&TextsByItem>,
    ) -> BTreeMap<&str, bool> {
        let scores = self.scores_for_set(agent, set).into_iter().flatten();
        let first = |(item, texts): (&'_ String, &BTreeMap<usize, TrajectoryScore>)| {
            let at = match only {
                Some(only) => *only.get(item)?.first()?,
                None => *texts.first_key_value()?.0,
            };
            texts.get(&at)?.get(TrajectoryMetric::SuccessRate, rule).map(|success| success > 0.5)
        };
        scores.filter_map(|entry| Some((entry.0.as_str(), first(entry)?))).collect()
    }

    /// The path of an item.
    pub(super) fn item_cluster(&self, item: &str) -> &str {
        self.clusters.get(item).map_or("", String::as_str)
    }

    /// The efforts of an agent's walks by a set; `None` if no language model decided.
    pub(super) fn walk_efforts(&self, agent: &str, set: &str) -> Option<&EffortsByItem> {
        self.efforts.get(&(agent.to_owned(), set.to_owned()))
    }

    fn scores_for_set(&self, agent: &str, set: &str) -> Option<&ScoresByItem> {
        self.scores.get(&(agent.to_owned(), set.to_owned()))
    }
}
