//! Estimates what a comparison would ask of models, and the cost, for `wayword compare --dry-run`.

use super::{
    agents::{Agent, TOOLS},
    kept::{Kept, ToolsKept},
    sets::Item,
    tools::describing,
};
use crate::compare::args::PICTURES;
use serde::Serialize;
use std::{collections::BTreeSet, fmt};
use wayword_core::{ModelError, Platform, Request, View};
use wayword_navigation::{
    AgentView,
    agents::{Describes, Looks, rehearse},
    directions::split_prompt,
    grounders::{Lexical, Sees},
};
use wayword_run::{
    count::count,
    error::Error,
    plan::{Bill, Load, Models, picture_tokens, seeing},
    settings::{LABELS, Settings, is_model},
};

/// Number of items for which walks are rehearsed. The estimate assumes that the other items are like them.
const FEW: usize = 40;
/// Tokens of a typical reply with one or two calls, and of one that takes an instruction apart.
const REPLY_TOKENS: u64 = 80;
const SPLIT_TOKENS: u64 = 60;
/// Views of one place, one in each of four directions.
const VIEWS: u64 = 4;

/// The calls and tokens that a comparison would need, and their cost.
#[derive(Debug, Serialize)]
pub(super) struct Estimate {
    /// Items that every set has.
    items: usize,
    /// Walks of the agent by a language model.
    walks: usize,
    /// Tokens of the largest prompt, without pictures. About four characters are a token.
    most_tokens_in: u64,
    /// The load and the cost of each model.
    models: Bill,
}

impl Estimate {
    /// Estimates a comparison as if its agent walked along the annotated paths.
    ///
    /// # Errors
    /// When a path cannot be looked along, or a prompt cannot be used.
    pub(super) fn of(
        kept: &Kept,
        settings: &Settings,
        items: &[Item],
        agents: &[Agent],
        (platform, models): (&dyn Platform, &Models<'_>),
    ) -> Result<Self, Error> {
        let mut estimate = Self { items: items.len(), walks: 0, most_tokens_in: 0, models: Bill::default() };
        if is_model(&kept.split) {
            estimate.models.add(&kept.split, "splits", split(items, agents));
        }
        if let Some(tools) = &kept.tools {
            estimate.walks = items.iter().map(|item| Agent::Tools.texts(item).count()).sum();
            let load = estimate.walking(tools, items, platform)?;
            estimate.models.add(&tools.llm, "walks", load);
            if is_model(&tools.see) {
                let places: BTreeSet<_> = items
                    .iter()
                    .flat_map(|item| item.episode.viewpoints.iter().map(|viewpoint| (&item.episode.scene, viewpoint)))
                    .collect();
                let load = seeing(&describing(settings))?.times(VIEWS * places.len() as u64);
                estimate.models.add(&tools.see, "sees", load);
            }
        }
        estimate.models.price(models);
        Ok(estimate)
    }

    /// Estimates what the walks take: rehearses those of a few items, and scales the result up to all.
    fn walking(&mut self, tools: &ToolsKept, items: &[Item], platform: &dyn Platform) -> Result<Load, Error> {
        let grounder = Lexical::new(Sees::Views);
        let looks_at_pictures = tools.see == PICTURES;
        let looks = if tools.see == LABELS { Looks::Labels } else { Looks::Captions(&Typical) };
        let (mut load, mut rehearsed) = (Load::default(), 0);
        for item in items.iter().take(FEW) {
            let agent_view = AgentView::new(platform, &grounder, false, &item.start.scene)?;
            let names_object = item.episode.target_object.is_some();
            for text in Agent::Tools.texts(item) {
                let route = &item.episode.viewpoints;
                let sight = (looks, tools.limits);
                let asked = rehearse(&agent_view, &item.start, &text.text, names_object, sight, route)?;
                for (at, request) in asked.iter().enumerate() {
                    let before = load.tokens_in;
                    load.call(&words_of(request), REPLY_TOKENS);
                    self.most_tokens_in = self.most_tokens_in.max(load.tokens_in - before);
                    // Before the first look it has no pictures.
                    let is_shown = looks_at_pictures && at > 0;
                    load.tokens_in += if is_shown { VIEWS * picture_tokens(tools.picture_px) } else { 0 };
                }
                rehearsed += 1;
            }
        }
        let scaled = |of: u64| of * self.walks as u64 / rehearsed.max(1);
        Ok(Load { calls: scaled(load.calls), tokens_in: scaled(load.tokens_in), tokens_out: scaled(load.tokens_out) })
    }
}

/// All text of a request, including the descriptions of its tools.
fn words_of(request: &Request) -> String {
    let messages = request.messages.iter().map(|message| message.text.as_str());
    messages.chain(request.tools.iter().flat_map(|tool| [tool.name, tool.does, tool.arguments])).collect()
}

/// Estimates what it takes to split each different instruction once.
fn split(items: &[Item], agents: &[Agent]) -> Load {
    let mut load = Load::default();
    let Some(by_phrases) = agents.iter().find(|agent| matches!(agent, Agent::Phrases { .. })) else { return load };
    let texts: BTreeSet<&str> =
        items.iter().flat_map(|item| by_phrases.texts(item)).map(|text| text.text.as_str()).collect();
    for text in texts {
        load.call(&split_prompt(text).unwrap_or_default(), SPLIT_TOKENS);
    }
    load
}

impl fmt::Display for Estimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", count(self.items, "item"))?;
        if self.models.is_empty() {
            return write!(f, "; no model takes part, so the comparison costs nothing");
        }
        if self.walks > 0 {
            write!(
                f,
                ", {} by {TOOLS}; its largest prompt has about {} tokens without pictures",
                count(self.walks, "walk"),
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
struct Typical;

impl Describes for Typical {
    fn describe(&self, _: &View) -> Result<String, ModelError> {
        Ok("A living room with a grey sofa on the left, a wooden table in the middle, and a doorway to a hallway."
            .to_owned())
    }
}
