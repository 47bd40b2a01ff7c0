//! The steps of a replayed walk: the agent's place, the scores of its views, and its choice.

use crate::pages::palette::{FrameColour, frame_colour};
use serde::Serialize;
use wayword_core::CompassPoint;
use wayword_navigation::walk::{AgentStep, AgentWalkRecord, StepChoice, StepViewScores, SurroundingsSummary};
use wayword_run::count::count_phrase;

/// Most characters of a phrase in a cell. The rest is cut off.
const MAX_PHRASE_CHARS: usize = 120;

/// Most characters of a reason. The rest is cut off.
const MAX_REASON_CHARS: usize = 400;

/// A step.
#[derive(Debug, Serialize)]
pub(super) struct StepView {
    /// From 1.
    number: usize,
    anchor: String,
    /// The first step (from 1) at this viewpoint, if this one returns to it. The map shows its number.
    again: Option<usize>,
    colour: FrameColour,
    heading: String,
    /// The current phrase; `None` if the agent does not look by phrases.
    phrase: Option<String>,
    /// The room and things that a reading agent was informed of; `None` for other agents.
    told: Option<String>,
    /// Empty if the agent does not look.
    views: Vec<ScoredViewView>,
    class: &'static str,
    then: String,
    /// The reason for the choice, in a model's own words.
    reason: Option<String>,
}

/// A view with its scores.
#[derive(Debug, Serialize)]
struct ScoredViewView {
    direction: &'static str,
    is_chosen: bool,
    ways: usize,
    phrase: ScoreBar,
    activity: ScoreBar,
}

/// A score with its bar.
#[derive(Debug, Serialize)]
struct ScoreBar {
    score: String,
    /// Length of the bar, per cent.
    long: u32,
}

/// The lowest and the highest score of a walk, between which bars are drawn.
#[derive(Debug, Clone, Copy)]
struct ScoreRange {
    low: f32,
    high: f32,
}

/// The first `shown` steps of a walk, and the range of the bars.
pub(super) fn step_views(
    walk: &AgentWalkRecord,
    shown: usize,
    anchor: impl Fn(usize) -> String,
) -> (Vec<StepView>, Option<(String, String)>) {
    let range = ScoreRange::from_walk(walk);
    let step = |(at, step): (usize, &AgentStep)| StepView {
        number: at + 1,
        anchor: anchor(at),
        again: walk.steps[..at].iter().position(|other| other.viewpoint == step.viewpoint).map(|first| first + 1),
        colour: frame_colour(at, shown),
        heading: format!("{:.0}°", step.heading_rad.deg()),
        phrase: (!step.views.is_empty()).then(|| phrase_words(walk, step)),
        told: step.told.as_ref().map(report_words),
        views: step
            .views
            .iter()
            .zip(CompassPoint::ALL)
            .enumerate()
            .map(|(at, view)| look_view(step, at, view, range))
            .collect(),
        class: match step.choice {
            StepChoice::Onward(_) | StepChoice::Unseeing => "onward",
            StepChoice::Back => "backward",
            StepChoice::Stop => "stopped",
        },
        then: choice_words(step.choice),
        reason: step.reason.as_ref().map(|reason| reason.chars().take(MAX_REASON_CHARS).collect()),
    };
    let views = walk.steps.iter().take(shown).enumerate().map(step).collect();
    (views, range.map(|range| (score_text(range.low), score_text(range.high))))
}

fn look_view(
    step: &AgentStep,
    at: usize,
    (view, direction): (&StepViewScores, CompassPoint),
    range: Option<ScoreRange>,
) -> ScoredViewView {
    let bar =
        |score: f32| ScoreBar { score: score_text(score), long: range.map_or(0, |range| range.bar_length(score)) };
    ScoredViewView {
        direction: direction.word(),
        is_chosen: step.choice == StepChoice::Onward(at),
        ways: view.ways,
        phrase: bar(view.phrase),
        activity: bar(view.activity),
    }
}

fn phrase_words(walk: &AgentWalkRecord, step: &AgentStep) -> String {
    let phrases = walk.directions.as_ref().map_or(&[][..], |directions| &directions.phrases);
    phrases.get(step.phrase).map_or_else(
        || "the activity alone".to_owned(),
        |phrase| format!("{}. {}", step.phrase + 1, phrase.chars().take(MAX_PHRASE_CHARS).collect::<String>()),
    )
}

fn report_words(summary: &SurroundingsSummary) -> String {
    let room = match &summary.room {
        Some(room) => format!("in room {}", room.chars().take(MAX_PHRASE_CHARS).collect::<String>()),
        None => "in a room without a name".to_owned(),
    };
    format!("{room}, {} on, {}", count_phrase(summary.ways, "way"), count_phrase(summary.things, "thing"))
}

fn choice_words(choice: StepChoice) -> String {
    match choice {
        StepChoice::Onward(view) => {
            format!("goes on {}", CompassPoint::ALL.get(view).map_or("through no view", |direction| direction.word()))
        }
        StepChoice::Unseeing => "goes on".to_owned(),
        StepChoice::Back => "goes back".to_owned(),
        StepChoice::Stop => "stays here".to_owned(),
    }
}

impl ScoreRange {
    fn from_walk(walk: &AgentWalkRecord) -> Option<Self> {
        let scores = walk.steps.iter().flat_map(|step| &step.views).flat_map(|view| [view.phrase, view.activity]);
        let with = |range: Option<Self>, score: f32| {
            let Self { low, high } = range.unwrap_or(Self { low: score, high: score });
            Some(Self { low: low.min(score), high: high.max(score) })
        };
        scores.filter(|score| score.is_finite()).fold(None, with)
    }

    fn bar_length(self, score: f32) -> u32 {
        let (low, high) = (f64::from(self.low), f64::from(self.high));
        // If all scores are equal, a bar is either full or empty.
        let share = if high > low { (f64::from(score) - low) / (high - low) } else { f64::from(score) };
        (100.0 * share).clamp(0.0, 100.0).round() as u32
    }
}

fn score_text(score: f32) -> String {
    if score.abs() < 1e4 { format!("{score:.2}") } else { format!("{score:.1e}") }
}
