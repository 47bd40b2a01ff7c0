//! Applies the exclusion rules of `study.toml` to answers, and counts what they leave out.

use super::judgements::{AnsweredItem, ParticipantFilter};
use crate::{
    ExclusionRules, ParticipantAnswer, StudyData,
    study::{FILM_NOT_WATCHED, TOO_FAST, TOO_FEW_MOVES},
};
use serde::Serialize;
use std::collections::BTreeSet;

/// How many answers a rule leaves out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ExclusionCount {
    /// The name of the rule, as in `answers.csv`.
    pub rule: &'static str,
    /// The rule in words.
    pub words: String,
    /// How many answers break it, of those of all participants who were not screened out.
    pub answers: usize,
    /// How many participants gave these.
    pub persons: usize,
    /// For how many answers it cannot be known whether they break it.
    pub unknown: usize,
}

/// Whether an answer counts in a version of the tables.
pub(super) fn counts_answer(
    filter: ParticipantFilter,
    answered: &AnsweredItem<'_>,
    data: &StudyData,
    most_failed: usize,
) -> bool {
    filter.accepts_participant(answered.participant, most_failed)
        && (filter != ParticipantFilter::Kept || broken_rules(answered, data).is_empty())
}

/// The names of the rules that an answer breaks.
pub(super) fn broken_rules(answered: &AnsweredItem<'_>, data: &StudyData) -> Vec<&'static str> {
    let rules = &data.settings.exclusions;
    rules
        .in_words()
        .into_iter()
        .map(|(rule, _)| rule)
        .filter(|rule| breaks_rule(answered, data, rule) == Some(true))
        .collect()
}

/// Whether an answer breaks a rule; `None` where that cannot be known.
fn breaks_rule(answered: &AnsweredItem<'_>, data: &StudyData, rule: &str) -> Option<bool> {
    let rules: &ExclusionRules = &data.settings.exclusions;
    let is_walk = matches!(answered.answer, ParticipantAnswer::Follow { .. });
    match rule {
        TOO_FAST => Some(answered.answer_seconds()? < rules.min_seconds_per_item),
        FILM_NOT_WATCHED if is_walk => Some(false),
        FILM_NOT_WATCHED => {
            let film = data.routes.get(answered.item.route as usize)?.film.len();
            let seen = f64::from(answered.slot.pictures_seen?);
            Some(film > 0 && seen < rules.min_share_of_film * film as f64)
        }
        TOO_FEW_MOVES => Some(is_walk && answered.slot.moves.len() < rules.min_moves_per_walk),
        _ => None,
    }
}

/// Counts what each rule leaves out.
pub(super) fn count_exclusions(data: &StudyData, answered: &[AnsweredItem<'_>]) -> Vec<ExclusionCount> {
    let is_counted = |one: &&AnsweredItem<'_>| one.participant.status != crate::ParticipantStatus::ScreenedOut;
    let count = |(rule, words): (&'static str, String)| {
        let (mut answers, mut persons, mut unknown) = (0, BTreeSet::new(), 0);
        for one in answered.iter().filter(is_counted) {
            match breaks_rule(one, data, rule) {
                Some(true) => {
                    answers += 1;
                    persons.insert(one.person);
                }
                Some(false) => {}
                None => unknown += 1,
            }
        }
        ExclusionCount { rule, words, answers, persons: persons.len(), unknown }
    };
    data.settings.exclusions.in_words().into_iter().map(count).collect()
}
