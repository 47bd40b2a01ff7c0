//! What an agent that walks by phrases makes of what it is told, node by node.
//!
//! CLIP-Nav (arXiv 2211.16649, section 3): the key phrase in hand is held against four views; the best view's nearest neighbour
//! is next; a phrase that fits well enough gives way to the next one; an activity that fits well enough ends the walk.
//! Seq-CLIP-Nav goes back where the mean of the last scores is too low.
//!
//! Left open by the papers and decided here: the phrase in hand when it looks also chooses the view, and only then gives way; going
//! back keeps the phrases that were done; of views that tie in score and angle the later by the compass is taken.

use super::Parameters;
use crate::eyes::{Seen, Sight};
use std::collections::BTreeMap;
use wayword_core::{Compass, Heading, ViewpointId};

/// An agent's memory of one walk.
pub(crate) struct Mind<'p> {
    parameters: &'p Parameters,
    /// Number of key phrases; the activity comes after them.
    phrases: usize,
    /// The key phrase in hand.
    phrase: usize,
    visits: BTreeMap<ViewpointId, usize>,
    /// The way here without what was gone back over.
    trail: Vec<ViewpointId>,
    recent: Vec<f32>,
}

/// What is done at a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Decision {
    /// Go to a neighbour that lies in a view.
    Onward { view: usize, to: ViewpointId },
    /// Go back over these nodes, in this order.
    Back(Vec<ViewpointId>),
    /// This is the place.
    Stop,
    /// There is no neighbour.
    DeadEnd,
}

impl<'p> Mind<'p> {
    pub(crate) fn new(parameters: &'p Parameters, phrases: usize) -> Self {
        Self { parameters, phrases, phrase: 0, visits: BTreeMap::new(), trail: Vec::new(), recent: Vec::new() }
    }

    /// The key phrase in hand, from 0; as many as there are when only the activity is left.
    pub(crate) fn phrase(&self) -> usize {
        self.phrase
    }

    /// Decides at a node that was entered along `heading`.
    pub(crate) fn decide(&mut self, here: &ViewpointId, heading: Heading, sight: &Sight) -> Decision {
        *self.visits.entry(here.clone()).or_default() += 1;
        self.trail.push(here.clone());
        let best = |of: usize| sight.views.iter().map(|view| view.scores[of]).fold(f32::NEG_INFINITY, f32::max);
        let listens = self.phrases - self.phrase <= self.parameters.stop_with_phrases_left;
        if listens && best(self.phrases) >= self.parameters.stop_threshold {
            return Decision::Stop;
        }
        let in_hand = self.phrase;
        let fit = best(in_hand);
        if in_hand < self.phrases && fit >= self.parameters.phrase_threshold {
            self.phrase += 1;
        }
        self.back(fit).unwrap_or_else(|| self.onward(heading, sight, in_hand))
    }

    /// The nodes to go back over, where the last looks say that the way is wrong.
    fn back(&mut self, fit: f32) -> Option<Decision> {
        let back = self.parameters.back?;
        self.recent.push(fit);
        let from = self.recent.len().checked_sub(back.window.max(1))?;
        let mean = self.recent[from..].iter().sum::<f32>() / back.window.max(1) as f32;
        let keep = self.trail.len().checked_sub(back.nodes + 1)?;
        if mean >= back.threshold || back.nodes == 0 {
            return None;
        }
        // From there on the next looks count anew.
        self.recent.clear();
        // The last of them is looked from again, and joins the trail then.
        let over: Vec<ViewpointId> = self.trail.drain(keep..).rev().skip(1).collect();
        Some(Decision::Back(over))
    }

    /// The best view's nearest neighbour. Of views that fit equally well, the one that lies nearest to straight ahead.
    fn onward(&self, heading: Heading, sight: &Sight, in_hand: usize) -> Decision {
        let visits = |id: &ViewpointId| self.visits.get(id).copied().unwrap_or_default();
        let neighbours = || sight.views.iter().flat_map(|view| &view.onward);
        let least = neighbours().map(visits).min().unwrap_or_default();
        let may = |id: &&ViewpointId| !self.parameters.shun_visited || visits(id) == least;
        let off_rad = |view: usize| heading.turn_to(Compass::ALL[view].heading()).abs();
        let worth =
            |(at, view): (usize, &Seen)| Some((at, view.scores[in_hand], view.onward.iter().find(may)?.clone()));
        let open = sight.views.iter().enumerate().filter_map(worth);
        let chosen = open.max_by(|a, b| a.1.total_cmp(&b.1).then_with(|| off_rad(b.0).total_cmp(&off_rad(a.0))));
        chosen.map_or(Decision::DeadEnd, |(view, _, to)| Decision::Onward { view, to })
    }
}
