//! Rules by which the results leave out single answers: too fast, a film that was not watched, a walk without a step.

use serde::{Deserialize, Serialize};

/// The table `[exclusions]` of `study.toml`. A rule of 0 is not applied.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ExclusionRules {
    /// The fewest seconds from getting an item to its answer; in a walk, to stopping.
    pub min_seconds_per_item: f64,
    /// The smallest share of the pictures of a film that a participant has to have seen, 0 to 1. Without script the page cannot count
    /// them, and the rule is not applied.
    pub min_share_of_film: f64,
    /// The fewest moves of a walk.
    pub min_moves_per_walk: usize,
}

/// Longest time that a rule may demand, seconds.
const MAX_RULE_SECONDS: f64 = 3600.0;

impl ExclusionRules {
    /// Whether there is no rule.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// The first problem, as a sentence about a field.
    pub(super) fn check(&self) -> Result<(), String> {
        if !(0.0..=MAX_RULE_SECONDS).contains(&self.min_seconds_per_item) {
            return Err("exclusions.min_seconds_per_item: give 0 to 3600 seconds".to_owned());
        }
        if !(0.0..=1.0).contains(&self.min_share_of_film) {
            return Err("exclusions.min_share_of_film: give a share from 0 to 1".to_owned());
        }
        Ok(())
    }

    /// The rules, each with its name and in words.
    #[must_use]
    pub fn in_words(&self) -> Vec<(&'static str, String)> {
        let mut rules = Vec::new();
        if self.min_seconds_per_item > 0.0 {
            rules.push((TOO_FAST, format!("answered in less than {} seconds", self.min_seconds_per_item)));
        }
        if self.min_share_of_film > 0.0 {
            let share = (1000.0 * self.min_share_of_film).round() / 10.0;
            rules.push((FILM_NOT_WATCHED, format!("less than {share} % of the pictures of the film seen")));
        }
        if self.min_moves_per_walk > 0 {
            let noun = if self.min_moves_per_walk == 1 { "move" } else { "moves" };
            rules.push((TOO_FEW_MOVES, format!("a walk of fewer than {} {noun}", self.min_moves_per_walk)));
        }
        rules
    }
}

/// The names of the rules in files.
pub(crate) const TOO_FAST: &str = "too_fast";
/// See [`ExclusionRules::min_share_of_film`].
pub(crate) const FILM_NOT_WATCHED: &str = "film_not_watched";
/// See [`ExclusionRules::min_moves_per_walk`].
pub(crate) const TOO_FEW_MOVES: &str = "too_few_moves";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_told_in_words_and_numbers_outside_are_refused() {
        let rules = ExclusionRules { min_seconds_per_item: 2.5, min_share_of_film: 0.8, min_moves_per_walk: 1 };
        rules.check().unwrap();
        let words: Vec<String> = rules.in_words().into_iter().map(|(_, words)| words).collect();
        assert_eq!(words[0], "answered in less than 2.5 seconds");
        assert_eq!(words[1], "less than 80 % of the pictures of the film seen");
        assert!(ExclusionRules::default().is_empty() && ExclusionRules::default().in_words().is_empty());
        for (wrong, field) in [
            (ExclusionRules { min_seconds_per_item: f64::NAN, ..rules }, "min_seconds_per_item"),
            (ExclusionRules { min_seconds_per_item: -1.0, ..rules }, "min_seconds_per_item"),
            (ExclusionRules { min_share_of_film: 80.0, ..rules }, "min_share_of_film"),
        ] {
            assert!(wrong.check().unwrap_err().contains(field));
        }
    }
}
