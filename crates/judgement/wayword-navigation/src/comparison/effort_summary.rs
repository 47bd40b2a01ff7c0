//! Summarises the efforts of the walks in a row of the table: calls, tokens, money, hops, time and useless replies of an agent with
//! a language model.

use crate::walk::{AgentWalkRecord, UselessReplies, WalkEffort, WalkEnd};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_metrics::MeanEstimate;

/// The efforts of the walks of a row. Means are over items, with intervals clustered by path; counts are over walks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffortSummary {
    /// Number of walks.
    pub walks: usize,
    /// Calls of the model in a walk.
    pub calls: MeanEstimate,
    /// Hops of a walk.
    pub hops: MeanEstimate,
    /// Tokens of all prompts of a walk.
    pub tokens_in: MeanEstimate,
    /// Tokens of all replies of a walk.
    pub tokens_out: MeanEstimate,
    /// US dollars of a walk; `None` where a price is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub usd: Option<MeanEstimate>,
    /// Seconds that the model took in a walk, when the calls were made.
    pub seconds: MeanEstimate,
    /// Tokens of the largest prompt of all.
    pub most_tokens_in: u64,
    /// Counts of useless replies.
    pub useless: UselessReplies,
    /// Views that could not be described.
    #[serde(default)]
    pub undescribed: usize,
    /// Walks that the agent ended at the start.
    pub at_once: usize,
    /// Number of walks by the reason of their end.
    pub ended: BTreeMap<WalkEnd, usize>,
}

/// The effort of one walk.
#[derive(Debug, Clone)]
pub(super) struct RecordedEffort {
    effort: WalkEffort,
    hops: usize,
    end: WalkEnd,
}

/// The efforts of one agent on one set: by item, then by the text's index in its set.
pub(super) type EffortsByItem = BTreeMap<String, BTreeMap<usize, RecordedEffort>>;

impl RecordedEffort {
    /// The effort of a walk; `None` if no language model decided.
    pub(super) fn from_walk(walk: &AgentWalkRecord) -> Option<Self> {
        let hops = walk.steps.len().saturating_sub(1);
        Some(Self { effort: walk.effort.clone()?, hops, end: walk.end })
    }
}

impl EffortSummary {
    /// Summarises the walks of an agent by a set. `estimate` computes the mean of the items' figures with its interval.
    pub(super) fn from_efforts(
        by_item: &EffortsByItem,
        estimate: impl Fn(BTreeMap<&str, f64>) -> Option<MeanEstimate>,
    ) -> Option<Self> {
        // The mean of a figure over items; `None` if one walk lacks it.
        let mean = |figure: &dyn Fn(&RecordedEffort) -> Option<f64>| {
            let mut means = BTreeMap::new();
            for (item, texts) in by_item {
                let figures = texts.values().map(figure).collect::<Option<Vec<f64>>>()?;
                means.insert(item.as_str(), figures.iter().sum::<f64>() / figures.len().max(1) as f64);
            }
            estimate(means)
        };
        let all = || by_item.values().flat_map(BTreeMap::values);
        let mut ended = BTreeMap::new();
        all().for_each(|walk| *ended.entry(walk.end).or_default() += 1);
        let sum = |count: fn(&UselessReplies) -> usize| all().map(|walk| count(&walk.effort.useless)).sum();
        Some(Self {
            walks: all().count(),
            calls: mean(&|walk| Some(walk.effort.calls as f64))?,
            hops: mean(&|walk| Some(walk.hops as f64))?,
            tokens_in: mean(&|walk| Some(walk.effort.tokens_in as f64))?,
            tokens_out: mean(&|walk| Some(walk.effort.tokens_out as f64))?,
            usd: mean(&|walk| walk.effort.usd),
            seconds: mean(&|walk| Some(walk.effort.seconds))?,
            most_tokens_in: all().map(|walk| walk.effort.most_tokens_in).max().unwrap_or_default(),
            useless: UselessReplies {
                no_call: sum(|useless| useless.no_call),
                no_way: sum(|useless| useless.no_way),
                idle: sum(|useless| useless.idle),
                failed: sum(|useless| useless.failed),
            },
            undescribed: all().map(|walk| walk.effort.undescribed).sum(),
            at_once: all().filter(|walk| walk.hops == 0 && walk.end == WalkEnd::Stopped).count(),
            ended,
        })
    }
}
