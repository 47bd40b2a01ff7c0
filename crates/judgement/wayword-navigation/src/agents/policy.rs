//! How an agent that walks by phrases decides, node by node.
//!
//! CLIP-Nav (arXiv 2211.16649, section 3): the current key phrase is scored on four views, and the agent goes to the
//! nearest neighbour in the best one. After a phrase that fits well enough comes the next phrase. An activity that fits
//! well enough ends the walk. Seq-CLIP-Nav goes back when the mean of the last scores is too low.
//!
//! The papers leave some cases open. Here, a phrase that fits still chooses the view, and the next phrase is current only after
//! that. Going back does not undo phrases that are done. Of views that tie in score and angle, the later one by the compass is
//! taken.

use super::PhraseWalkParameters;
use crate::sight::{NodeSight, SightView};
use std::collections::BTreeMap;
use wayword_core::{CompassPoint, Heading, ViewpointId};

/// The state of one walk of an agent by phrases, and its decisions.
pub(crate) struct PhrasePolicy<'p> {
    parameters: &'p PhraseWalkParameters,
    /// Number of key phrases; the activity comes after them.
    phrase_count: usize,
    /// The current key phrase, from 0.
    current_phrase: usize,
    /// How often the agent has been at each node.
    visits: BTreeMap<ViewpointId, usize>,
    /// The nodes on the way here, without those that the agent left again by going back.
    trail: Vec<ViewpointId>,
    /// How well the current phrase fitted the best view, for each look since the agent last went back.
    recent: Vec<f32>,
}

/// The agent's decision at a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum PhraseDecision {
    /// Go to a neighbour that lies in a view.
    Onward { view: usize, to: ViewpointId },
    /// Go back over these nodes, in this order.
    Back(Vec<ViewpointId>),
    /// End the walk here.
    Stop,
    /// There is no neighbour.
    DeadEnd,
}

impl<'p> PhrasePolicy<'p> {
    pub(crate) fn new(parameters: &'p PhraseWalkParameters, phrase_count: usize) -> Self {
        Self {
            parameters,
            phrase_count,
            current_phrase: 0,
            visits: BTreeMap::new(),
            trail: Vec::new(),
            recent: Vec::new(),
        }
    }

    /// The current key phrase, from 0; the number of phrases when only the activity is left.
    pub(crate) fn current_phrase(&self) -> usize {
        self.current_phrase
    }

    /// Decides at a node that was entered along `heading`.
    pub(crate) fn decide(&mut self, here: &ViewpointId, heading: Heading, sight: &NodeSight) -> PhraseDecision {
        *self.visits.entry(here.clone()).or_default() += 1;
        self.trail.push(here.clone());
        let best = |phrase: usize| sight.views.iter().map(|view| view.scores[phrase]).fold(f32::NEG_INFINITY, f32::max);
        let may_stop = self.phrase_count - self.current_phrase <= self.parameters.stop_with_phrases_left;
        // The score after those of the phrases is the activity's.
        if may_stop && best(self.phrase_count) >= self.parameters.stop_threshold {
            return PhraseDecision::Stop;
        }
        let current = self.current_phrase;
        let fit = best(current);
        if current < self.phrase_count && fit >= self.parameters.phrase_threshold {
            self.current_phrase += 1;
        }
        self.decide_back(fit).unwrap_or_else(|| self.decide_onward(heading, sight, current))
    }

    /// Decides to go back if the scores of the last looks are too low, and returns the nodes to go back over.
    fn decide_back(&mut self, fit: f32) -> Option<PhraseDecision> {
        let back = self.parameters.back?;
        self.recent.push(fit);
        let window_start = self.recent.len().checked_sub(back.window.max(1))?;
        let mean = self.recent[window_start..].iter().sum::<f32>() / back.window.max(1) as f32;
        let kept_len = self.trail.len().checked_sub(back.nodes + 1)?;
        if mean >= back.threshold || back.nodes == 0 {
            return None;
        }
        // The mean starts anew with the next look.
        self.recent.clear();
        // The agent looks again from the last of these nodes, which then joins the trail.
        let over: Vec<ViewpointId> = self.trail.drain(kept_len..).rev().skip(1).collect();
        Some(PhraseDecision::Back(over))
    }

    /// Decides to go on, to the nearest neighbour in the best view. Of views with equal scores, the one nearest to straight ahead
    /// is taken.
    fn decide_onward(&self, heading: Heading, sight: &NodeSight, phrase: usize) -> PhraseDecision {
        let visits = |id: &ViewpointId| self.visits.get(id).copied().unwrap_or_default();
        let neighbours = || sight.views.iter().flat_map(|view| &view.onward);
        let fewest = neighbours().map(visits).min().unwrap_or_default();
        let is_open = |id: &&ViewpointId| !self.parameters.shun_visited || visits(id) == fewest;
        let off_rad = |view: usize| heading.turn_to(CompassPoint::ALL[view].to_heading()).abs();
        // `onward` is sorted, nearest first.
        let candidate = |(at, view): (usize, &SightView)| {
            Some((at, view.scores[phrase], view.onward.iter().find(is_open)?.clone()))
        };
        let candidates = sight.views.iter().enumerate().filter_map(candidate);
        let chosen = candidates.max_by(|a, b| a.1.total_cmp(&b.1).then_with(|| off_rad(b.0).total_cmp(&off_rad(a.0))));
        chosen.map_or(PhraseDecision::DeadEnd, |(view, _, to)| PhraseDecision::Onward { view, to })
    }
}
