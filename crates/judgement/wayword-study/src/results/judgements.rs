//! Collects the answers from which the figures are computed, and decides which participants count.
//!
//! An [`AnsweredItem`] is one item with its answer. For the figures it becomes one [`TextJudgement`] for each text that it judges, so a
//! comparison of two texts becomes two.

use super::{names::ParticipantNames, walks::WalkScorer};
use crate::{ItemSlot, PairChoice, Participant, ParticipantAnswer, ParticipantStatus, SlotState, StudyData, StudyItem};
use std::collections::BTreeMap;
use wayword_metrics::TrajectoryScore;

/// The judgement of one person on one text. A comparison of two texts gives two of them.
#[derive(Debug, Clone)]
pub(super) struct TextJudgement<'a> {
    /// Index of the participant in [`StudyData`].
    pub(super) person: usize,
    /// Number of the item's route.
    pub(super) route: u32,
    /// Index of the text's condition in the plan.
    pub(super) condition: usize,
    /// The chosen levels, from 1 to 5, one for each question or statement.
    pub(super) levels: &'a [u8],
    /// The metrics of the walk, in the mode of following.
    pub(super) walk: Option<&'a TrajectoryScore>,
    /// Seconds to the answer, see [`AnsweredItem::answer_seconds`].
    pub(super) seconds: Option<f64>,
    /// In a walk: how often a button was pressed.
    pub(super) presses: Option<u32>,
    /// In a comparison: 1 if this text was preferred, 0.5 if neither was, else 0.
    pub(super) gain: Option<f64>,
    /// In a comparison: whether neither text was good.
    pub(super) both_bad: Option<bool>,
}

/// An item that a participant answered. Practice items are not among them.
#[derive(Debug, Clone)]
pub(super) struct AnsweredItem<'a> {
    /// Index of the participant in [`StudyData`].
    pub(super) person: usize,
    pub(super) participant: &'a Participant,
    pub(super) slot: &'a ItemSlot,
    pub(super) item: &'a StudyItem,
    pub(super) answer: &'a ParticipantAnswer,
    /// The metrics of a walk; `None` for the other modes, and if they cannot be computed.
    pub(super) score: Option<TrajectoryScore>,
}

/// All answers of a study, sorted by participant and position, and a message for each answer without figures.
pub(super) fn collect_answers<'a>(
    data: &'a StudyData,
    names: &ParticipantNames<'_>,
) -> (Vec<AnsweredItem<'a>>, Vec<String>) {
    let people: BTreeMap<&str, (usize, &Participant)> =
        data.participants.iter().enumerate().map(|(at, person)| (person.id.as_str(), (at, person))).collect();
    let mut walks = WalkScorer::new(data);
    let (mut collected, mut problems) = (Vec::new(), Vec::new());
    let mut unmatched = 0usize;
    for slot in data.slots.iter().filter(|slot| slot.state == SlotState::Answered && slot.position.is_some()) {
        let item = data.items.get(slot.item as usize).filter(|item| !item.is_practice);
        let (Some(&(person, participant)), Some(item), Some(answer)) =
            (people.get(slot.participant.as_str()), item, slot.answer.as_ref())
        else {
            unmatched += 1;
            continue;
        };
        let score = match (answer, walks.score_walk(item.route, &slot.moves)) {
            (ParticipantAnswer::Follow { .. }, Ok(score)) => Some(score),
            (ParticipantAnswer::Follow { .. }, Err(why)) => {
                let who = names.name_for_id(&participant.id);
                problems.push(format!("{who}'s walk of item {} has no figures: {why}", item.id));
                None
            }
            _ => None,
        };
        collected.push(AnsweredItem { person, participant, slot, item, answer, score });
    }
    if unmatched > 0 {
        let names = if unmatched == 1 { "1 answer names".to_owned() } else { format!("{unmatched} answers name") };
        problems.push(format!("{names} no participant or item of the study, and counts in no figure"));
    }
    collected.sort_by_key(|one| (one.person, one.slot.position, one.item.id));
    (collected, problems)
}

/// A pause longer than this between two actions counts as an absence, and the time of the answer is then not known.
const MAX_PAUSE_MS: i64 = 10 * 60 * 1000;

impl AnsweredItem<'_> {
    /// Seconds from getting the item to the answer, or in a walk to stopping. `None` if the participant was away in between, or the
    /// server's clock was changed.
    pub(super) fn answer_seconds(&self) -> Option<f64> {
        let end = match self.answer {
            ParticipantAnswer::Follow { stopped_ms, .. } => *stopped_ms,
            ParticipantAnswer::Rate { .. } | ParticipantAnswer::Pair { .. } => self.slot.answered_ms?,
        };
        let mut times = vec![self.slot.given_ms];
        times.extend(self.slot.moves.iter().map(|step| step.at_ms));
        times.push(end);
        let is_present = times.windows(2).all(|pair| (0..=MAX_PAUSE_MS).contains(&(pair[1] - pair[0])));
        is_present.then(|| seconds_between(self.slot.given_ms, end))
    }

    /// In a walk: how often the participant pressed a button, to move or to look around.
    pub(super) fn count_presses(&self) -> Option<u32> {
        match self.answer {
            ParticipantAnswer::Follow { looks, .. } => {
                Some(looks.saturating_add(u32::try_from(self.slot.moves.len()).unwrap_or(u32::MAX)))
            }
            ParticipantAnswer::Rate { .. } | ParticipantAnswer::Pair { .. } => None,
        }
    }

    /// The levels that were chosen, one for each statement or question. A comparison has none.
    pub(super) fn chosen_levels(&self) -> &[u8] {
        match self.answer {
            ParticipantAnswer::Follow { statements, .. } => statements,
            ParticipantAnswer::Rate { ratings } => ratings,
            ParticipantAnswer::Pair { .. } => &[],
        }
    }

    /// Indices of the two texts of a comparison in the order in which they were shown: A, then B.
    pub(super) fn shown_order(&self) -> [usize; 2] {
        if self.slot.is_turned { [1, 0] } else { [0, 1] }
    }

    /// In a comparison: the index of the text that was preferred, if one was.
    pub(super) fn preferred_text(&self) -> Option<usize> {
        match self.answer {
            ParticipantAnswer::Pair { choice: PairChoice::A } => Some(self.shown_order()[0]),
            ParticipantAnswer::Pair { choice: PairChoice::B } => Some(self.shown_order()[1]),
            _ => None,
        }
    }

    /// Index of the condition of one of the item's texts.
    pub(super) fn condition_of_text(&self, data: &StudyData, text: usize) -> Option<usize> {
        let judged = self.item.texts.get(text)?;
        data.plan.conditions.iter().position(|condition| condition.name == judged.condition)
    }

    /// Splits the answer into judgements, one for each text that was judged.
    pub(super) fn text_judgements(&self, data: &StudyData) -> Vec<TextJudgement<'_>> {
        let judge_text = |text: usize| {
            let (gain, both_bad) = match self.answer {
                ParticipantAnswer::Pair { choice } => {
                    let gain = self.preferred_text().map_or(0.5, |preferred| f64::from(u8::from(preferred == text)));
                    (Some(gain), Some(*choice == PairChoice::Bad))
                }
                ParticipantAnswer::Follow { .. } | ParticipantAnswer::Rate { .. } => (None, None),
            };
            Some(TextJudgement {
                person: self.person,
                route: self.item.route,
                condition: self.condition_of_text(data, text)?,
                levels: self.chosen_levels(),
                walk: self.score.as_ref(),
                seconds: self.answer_seconds(),
                presses: self.count_presses(),
                gain,
                both_bad,
            })
        };
        let texts = if matches!(self.answer, ParticipantAnswer::Pair { .. }) { 2 } else { 1 };
        (0..texts).filter_map(judge_text).collect()
    }
}

/// Seconds from one Unix time in milliseconds to another, not below 0.
pub(super) fn seconds_between(from_ms: i64, to_ms: i64) -> f64 {
    to_ms.saturating_sub(from_ms).max(0) as f64 / 1000.0
}

/// Which answers count in a version of the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ParticipantFilter {
    /// All participants except those who were screened out.
    Everybody,
    /// Only those who finished and passed the attention checks.
    Finished,
    /// Of those, only the answers that no exclusion rule leaves out.
    Kept,
}

impl ParticipantFilter {
    /// The versions of a study with these exclusion rules.
    pub(super) fn for_rules(rules: &crate::ExclusionRules) -> Vec<Self> {
        let kept = (!rules.is_empty()).then_some(Self::Kept);
        [Self::Everybody, Self::Finished].into_iter().chain(kept).collect()
    }

    /// Whether a participant counts. `most_failed` is how many failed attention checks are tolerated.
    pub(super) fn accepts_participant(self, participant: &Participant, most_failed: usize) -> bool {
        let failed = participant.attention.iter().filter(|check| !check.passed).count();
        match self {
            Self::Everybody => participant.status != ParticipantStatus::ScreenedOut,
            Self::Finished | Self::Kept => participant.status == ParticipantStatus::Complete && failed <= most_failed,
        }
    }
}
