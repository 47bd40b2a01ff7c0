//! Evaluates comparisons of two texts: wins and ties for each pair of conditions, and a strength for each condition by the model of
//! Bradley and Terry.

use super::{LEVEL, given::Answered};
use crate::{Answer, Choice, Data};
use serde::Serialize;
use wayword_metrics::{BradleyTerry, Comparison, Figure, NoStrength, Preference, bradley_terry, share};

/// The results of all comparisons.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Pairs {
    /// One for each two conditions that were compared.
    pub rows: Vec<PairRow>,
    /// The share of preferences for the text shown as A. It is near a half unless people favour one side of the page.
    pub side: Option<Figure>,
    /// Strengths of the conditions, or why there are none.
    pub strengths: Strengths,
}

/// The comparisons between two conditions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairRow {
    /// The one that comes first in the plan.
    pub first: String,
    /// The other one.
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
    pub share: Option<Figure>,
}

/// Strengths by the model of Bradley and Terry, or why there are none.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Strengths {
    /// The strengths.
    Known(BradleyTerry<String>),
    /// Why there are none.
    Unknown {
        /// In words.
        why: String,
        /// As a value.
        reason: NoStrength,
    },
}

/// The answer to a comparison, with the indices of the conditions of both texts.
struct Compared<'a> {
    answered: &'a Answered<'a>,
    choice: Choice,
    /// As shown: A, then B.
    conditions: [usize; 2],
}

impl Pairs {
    pub(super) fn new(data: &Data, taken: &[&Answered<'_>]) -> Self {
        let compared: Vec<Compared<'_>> = taken.iter().filter_map(|one| Compared::new(data, one)).collect();
        let count = data.plan.conditions.len();
        let both = (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second]));
        Self {
            rows: both.filter_map(|both| row(data, &compared, both)).collect(),
            side: share(&compared.iter().filter_map(Compared::side).collect::<Vec<_>>(), LEVEL),
            strengths: strengths(data, &compared),
        }
    }
}

impl<'a> Compared<'a> {
    /// `None` if both texts have the same condition: that comparison does not help to compare conditions.
    fn new(data: &Data, answered: &'a Answered<'a>) -> Option<Self> {
        let Answer::Pair { choice } = answered.answer else { return None };
        let [a, b] = answered.sides();
        let conditions = [answered.condition(data, a)?, answered.condition(data, b)?];
        (conditions[0] != conditions[1]).then_some(Self { answered, choice: *choice, conditions })
    }

    fn is_of(&self, both: [usize; 2]) -> bool {
        self.conditions == both || self.conditions == [both[1], both[0]]
    }

    fn winner(&self) -> Option<usize> {
        match self.choice {
            Choice::A => Some(self.conditions[0]),
            Choice::B => Some(self.conditions[1]),
            Choice::Tie | Choice::Bad => None,
        }
    }

    fn value(&self, value: f64) -> wayword_metrics::Answer<usize, u32> {
        wayword_metrics::Answer { person: self.answered.person, item: self.answered.item.route, value }
    }

    /// 1 where A was preferred and 0 where B was.
    fn side(&self) -> Option<wayword_metrics::Answer<usize, u32>> {
        match self.choice {
            Choice::A => Some(self.value(1.0)),
            Choice::B => Some(self.value(0.0)),
            Choice::Tie | Choice::Bad => None,
        }
    }
}

fn row(data: &Data, compared: &[Compared<'_>], both: [usize; 2]) -> Option<PairRow> {
    let own: Vec<&Compared<'_>> = compared.iter().filter(|one| one.is_of(both)).collect();
    let gain =
        |one: &&Compared<'_>| one.value(one.winner().map_or(0.5, |winner| f64::from(u8::from(winner == both[0]))));
    let wins = |condition| own.iter().filter(|one| one.winner() == Some(condition)).count();
    let chosen = |choice| own.iter().filter(|one| one.choice == choice).count();
    let name = |at: usize| data.plan.conditions[at].name.clone();
    (!own.is_empty()).then(|| PairRow {
        first: name(both[0]),
        second: name(both[1]),
        first_wins: wins(both[0]),
        second_wins: wins(both[1]),
        ties: chosen(Choice::Tie),
        both_bad: chosen(Choice::Bad),
        share: share(&own.iter().map(gain).collect::<Vec<_>>(), LEVEL),
    })
}

fn strengths(data: &Data, compared: &[Compared<'_>]) -> Strengths {
    let name = |at: usize| data.plan.conditions[at].name.clone();
    let comparison = |one: &Compared<'_>| Comparison {
        person: one.answered.person,
        item: one.answered.item.route,
        first: name(one.conditions[0]),
        second: name(one.conditions[1]),
        preference: match one.choice {
            Choice::A => Preference::First,
            Choice::B => Preference::Second,
            Choice::Tie => Preference::Tie,
            Choice::Bad => Preference::BothBad,
        },
    };
    match bradley_terry(&compared.iter().map(comparison).collect::<Vec<_>>(), LEVEL) {
        Ok(known) => Strengths::Known(known),
        Err(reason) => Strengths::Unknown { why: reason.to_string(), reason },
    }
}
