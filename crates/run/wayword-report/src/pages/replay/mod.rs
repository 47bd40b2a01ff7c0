//! Replays of agents' walks, step by step: the scores of the views, the choices, and where the agent went back.

mod steps;
mod walk_sample;

pub use walk_sample::WalkSample;

use super::{
    link_targets::frame_anchor,
    map::{BADGE_RADIUS, MapTrail, MapView},
};
use serde::Serialize;
use steps::{StepView, step_views};
use wayword_core::{DVec3, ViewpointGraph, ViewpointId};
use wayword_metrics::{SuccessOutcome, TrajectoryScore, TrajectorySuccessRule};
use wayword_navigation::{
    comparison::UNREAD_SET_NAME,
    walk::{AgentWalkRecord, StepChoice, WalkEffort, WalkEnd},
};
use wayword_run::{count::count_phrase, run_folder::PathMap};

/// Most steps of a walk that are shown.
const MAX_SHOWN_STEPS: usize = 100;
/// Most key phrases of an instruction that are shown.
const MAX_SHOWN_PHRASES: usize = 50;
/// Most characters of a text that are shown. The rest is cut off.
const MAX_SHOWN_TEXT_CHARS: usize = 2_000;

/// A walk, with the path that it is compared with.
#[derive(Debug, Clone, Copy)]
pub struct WalkReplay<'a> {
    /// The walk.
    pub walk: &'a AgentWalkRecord,
    /// The scene's graph.
    pub graph: &'a ViewpointGraph,
    /// The annotated path, from start to goal.
    pub reference: &'a [ViewpointId],
    /// How well the walk did.
    pub score: &'a TrajectoryScore,
    /// The rule of success.
    pub rule: TrajectorySuccessRule,
}

/// A line of the list of walks.
#[derive(Debug, Serialize)]
pub(super) struct ReplayEntry {
    anchor: String,
    title: String,
    /// The outcome: class and words of its mark.
    class: &'static str,
    sign: &'static str,
}

impl ReplayEntry {
    /// The line for a walk; `number` from 1.
    pub(super) fn new(number: usize, replay: &WalkReplay<'_>) -> Self {
        let walk = replay.walk;
        let (class, sign) = outcome_mark(replay.outcome());
        let set = Some(&walk.set).filter(|set| *set != UNREAD_SET_NAME);
        let names: Vec<String> =
            [Some(&walk.agent), set, Some(&walk.item)].into_iter().flatten().map(|name| cut_name(name)).collect();
        let names = names.join(", ");
        // Anchors are numbers, because names come from files.
        Self { anchor: format!("r{number}"), title: format!("{names} (text {})", walk.text_index + 1), class, sign }
    }
}

/// A walk, ready for its template.
#[derive(Debug, Serialize)]
pub(super) struct ReplayView {
    /// From 1.
    number: usize,
    #[serde(flatten)]
    entry: ReplayEntry,
    meta: Vec<String>,
    text: String,
    reads_nothing: bool,
    phrases: Vec<String>,
    phrases_left_out: usize,
    /// `None` if the agent does not read.
    activity: Option<String>,
    map: Option<MapView>,
    map_radius: f64,
    map_stop: &'static str,
    map_words: String,
    steps: Vec<StepView>,
    steps_left_out: usize,
    /// Lowest and highest score, between which bars are drawn; `None` without scores.
    score_range: Option<(String, String)>,
}

impl ReplayView {
    /// A walk; `number` from 1.
    pub(super) fn new(number: usize, replay: &WalkReplay<'_>) -> Self {
        let walk = replay.walk;
        let entry = ReplayEntry::new(number, replay);
        let shown = walk.steps.len().min(MAX_SHOWN_STEPS);
        let phrases = walk.directions.as_ref().map_or(&[][..], |directions| &directions.phrases);
        let (steps, score_range) = step_views(walk, shown, |step| frame_anchor(&entry.anchor, step + 1));
        Self {
            number,
            entry,
            meta: replay.outcome_words(),
            text: cut_text(&walk.text),
            reads_nothing: walk.set == UNREAD_SET_NAME,
            phrases: phrases.iter().take(MAX_SHOWN_PHRASES).map(|phrase| cut_text(phrase)).collect(),
            phrases_left_out: phrases.len().saturating_sub(MAX_SHOWN_PHRASES),
            activity: walk.directions.as_ref().map(|directions| cut_text(&directions.activity)),
            map: replay.draw_map(shown),
            map_radius: BADGE_RADIUS,
            map_stop: "Step",
            map_words: format!("Map of the walk from step 1 to step {shown}, north up, with the annotated path"),
            steps,
            steps_left_out: walk.steps.len() - shown,
            score_range,
        }
    }
}

impl WalkReplay<'_> {
    fn outcome(&self) -> Option<SuccessOutcome> {
        match self.rule {
            TrajectorySuccessRule::Distance => Some(self.score.distance),
            TrajectorySuccessRule::Visible => self.score.visible,
        }
    }

    /// Scene, length, end and outcome of the walk, in words.
    fn outcome_words(&self) -> Vec<String> {
        let (walk, score) = (self.walk, self.score);
        let end = match walk.end {
            WalkEnd::Stopped => "the agent stopped",
            WalkEnd::Cap => "it reached the limit of its steps",
            WalkEnd::DeadEnd => "it reached a dead end",
            WalkEnd::Calls => "it made the most calls that it may",
            WalkEnd::Money => "its model cost what a walk may cost",
            WalkEnd::Circles => "it walked in circles",
            WalkEnd::NoUse => "its model gave no reply of use",
        };
        let distance_to_goal = score.navigation_error_m.map_or_else(
            || "its end has no connection to the goal".to_owned(),
            |error_m| format!("ends {error_m:.1} m from the goal"),
        );
        let mut meta = vec![
            format!("Scene {}", walk.scene),
            count_phrase(walk.steps.len(), "step"),
            format!("{:.1} m", score.length_m),
            distance_to_goal,
            end.to_owned(),
        ];
        match self.outcome() {
            Some(outcome) if outcome.success => meta.push(format!("SPL {:.0} %", 100.0 * outcome.spl)),
            Some(outcome) if outcome.oracle_success => {
                meta.push("it passed a viewpoint that counts as success".to_owned());
            }
            _ => {}
        }
        if let Some(object) = &walk.object {
            let judged = match score.grounding {
                Some(grounding) if grounding.rgs => ", the target",
                Some(_) => ", not the target",
                None => "",
            };
            meta.push(format!("names object {object} as the target{judged}"));
        }
        meta.extend(walk.effort.as_ref().map(effort_words));
        meta
    }

    fn draw_map(&self, shown: usize) -> Option<MapView> {
        let places = |ids: &mut dyn Iterator<Item = &ViewpointId>| -> Option<Vec<DVec3>> {
            ids.map(|id| self.graph.position_of(id)).collect()
        };
        let steps = &self.walk.steps[..shown];
        let stops = places(&mut steps.iter().map(|step| &step.viewpoint))?;
        let annotated = places(&mut self.reference.iter().take(MAX_SHOWN_STEPS))?;
        let backs: Vec<bool> = steps.iter().map(|step| step.choice == StepChoice::Back).collect();
        let around: Vec<DVec3> = stops.iter().chain(&annotated).copied().collect();
        let start = steps.first()?.heading_rad;
        MapView::draw_trail(
            &PathMap::near_stops(&around, self.graph),
            &MapTrail {
                stops: &stops,
                start,
                backs: &backs,
                annotated: &annotated,
                first_number: 1,
                is_numbered_once: true,
            },
        )
    }
}

/// The effort of a language model in a walk, in words.
fn effort_words(effort: &WalkEffort) -> String {
    let WalkEffort { calls, tokens_in, tokens_out, usd, seconds, .. } = effort;
    let usd = usd.filter(|usd| *usd > 0.0).map_or_else(String::new, |usd| format!(", ${usd:.4}"));
    format!("{}, {tokens_in} tokens in, {tokens_out} out{usd}, {seconds:.1} s", count_phrase(*calls, "call"))
}

fn outcome_mark(outcome: Option<SuccessOutcome>) -> (&'static str, &'static str) {
    match outcome {
        Some(outcome) if outcome.success => ("good", "✓ success"),
        Some(_) => ("bad", "✗ no success"),
        None => ("open", "? not judged"),
    }
}

/// A text, cut so that the page stays small enough for a phone.
fn cut_text(text: &str) -> String {
    text.chars().take(MAX_SHOWN_TEXT_CHARS).collect()
}

/// A name, cut for headings.
fn cut_name(name: &str) -> String {
    name.chars().take(80).collect()
}

#[cfg(test)]
pub(super) mod tests;
