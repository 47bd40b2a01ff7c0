//! Evaluates comparisons of two texts: wins and ties for each pair of conditions, and a strength for each condition by the model of
//! Bradley and Terry.

use super::{CONFIDENCE_LEVEL, judgements::AnsweredItem};
use crate::{PairChoice, ParticipantAnswer, StudyData};
use serde::Serialize;
use wayword_metrics::{
    BradleyTerry, NoStrength, PairPreference, StudyFigure, SystemComparison, answer_share, bradley_terry,
};

/// The results of all comparisons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairResults {
    /// One for each two conditions that were compared.
    pub rows: Vec<PairRow>,
    /// The share of preferences for the text shown as A. It is near a half unless people favour one side of the page.
    pub side: Option<StudyFigure>,
    /// Strengths of the conditions, or why there are none.
    pub strengths: ConditionStrengths,
}

/// The comparisons between two conditions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairRow {
    /// The condition that comes first in the plan.
    pub first: String,
    /// The other condition.
    pub second: String,
    /// How often the first one was preferred.
    pub first_wins: usize,
    /// How often the second one was.
    pub second_wins: usize,
    /// How often they were about equal.
    pub ties: usize,
    /// How often neither was good.
    pub both_bad: usize,
    /// The share of the first one: its wins and half of the comparisons without a winner.
    pub share: Option<StudyFigure>,
}

/// Strengths by the model of Bradley and Terry, or why there are none.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConditionStrengths {
    /// The strengths.
    Known(BradleyTerry<String>),
    /// Why there are none.
    Unknown {
        /// The reason in words.
        why: String,
        /// The reason as a value.
        reason: NoStrength,
    },
}

/// The answer to a comparison, with the indices of the conditions of both texts.
struct PairAnswer<'a> {
    answered: &'a AnsweredItem<'a>,
    choice: PairChoice,
    /// The conditions of the texts as they were shown: A, then B.
    conditions: [usize; 2],
}

impl PairResults {
    pub(super) fn new(data: &StudyData, taken: &[&AnsweredItem<'_>]) -> Self {
        let compared: Vec<PairAnswer<'_>> = taken.iter().filter_map(|one| PairAnswer::new(data, one)).collect();
        let count = data.plan.conditions.len();
        let both = (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second]));
        Self {
            rows: both.filter_map(|both| pair_row(data, &compared, both)).collect(),
            side: answer_share(
                &compared.iter().filter_map(PairAnswer::side_preference).collect::<Vec<_>>(),
                CONFIDENCE_LEVEL,
            ),
            strengths: condition_strengths(data, &compared),
        }
    }
}

impl<'a> PairAnswer<'a> {
    /// `None` if both texts have the same condition: that comparison does not help to compare conditions.
    fn new(data: &StudyData, answered: &'a AnsweredItem<'a>) -> Option<Self> {
        let ParticipantAnswer::Pair { choice } = answered.answer else { return None };
        let [a, b] = answered.shown_order();
        let conditions = [answered.condition_of_text(data, a)?, answered.condition_of_text(data, b)?];
        (conditions[0] != conditions[1]).then_some(Self { answered, choice: *choice, conditions })
    }

    /// Whether it compares these two conditions, in either order.
    fn is_about(&self, both: [usize; 2]) -> bool {
        self.conditions == both || self.conditions == [both[1], both[0]]
    }

    fn winning_condition(&self) -> Option<usize> {
        match self.choice {
            PairChoice::A => Some(self.conditions[0]),
            PairChoice::B => Some(self.conditions[1]),
            PairChoice::Tie | PairChoice::Bad => None,
        }
    }

    fn answer_with_value(&self, value: f64) -> wayword_metrics::StudyAnswer<usize, u32> {
        wayword_metrics::StudyAnswer { person: self.answered.person, item: self.answered.item.route, value }
    }

    /// 1 where A was preferred and 0 where B was.
    fn side_preference(&self) -> Option<wayword_metrics::StudyAnswer<usize, u32>> {
        match self.choice {
            PairChoice::A => Some(self.answer_with_value(1.0)),
            PairChoice::B => Some(self.answer_with_value(0.0)),
            PairChoice::Tie | PairChoice::Bad => None,
        }
    }
}

/// The row of two conditions; `None` if they were never compared.
fn pair_row(data: &StudyData, compared: &[PairAnswer<'_>], both: [usize; 2]) -> Option<PairRow> {
    let matching: Vec<&PairAnswer<'_>> = compared.iter().filter(|one| one.is_about(both)).collect();
    let gain = |one: &&PairAnswer<'_>| {
        one.answer_with_value(one.winning_condition().map_or(0.5, |winner| f64::from(u8::from(winner == both[0]))))
    };
    let wins = |condition| matching.iter().filter(|one| one.winning_condition() == Some(condition)).count();
    let chosen = |choice| matching.iter().filter(|one| one.choice == choice).count();
    let name = |at: usize| data.plan.conditions[at].name.clone();
    (!matching.is_empty()).then(|| PairRow {
        first: name(both[0]),
        second: name(both[1]),
        first_wins: wins(both[0]),
        second_wins: wins(both[1]),
        ties: chosen(PairChoice::Tie),
        both_bad: chosen(PairChoice::Bad),
        share: answer_share(&matching.iter().map(gain).collect::<Vec<_>>(), CONFIDENCE_LEVEL),
    })
}

fn condition_strengths(data: &StudyData, compared: &[PairAnswer<'_>]) -> ConditionStrengths {
    let name = |at: usize| data.plan.conditions[at].name.clone();
    let comparison = |one: &PairAnswer<'_>| SystemComparison {
        person: one.answered.person,
        item: one.answered.item.route,
        first: name(one.conditions[0]),
        second: name(one.conditions[1]),
        preference: match one.choice {
            PairChoice::A => PairPreference::First,
            PairChoice::B => PairPreference::Second,
            PairChoice::Tie => PairPreference::Tie,
            PairChoice::Bad => PairPreference::BothBad,
        },
    };
    match bradley_terry(&compared.iter().map(comparison).collect::<Vec<_>>(), CONFIDENCE_LEVEL) {
        Ok(known) => ConditionStrengths::Known(known),
        Err(reason) => ConditionStrengths::Unknown { why: reason.to_string(), reason },
    }
}
