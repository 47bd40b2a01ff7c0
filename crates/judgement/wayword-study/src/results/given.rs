//! The answers that figures are made of.

use super::{names::Names, walks::Walks};
use crate::{Answer, Choice, Data, Item, Participant, Slot, SlotState, Status};
use std::collections::BTreeMap;
use wayword_metrics::{Score, Trajectory};

/// What one person gave for one text: an answer, as figures take it. A comparison is two of them.
#[derive(Debug, Clone)]
pub(super) struct Given<'a> {
    /// The number of the participant among all.
    pub(super) person: usize,
    pub(super) route: u32,
    /// The number of the text's condition in the plan.
    pub(super) condition: usize,
    /// The levels of the questions or statements.
    pub(super) levels: &'a [u8],
    pub(super) walk: Option<&'a Score>,
    pub(super) seconds: Option<f64>,
    pub(super) presses: Option<u32>,
    /// Of a comparison: 1 where this text was preferred, a half where neither was.
    pub(super) gain: Option<f64>,
    pub(super) both_bad: Option<bool>,
}

/// An item that a participant answered; practice is none.
#[derive(Debug, Clone)]
pub(super) struct Answered<'a> {
    pub(super) person: usize,
    pub(super) participant: &'a Participant,
    pub(super) slot: &'a Slot,
    pub(super) item: &'a Item,
    pub(super) answer: &'a Answer,
    /// Of a walk: its figures, where it has any.
    pub(super) score: Option<Score>,
}

/// All answers of a study, in the order of participants and positions, and what kept any from having figures.
pub(super) fn answered<'a>(data: &'a Data, names: &Names<'_>) -> (Vec<Answered<'a>>, Vec<String>) {
    let people: BTreeMap<&str, (usize, &Participant)> =
        data.participants.iter().enumerate().map(|(at, person)| (person.id.as_str(), (at, person))).collect();
    let mut walks = Walks::new(data);
    let (mut all, mut problems) = (Vec::new(), Vec::new());
    let mut strangers = 0usize;
    for slot in data.slots.iter().filter(|slot| slot.state == SlotState::Answered && slot.position.is_some()) {
        let item = data.items.get(slot.item as usize).filter(|item| !item.is_practice);
        let (Some(&(person, participant)), Some(item), Some(answer)) =
            (people.get(slot.participant.as_str()), item, slot.answer.as_ref())
        else {
            strangers += 1;
            continue;
        };
        let score = match (answer, walks.score(item.route, &slot.moves)) {
            (Answer::Follow { .. }, Ok(score)) => Some(score),
            (Answer::Follow { .. }, Err(why)) => {
                let who = names.of(&participant.id);
                problems.push(format!("{who}'s walk of item {} has no figures: {why}", item.id));
                None
            }
            _ => None,
        };
        all.push(Answered { person, participant, slot, item, answer, score });
    }
    if strangers > 0 {
        problems.push(format!("{strangers} answers name no participant or item of the study; they are in no figure"));
    }
    all.sort_by_key(|one| (one.person, one.slot.position, one.item.id));
    (all, problems)
}

/// Who gives no sign for longer than this was away: for a break, or until tomorrow.
const AWAY_MS: i64 = 10 * 60 * 1000;

impl Answered<'_> {
    /// From getting the item to the answer, or to stopping; `None` where somebody was away meanwhile, or the clock was set.
    pub(super) fn seconds(&self) -> Option<f64> {
        let end = match self.answer {
            Answer::Follow { stopped_ms, .. } => *stopped_ms,
            Answer::Rate { .. } | Answer::Pair { .. } => self.slot.answered_ms?,
        };
        let mut times = vec![self.slot.given_ms];
        times.extend(self.slot.moves.iter().map(|step| step.at_ms));
        times.push(end);
        let is_at_it = times.windows(2).all(|pair| (0..=AWAY_MS).contains(&(pair[1] - pair[0])));
        is_at_it.then(|| seconds(self.slot.given_ms, end))
    }

    /// Moves, and turns to look.
    pub(super) fn presses(&self) -> Option<u32> {
        match self.answer {
            Answer::Follow { looks, .. } => {
                Some(looks.saturating_add(u32::try_from(self.slot.moves.len()).unwrap_or(u32::MAX)))
            }
            Answer::Rate { .. } | Answer::Pair { .. } => None,
        }
    }

    pub(super) fn levels(&self) -> &[u8] {
        match self.answer {
            Answer::Follow { statements, .. } => statements,
            Answer::Rate { ratings } => ratings,
            Answer::Pair { .. } => &[],
        }
    }

    /// The numbers of the texts of a comparison, as they were shown: A, then B.
    pub(super) fn sides(&self) -> [usize; 2] {
        if self.slot.is_turned { [1, 0] } else { [0, 1] }
    }

    /// Of a comparison: the number of the text that was preferred, if one was.
    pub(super) fn preferred(&self) -> Option<usize> {
        match self.answer {
            Answer::Pair { choice: Choice::A } => Some(self.sides()[0]),
            Answer::Pair { choice: Choice::B } => Some(self.sides()[1]),
            _ => None,
        }
    }

    /// The number of the condition of one of the item's texts.
    pub(super) fn condition(&self, data: &Data, text: usize) -> Option<usize> {
        let told = self.item.texts.get(text)?;
        data.plan.conditions.iter().position(|condition| condition.name == told.condition)
    }

    /// As figures take it: one for each text that was judged.
    pub(super) fn given(&self, data: &Data) -> Vec<Given<'_>> {
        let of_text = |text: usize| {
            let (gain, both_bad) = match self.answer {
                Answer::Pair { choice } => {
                    let gain = self.preferred().map_or(0.5, |preferred| f64::from(u8::from(preferred == text)));
                    (Some(gain), Some(*choice == Choice::Bad))
                }
                Answer::Follow { .. } | Answer::Rate { .. } => (None, None),
            };
            Some(Given {
                person: self.person,
                route: self.item.route,
                condition: self.condition(data, text)?,
                levels: self.levels(),
                walk: self.score.as_ref(),
                seconds: self.seconds(),
                presses: self.presses(),
                gain,
                both_bad,
            })
        };
        let texts = if matches!(self.answer, Answer::Pair { .. }) { 2 } else { 1 };
        (0..texts).filter_map(of_text).collect()
    }
}

/// Seconds from one Unix time in milliseconds to another, not below 0.
pub(super) fn seconds(from_ms: i64, to_ms: i64) -> f64 {
    to_ms.saturating_sub(from_ms).max(0) as f64 / 1000.0
}

/// Whose answers a version of the tables takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Whose {
    /// Everybody's, except of those who were screened out.
    Everybody,
    /// Of those who finished and passed the attention checks.
    Finished,
}

impl Whose {
    pub(super) fn takes(self, participant: &Participant, most_failed: usize) -> bool {
        let failed = participant.attention.iter().filter(|check| !check.passed).count();
        match self {
            Self::Everybody => participant.status != Status::ScreenedOut,
            Self::Finished => participant.status == Status::Complete && failed <= most_failed,
        }
    }
}

/// The viewpoints of a walk, the start included.
pub(super) fn trajectory(start: &wayword_core::ViewpointId, moves: &[crate::Move]) -> Trajectory {
    let viewpoints = std::iter::once(start).chain(moves.iter().map(|step| &step.viewpoint)).cloned().collect();
    Trajectory { viewpoints, object: None }
}
