//! Cuts a text into parts: the steps that belong to one stretch of a walk.

use crate::guide::{Guide, GuideStep, GuideStepKind};
use std::ops::Range;
use wayword_core::{ClimbDirection, Side};
use wayword_language::{
    reading::{TextReading, steps::StepRelation},
    text,
};

/// A text with its parts in order. Each word of the text lies in one part at most.
#[derive(Debug, Clone)]
pub struct PartedText {
    /// The steps of all parts.
    pub guide: Guide,
    /// The parts, in the order of the text.
    pub parts: Vec<TextPart>,
}

/// A part of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextPart {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// Number of its words.
    pub word_count: usize,
    /// Its steps in the guide; none where no word of it is understood.
    pub(crate) steps: Range<usize>,
    /// The most important thing that it asks for.
    pub(crate) kind: PartKind,
}

/// What a part asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PartKind {
    /// Nothing that is understood.
    Other,
    /// To turn left or right, in a few words.
    BareTurn,
    /// To turn left or right, with more about the way.
    Turn,
    /// To turn around.
    TurnAround,
    /// To take stairs.
    Climb,
    /// To stop or to wait.
    Stop,
    /// To leave a room.
    Exit,
    /// To go into a room.
    Enter,
    /// To go through, past or along something.
    Pass,
    /// To go straight on.
    Straight,
    /// Until when something else is done.
    Condition,
    /// To go to something.
    Go,
}

impl PartKind {
    /// Number of kinds.
    pub(crate) const COUNT: usize = 12;

    fn for_steps(steps: &[GuideStep], word_count: usize) -> Self {
        let has_kind = |kinds: &[GuideStepKind]| steps.iter().any(|step| kinds.contains(&step.kind));
        let has_relation = |wanted: &[StepRelation]| {
            steps.iter().flat_map(|step| &step.mentions).any(|mention| wanted.contains(&mention.relation))
        };
        let stops = steps.iter().any(|step| step.step.stops);
        if steps.is_empty() {
            Self::Other
        } else if has_kind(&[GuideStepKind::Turn, GuideStepKind::SlightTurn]) {
            if word_count <= MAX_BARE_TURN_WORDS { Self::BareTurn } else { Self::Turn }
        } else if has_kind(&[GuideStepKind::TurnAround]) {
            Self::TurnAround
        } else if has_kind(&[GuideStepKind::Climb]) {
            Self::Climb
        } else if stops {
            Self::Stop
        } else if has_relation(&[StepRelation::OutOf]) {
            Self::Exit
        } else if has_relation(&[StepRelation::Into]) {
            Self::Enter
        } else if has_relation(&[StepRelation::Through, StepRelation::Past, StepRelation::Along]) {
            Self::Pass
        } else if has_kind(&[GuideStepKind::Straight]) {
            Self::Straight
        } else if has_kind(&[GuideStepKind::Condition]) {
            Self::Condition
        } else if has_kind(&[GuideStepKind::Go, GuideStepKind::Cross]) {
            Self::Go
        } else {
            Self::Other
        }
    }
}

/// A turn of at most this many words has no room for anything else: "and then turn left".
const MAX_BARE_TURN_WORDS: usize = 4;

impl PartedText {
    /// Cuts a text that was read before into parts. A step makes a part; a condition ("until you reach the sofa") belongs to the step
    /// before it, and so does a step that nothing is understood of.
    #[must_use]
    pub fn from_reading(text: &str, reading: &TextReading) -> Self {
        let guide = Guide::from_reading(reading);
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for (number, step) in guide.steps.iter().enumerate() {
            let joins = matches!(step.kind, GuideStepKind::Condition | GuideStepKind::Other);
            match ranges.last_mut().filter(|_| joins) {
                Some(range) => range.end = number + 1,
                None => ranges.push(number..number + 1),
            }
        }
        let parts = ranges.into_iter().map(|range| {
            let steps = &guide.steps[range.clone()];
            let from = steps.iter().map(|step| step.step.span[0]).min().unwrap_or_default();
            let to = steps.iter().map(|step| step.step.span[1]).max().unwrap_or_default();
            TextPart::new(text, [from, to], range, steps)
        });
        let parts = parts.collect();
        Self { guide, parts }
    }

    /// A text whose parts are given by their byte ranges, in order. Each part is read alone. A range that is not one of the text makes
    /// a part without words.
    #[must_use]
    pub fn from_spans(text: &str, spans: &[[usize; 2]]) -> Self {
        let mut guide = Guide::read_text("");
        let mut parts = Vec::new();
        for [from, to] in spans.iter().copied() {
            let words = text.get(from..to).unwrap_or_default();
            let part = Guide::read_text(words).into_way();
            let first = guide.len();
            guide.append_steps(part, from);
            let steps = first..guide.len();
            parts.push(TextPart::new(text, [from, to], steps.clone(), &guide.steps[steps]));
        }
        Self { guide, parts }
    }

    /// The numbers of the parts that turn to a side.
    #[must_use]
    pub fn parts_with_turn(&self, side: Side) -> Vec<usize> {
        self.numbers_where(|part| part.turn_side(&self.guide) == Some(side))
    }

    /// The numbers of the parts that take stairs.
    #[must_use]
    pub fn parts_with_climb(&self) -> Vec<usize> {
        self.numbers_where(|part| part.climb(&self.guide).is_some())
    }

    fn numbers_where(&self, has: impl Fn(&TextPart) -> bool) -> Vec<usize> {
        self.parts.iter().enumerate().filter(|(_, part)| has(part)).map(|(number, _)| number).collect()
    }
}

impl TextPart {
    fn new(text: &str, span: [usize; 2], range: Range<usize>, steps: &[GuideStep]) -> Self {
        let word_count = text.get(span[0]..span[1]).map_or(0, text::word_count);
        Self { span, word_count, steps: range, kind: PartKind::for_steps(steps, word_count) }
    }

    /// The first left or right turn among its steps.
    pub(crate) fn turn_side(&self, guide: &Guide) -> Option<Side> {
        self.find_step(guide, |step| step.step.turn.filter(|side| matches!(side, Side::Left | Side::Right)))
    }

    /// The first climb among its steps.
    pub(crate) fn climb(&self, guide: &Guide) -> Option<ClimbDirection> {
        self.find_step(guide, |step| step.step.climb)
    }

    fn find_step<T>(&self, guide: &Guide, get: impl Fn(&GuideStep) -> Option<T>) -> Option<T> {
        guide.steps[self.steps.clone()].iter().find_map(get)
    }
}

#[cfg(test)]
mod tests;
