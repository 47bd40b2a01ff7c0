//! Estimates what a comparison would ask of models, and the cost, for `wayword compare --dry-run`.

use super::{
    agents::WalkingAgent,
    instruction_sets::ComparisonItem,
    settings::{ComparisonSettings, ToolAgentSettings},
    thresholds::TOOLS_AGENT_NAME,
    tools::describing_settings,
};
use crate::compare::tool_agent_eyes::ToolAgentEyes;
use serde::Serialize;
use std::{collections::BTreeSet, fmt};
use wayword_core::{ModelError, ModelRequest, Platform, View};
use wayword_navigation::{
    AgentView,
    agents::{ToolAgentSight, ViewDescriber, rehearse_route},
    directions::split_prompt,
    grounders::{GrounderScope, LexicalGrounder},
};
use wayword_run::{
    count::count_phrase,
    error::CommandError,
    plan::{CallLoad, JobModels, ModelBill, picture_tokens, seeing_load},
    settings::RunSettings,
};

/// Walks are rehearsed for at most this many items. The estimate assumes that the other items are like them.
const REHEARSED_ITEM_COUNT: usize = 40;
/// Tokens of a typical reply of the agent `tools`, with one or two calls of tools.
const REPLY_TOKENS: u64 = 80;
/// Tokens of a typical reply that splits an instruction into phrases.
const SPLIT_TOKENS: u64 = 60;
/// Views of one place, one in each of four directions.
const VIEWS_PER_PLACE: u64 = 4;

/// The calls and tokens that a comparison would need, and their cost.
#[derive(Debug, Serialize)]
pub(super) struct ComparisonEstimate {
    /// Items that every set has.
    items: usize,
    /// Walks of the agent `tools`, which a language model decides.
    walks: usize,
    /// Tokens of the largest prompt, without pictures. About four characters are a token.
    most_tokens_in: u64,
    /// The load and the cost of each model.
    models: ModelBill,
}

impl ComparisonEstimate {
    /// Estimates a comparison as if the agent `tools` walked along the annotated paths.
    ///
    /// # Errors
    /// When a path cannot be looked along, or a prompt cannot be used.
    pub(super) fn for_comparison(
        config: &ComparisonSettings,
        settings: &RunSettings,
        items: &[ComparisonItem],
        agents: &[WalkingAgent],
        (platform, models): (&dyn Platform, &JobModels<'_>),
    ) -> Result<Self, CommandError> {
        let mut estimate = Self { items: items.len(), walks: 0, most_tokens_in: 0, models: ModelBill::default() };
        if let Some(model) = config.split.model_name() {
            estimate.models.add_load(model, "splits", estimate_splitting(items, agents));
        }
        if let Some(tools) = &config.tools {
            estimate.walks = items.iter().map(|item| WalkingAgent::Tools.texts_of_item(item).count()).sum();
            let load = estimate.estimate_walks(tools, items, platform)?;
            estimate.models.add_load(&tools.llm, "walks", load);
            if let Some(model) = tools.see.describing_model() {
                let places: BTreeSet<_> = items
                    .iter()
                    .flat_map(|item| item.episode.viewpoints.iter().map(|viewpoint| (&item.episode.scene, viewpoint)))
                    .collect();
                let load = seeing_load(&describing_settings(settings))?.times(VIEWS_PER_PLACE * places.len() as u64);
                estimate.models.add_load(model, "sees", load);
            }
        }
        estimate.models.fill_prices(models);
        Ok(estimate)
    }

    /// Estimates what the walks take: rehearses those of a few items, and scales the result up to all.
    fn estimate_walks(
        &mut self,
        tools: &ToolAgentSettings,
        items: &[ComparisonItem],
        platform: &dyn Platform,
    ) -> Result<CallLoad, CommandError> {
        let grounder = LexicalGrounder::new(GrounderScope::Views);
        let looks_at_pictures = tools.see == ToolAgentEyes::Pictures;
        let looks = match tools.see.are_labels() {
            true => ToolAgentSight::Labels,
            false => ToolAgentSight::Captions(&TypicalCaption),
        };
        let (mut load, mut rehearsed) = (CallLoad::default(), 0);
        for item in items.iter().take(REHEARSED_ITEM_COUNT) {
            let agent_view = AgentView::new(platform, &grounder, false, &item.start.scene)?;
            let names_object = item.episode.target_object.is_some();
            for text in WalkingAgent::Tools.texts_of_item(item) {
                let route = &item.episode.viewpoints;
                let sight = (looks, tools.limits);
                let requests = rehearse_route(&agent_view, &item.start, &text.text, names_object, sight, route)?;
                for (at, request) in requests.iter().enumerate() {
                    let before = load.tokens_in;
                    load.add_call(&request_text(request), REPLY_TOKENS);
                    self.most_tokens_in = self.most_tokens_in.max(load.tokens_in - before);
                    // The first request has no pictures, because the agent has not looked around yet.
                    let is_shown = looks_at_pictures && at > 0;
                    load.tokens_in += if is_shown { VIEWS_PER_PLACE * picture_tokens(tools.picture_px) } else { 0 };
                }
                rehearsed += 1;
            }
        }
        let scaled = |sum: u64| sum * self.walks as u64 / rehearsed.max(1);
        Ok(CallLoad {
            calls: scaled(load.calls),
            tokens_in: scaled(load.tokens_in),
            tokens_out: scaled(load.tokens_out),
        })
    }
}

/// All text of a request, including the descriptions of its tools.
fn request_text(request: &ModelRequest) -> String {
    let messages = request.messages.iter().map(|message| message.text.as_str());
    messages.chain(request.tools.iter().flat_map(|tool| [tool.name, tool.does, tool.arguments])).collect()
}

/// Estimates what it takes to split each different instruction once.
fn estimate_splitting(items: &[ComparisonItem], agents: &[WalkingAgent]) -> CallLoad {
    let mut load = CallLoad::default();
    let Some(by_phrases) = agents.iter().find(|agent| matches!(agent, WalkingAgent::Phrases { .. })) else {
        return load;
    };
    let texts: BTreeSet<&str> =
        items.iter().flat_map(|item| by_phrases.texts_of_item(item)).map(|text| text.text.as_str()).collect();
    for text in texts {
        load.add_call(&split_prompt(text).unwrap_or_default(), SPLIT_TOKENS);
    }
    load
}

impl fmt::Display for ComparisonEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", count_phrase(self.items, "item"))?;
        if self.models.is_empty() {
            return write!(f, "; no model takes part, so the comparison costs nothing");
        }
        if self.walks > 0 {
            write!(
                f,
                ", {} by {TOOLS_AGENT_NAME}; its largest prompt has about {} tokens without pictures",
                count_phrase(self.walks, "walk"),
                self.most_tokens_in
            )?;
        }
        writeln!(
            f,
            "\nestimate, if it walks along the annotated paths, looks around at each place and never searches, and the ledger is empty:"
        )?;
        self.models.fmt(f)
    }
}

/// Describes every view with the same caption, of typical length.
struct TypicalCaption;

impl ViewDescriber for TypicalCaption {
    fn describe_view(&self, _: &View) -> Result<String, ModelError> {
        Ok("A living room with a grey sofa on the left, a wooden table in the middle, and a doorway to a hallway."
            .to_owned())
    }
}
