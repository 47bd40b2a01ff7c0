//! Computes the table of a comparison from the scores of walks: means over items, intervals clustered by path, differences item by
//! item, and the swap tests.

use super::{
    AgentComparison, AgentKind, ComparisonInfo, ComparisonRow, EffortSummary, InstructionSet, ListeningVerdict,
    MIN_PATHS, RowDifference, SwapEffect, WalkScores, results::TextsByItem,
};
use crate::swap::InstructionSwap;
use std::collections::BTreeMap;
use wayword_metrics::{McNemar, MeanEstimate, TrajectoryMetric, clustered_interval};

/// The name under which walks by the swapped texts of a set are recorded.
#[must_use]
pub fn swapped_set(set: &str, swap: InstructionSwap) -> String {
    format!("{set}~{}", swap.name())
}

/// The name under which walks by an empty text, instead of a set's texts, are recorded.
#[must_use]
pub fn empty_set(set: &str) -> String {
    format!("{set}~{EMPTY_SET_SUFFIX}")
}

/// The part after `~` in the name that [`empty_set`] gives. Swapped sets have the swap's name there.
pub const EMPTY_SET_SUFFIX: &str = "empty";

/// The set name under which walks of agents that do not read are recorded.
pub const UNREAD_SET_NAME: &str = "none";

/// An agent of a comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ComparedAgent {
    /// Its name.
    pub name: String,
    /// What kind it is.
    pub kind: AgentKind,
    /// Whether it reads instructions.
    pub reads: bool,
    /// Whether the agent's knowledge may lead it to the goal without its instruction. Then it has two more rows as lower bounds: by
    /// an empty text, and by the text of another path.
    pub has_extra_rows: bool,
}

impl ComparedAgent {
    /// Whether swap tests are meaningful for it: either it can find the goal only by reading, or its two extra rows show what it
    /// reaches without reading.
    fn takes_swap_tests(&self) -> bool {
        self.kind == AgentKind::Agent || self.has_extra_rows
    }
}

/// Computes the table. Swap tests use the first set.
#[must_use]
pub fn compare_agents(
    about: ComparisonInfo,
    sets: Vec<InstructionSet>,
    walkers: &[ComparedAgent],
    swaps: &[InstructionSwap],
    results: &WalkScores,
) -> AgentComparison {
    let table = TableBuilder { about: &about, results };
    let mut rows = Vec::new();
    for walker in walkers {
        if walker.reads {
            rows.extend(sets.iter().enumerate().map(|(at, set)| {
                let first = sets.first().filter(|_| at > 0);
                table.comparison_row(walker, Some(&set.name), first.map(|first| first.name.as_str()))
            }));
            if let Some(first) = sets.first().filter(|_| walker.has_extra_rows) {
                let extra_sets = [empty_set(&first.name), swapped_set(&first.name, InstructionSwap::OtherPath)];
                rows.extend(extra_sets.iter().map(|set| table.comparison_row(walker, Some(set), None)));
            }
        } else {
            rows.push(table.comparison_row(walker, None, None));
        }
    }
    let mut swapped = Vec::new();
    if let Some(first) = sets.first() {
        for walker in walkers.iter().filter(|walker| walker.takes_swap_tests()) {
            swapped.extend(swaps.iter().map(|swap| table.swap_effect(walker, &first.name, *swap)));
        }
    }
    AgentComparison { about, sets, rows, swaps: swapped }
}

/// Computes the parts of a table.
struct TableBuilder<'a> {
    about: &'a ComparisonInfo,
    results: &'a WalkScores,
}

impl TableBuilder<'_> {
    /// The row of an agent and a set (`None` for an agent that does not read), and its difference from the set `first`, if given.
    fn comparison_row(&self, walker: &ComparedAgent, set: Option<&str>, first: Option<&str>) -> ComparisonRow {
        let recorded = set.unwrap_or(UNREAD_SET_NAME);
        let against = |first: &str| self.row_difference(&walker.name, (recorded, None), (first, None));
        let efforts = self.results.walk_efforts(&walker.name, recorded);
        ComparisonRow {
            agent: walker.name.clone(),
            kind: walker.kind,
            set: set.map(str::to_owned),
            figures: self.mean_figures(&walker.name, recorded, None),
            against_first: first.map(against),
            effort: efforts
                .and_then(|efforts| EffortSummary::from_efforts(efforts, |by_item| self.estimate_mean(&by_item))),
        }
    }

    /// The effect of a swap of the set `first` on an agent, from the texts that the swap changed.
    fn swap_effect(&self, walker: &ComparedAgent, first: &str, swap: InstructionSwap) -> SwapEffect {
        let set = swapped_set(first, swap);
        let texts = self.results.texts_walked(&walker.name, &set);
        let lost = self.row_difference(&walker.name, (first, Some(&texts)), (&set, None));
        let listening = match lost.figures.get(&TrajectoryMetric::SuccessRate) {
            Some(lost) if lost.clusters >= MIN_PATHS && lost.low > 0.0 => ListeningVerdict::Shown,
            Some(lost) if lost.clusters >= MIN_PATHS => ListeningVerdict::NotShown,
            _ => ListeningVerdict::TooFew,
        };
        let count = |texts: &TextsByItem| texts.values().map(|texts| texts.len()).sum();
        SwapEffect {
            agent: walker.name.clone(),
            swap,
            changed: count(&texts),
            texts: count(&self.results.texts_walked(&walker.name, first)),
            figures: self.mean_figures(&walker.name, &set, None),
            lost,
            listening,
        }
    }

    /// The figures of an agent by a set, over all its texts or those in `only`.
    fn mean_figures(
        &self,
        agent: &str,
        set: &str,
        only: Option<&TextsByItem>,
    ) -> BTreeMap<TrajectoryMetric, MeanEstimate> {
        self.estimate_metrics(|metric| self.results.figures_by_item(agent, set, metric, self.about.rule, only))
    }

    /// The first set minus the second, on the items that have a figure in both.
    fn row_difference(
        &self,
        agent: &str,
        (first, only_first): (&str, Option<&TextsByItem>),
        (second, only_second): (&str, Option<&TextsByItem>),
    ) -> RowDifference {
        let rule = self.about.rule;
        let figures = self.estimate_metrics(|metric| {
            let second = self.results.figures_by_item(agent, second, metric, rule, only_second);
            let first = self.results.figures_by_item(agent, first, metric, rule, only_first);
            first.into_iter().filter_map(|(item, figure)| Some((item, figure - second.get(item)?))).collect()
        });
        let second = self.results.first_successes(agent, second, rule, only_second);
        let first = self.results.first_successes(agent, first, rule, only_first);
        let pairs = first.iter().filter_map(|(item, first)| Some((*first, *second.get(item)?)));
        RowDifference { figures, mcnemar: McNemar::from_pairs(pairs) }
    }

    /// Each metric's mean with its interval. `figures` gives a metric's figure for each item.
    fn estimate_metrics<'r>(
        &self,
        figures: impl Fn(TrajectoryMetric) -> BTreeMap<&'r str, f64>,
    ) -> BTreeMap<TrajectoryMetric, MeanEstimate>
    where
        Self: 'r,
    {
        let estimate = |metric| Some((metric, self.estimate_mean(&figures(metric))?));
        TrajectoryMetric::ALL.into_iter().filter_map(estimate).collect()
    }

    /// The mean of items' figures, with its interval clustered by path.
    fn estimate_mean(&self, by_item: &BTreeMap<&str, f64>) -> Option<MeanEstimate> {
        let values: Vec<(&str, f64)> =
            by_item.iter().map(|(item, figure)| (self.results.item_cluster(item), *figure)).collect();
        let ComparisonInfo { resamples, level, seed, .. } = *self.about;
        clustered_interval(&values, resamples, level, seed)
    }
}
