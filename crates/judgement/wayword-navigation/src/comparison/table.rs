//! Computes the table of a comparison from the scores of walks: means over items, intervals clustered by path, differences item by
//! item, and the swap tests.

use super::{
    About, AgentKind, Comparison, Difference, Efforts, FEWEST_PATHS, Listening, Results, Row, Set, Swapped,
    results::Texts,
};
use crate::swap::Swap;
use std::collections::BTreeMap;
use wayword_metrics::{Estimate, McNemar, Metric, clustered_interval};

/// The name under which walks by the swapped texts of a set are recorded.
#[must_use]
pub fn swapped_set(set: &str, swap: Swap) -> String {
    format!("{set}~{}", swap.name())
}

/// The name under which walks by an empty text, instead of a set's texts, are recorded.
#[must_use]
pub fn empty_set(set: &str) -> String {
    format!("{set}~{EMPTY}")
}

/// The part of that name after `~`, where swaps have their name.
pub const EMPTY: &str = "empty";

/// The set name under which walks of agents that do not read are recorded.
pub const UNREAD: &str = "none";

/// An agent of a comparison.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Walker {
    /// Its name.
    pub name: String,
    /// What kind it is.
    pub kind: AgentKind,
    /// Whether it reads instructions.
    pub reads: bool,
    /// Whether its knowledge may lead it to the goal without its instruction. Then it has two more rows: by an empty text, and by the
    /// text of another path.
    pub has_floors: bool,
}

impl Walker {
    /// Whether swap tests are meaningful for it: either it can find the goal only by reading, or its two extra rows show what it
    /// reaches without reading.
    fn is_swapped(&self) -> bool {
        self.kind == AgentKind::Agent || self.has_floors
    }
}

/// Computes the table. Swap tests use the first set.
#[must_use]
pub fn compare(about: About, sets: Vec<Set>, walkers: &[Walker], swaps: &[Swap], results: &Results) -> Comparison {
    let table = Table { about: &about, results };
    let mut rows = Vec::new();
    for walker in walkers {
        if walker.reads {
            rows.extend(sets.iter().enumerate().map(|(at, set)| {
                let first = sets.first().filter(|_| at > 0);
                table.row(walker, Some(&set.name), first.map(|first| first.name.as_str()))
            }));
            if let Some(first) = sets.first().filter(|_| walker.has_floors) {
                let floors = [empty_set(&first.name), swapped_set(&first.name, Swap::OtherPath)];
                rows.extend(floors.iter().map(|set| table.row(walker, Some(set), None)));
            }
        } else {
            rows.push(table.row(walker, None, None));
        }
    }
    let mut swapped = Vec::new();
    if let Some(first) = sets.first() {
        for walker in walkers.iter().filter(|walker| walker.is_swapped()) {
            swapped.extend(swaps.iter().map(|swap| table.swapped(walker, &first.name, *swap)));
        }
    }
    Comparison { about, sets, rows, swaps: swapped }
}

struct Table<'a> {
    about: &'a About,
    results: &'a Results,
}

impl Table<'_> {
    fn row(&self, walker: &Walker, set: Option<&str>, first: Option<&str>) -> Row {
        let kept = set.unwrap_or(UNREAD);
        let against = |first: &str| self.difference(&walker.name, (kept, None), (first, None));
        Row {
            agent: walker.name.clone(),
            kind: walker.kind,
            set: set.map(str::to_owned),
            figures: self.figures(&walker.name, kept, None),
            against_first: first.map(against),
            effort: Efforts::of(self.results, (&walker.name, kept), |by_item| self.estimate(&by_item)),
        }
    }

    fn swapped(&self, walker: &Walker, first: &str, swap: Swap) -> Swapped {
        let set = swapped_set(first, swap);
        let texts = self.results.texts(&walker.name, &set);
        let lost = self.difference(&walker.name, (first, Some(&texts)), (&set, None));
        let listening = match lost.figures.get(&Metric::SuccessRate) {
            Some(lost) if lost.clusters >= FEWEST_PATHS && lost.low > 0.0 => Listening::Shown,
            Some(lost) if lost.clusters >= FEWEST_PATHS => Listening::NotShown,
            _ => Listening::TooFew,
        };
        let count = |texts: &Texts| texts.values().map(|texts| texts.len()).sum();
        Swapped {
            agent: walker.name.clone(),
            swap,
            changed: count(&texts),
            texts: count(&self.results.texts(&walker.name, first)),
            figures: self.figures(&walker.name, &set, None),
            lost,
            listening,
        }
    }

    fn figures(&self, agent: &str, set: &str, only: Option<&Texts>) -> BTreeMap<Metric, Estimate> {
        self.estimates(|metric| self.results.by_item(agent, set, metric, self.about.rule, only))
    }

    /// The first set minus the second, on the items that have a figure in both.
    fn difference(
        &self,
        agent: &str,
        (first, only_first): (&str, Option<&Texts>),
        (second, only_second): (&str, Option<&Texts>),
    ) -> Difference {
        let rule = self.about.rule;
        let figures = self.estimates(|metric| {
            let second = self.results.by_item(agent, second, metric, rule, only_second);
            let first = self.results.by_item(agent, first, metric, rule, only_first);
            first.into_iter().filter_map(|(item, figure)| Some((item, figure - second.get(item)?))).collect()
        });
        let second = self.results.first_successes(agent, second, rule, only_second);
        let first = self.results.first_successes(agent, first, rule, only_first);
        let pairs = first.iter().filter_map(|(item, first)| Some((*first, *second.get(item)?)));
        Difference { figures, mcnemar: McNemar::of(pairs) }
    }

    fn estimates<'r>(&self, of: impl Fn(Metric) -> BTreeMap<&'r str, f64>) -> BTreeMap<Metric, Estimate>
    where
        Self: 'r,
    {
        let estimate = |metric| Some((metric, self.estimate(&of(metric))?));
        Metric::ALL.into_iter().filter_map(estimate).collect()
    }

    /// The mean of items' figures, with its interval clustered by path.
    fn estimate(&self, by_item: &BTreeMap<&str, f64>) -> Option<Estimate> {
        let values: Vec<(&str, f64)> =
            by_item.iter().map(|(item, figure)| (self.results.cluster(item), *figure)).collect();
        let About { resamples, level, seed, .. } = *self.about;
        clustered_interval(&values, resamples, level, seed)
    }
}
