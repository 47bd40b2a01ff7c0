//! How strong systems are, by people's choices between two of them.
//!
//! Bradley and Terry (1952) with Davidson's ties (1970) and a term for the side that is shown first (Davidson and Beaver 1977).
//! With strengths a and b as logarithms, a shown first, s for the side and t for ties, the three outcomes have odds
//!
//! ```text
//! first : second : tie  =  e^(a + s) : e^b : e^(t + (a + b + s) / 2)
//! ```
//!
//! The answer "both bad" counts as a tie, because it prefers neither. It is also counted separately.

mod connectedness;
mod fit;
mod no_strength;

use super::crossed::{AnswerGroups, VarianceParts};
use super::{ConfidenceInterval, is_level, quantile};
use fit::{ChoiceOutcome, StrengthFit, SystemPair};
pub use no_strength::NoStrength;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt::Display;

/// A person's preference between two texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairPreference {
    /// The one that was shown first is better.
    First,
    /// The one that was shown second is better.
    Second,
    /// Neither is better.
    Tie,
    /// Neither is better, and both are bad. It counts as a tie.
    BothBad,
}

/// A choice between two systems' texts of one item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SystemComparison<P, I, S> {
    /// The person.
    pub person: P,
    /// The item.
    pub item: I,
    /// The system that was shown first.
    pub first: S,
    /// The system that was shown second.
    pub second: S,
    /// The person's preference.
    pub preference: PairPreference,
}

/// A parameter on the logarithmic scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FittedTerm {
    /// Its most likely value.
    pub value: f64,
    /// Its standard error, clustered by persons and items.
    pub se: f64,
    /// Its interval.
    pub interval: ConfidenceInterval,
}

/// A system with its strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SystemStrength<S> {
    /// The system.
    pub system: S,
    /// How often it was preferred.
    pub wins: usize,
    /// How often the other was preferred.
    pub losses: usize,
    /// How often neither was preferred, including "both bad".
    pub ties: usize,
    /// How often both were called bad.
    pub both_bad: usize,
    /// The logarithm of its strength, relative to the mean of all systems.
    pub term: FittedTerm,
}

/// The strengths of systems by choices between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BradleyTerry<S> {
    /// The systems, the strongest first. Their strengths sum to 0.
    pub strengths: Vec<SystemStrength<S>>,
    /// The logarithm of the odds that a system gains by being shown first.
    pub side: FittedTerm,
    /// The logarithm of Davidson's parameter; `None` where no choice was a tie.
    pub tie: Option<FittedTerm>,
    /// How many choices.
    pub comparisons: usize,
    /// How many persons made them.
    pub persons: usize,
    /// How many items they are about.
    pub items: usize,
}

/// The most likely strengths (Newton's method), each with an interval from a sandwich that is clustered by persons and items.
///
/// # Errors
/// Why the choices give no strengths.
pub fn bradley_terry<P: Ord, I: Ord, S: Ord + Clone + Display>(
    comparisons: &[SystemComparison<P, I, S>],
    level: f64,
) -> Result<BradleyTerry<S>, NoStrength> {
    if comparisons.iter().any(|comparison| comparison.first == comparison.second) {
        return Err(NoStrength::Itself);
    }
    let systems: BTreeSet<&S> =
        comparisons.iter().flat_map(|comparison| [&comparison.first, &comparison.second]).collect();
    let systems: Vec<&S> = systems.into_iter().collect();
    let pairs: Vec<SystemPair> = comparisons.iter().map(|comparison| numbered_pair(comparison, &systems)).collect();
    connectedness::check_connected(&pairs, &systems)?;
    let fit = StrengthFit::from_pairs(&pairs, systems.len())?;
    let groups = AnswerGroups::from_pairs(comparisons.iter().map(|comparison| (&comparison.person, &comparison.item)));
    let errors = FitErrors { fit: &fit, pairs: &pairs, groups, level };
    let mut strengths = Vec::with_capacity(systems.len());
    for (at, system) in systems.iter().enumerate() {
        strengths.push(count_choices(comparisons, system, errors.fitted_term(&fit.strength_direction(at))?));
    }
    strengths.sort_by(|a, b| b.term.value.total_cmp(&a.term.value));
    let VarianceParts { persons, items, .. } = errors.variance_parts(&fit.side_direction());
    Ok(BradleyTerry {
        strengths,
        side: errors.fitted_term(&fit.side_direction())?,
        tie: fit.tie_direction().map(|direction| errors.fitted_term(&direction)).transpose()?,
        comparisons: comparisons.len(),
        persons,
        items,
    })
}

/// A choice with its systems by number. `systems` are in order.
fn numbered_pair<P, I, S: Ord>(comparison: &SystemComparison<P, I, S>, systems: &[&S]) -> SystemPair {
    let number = |system: &S| systems.partition_point(|other| *other < system);
    let outcome = match comparison.preference {
        PairPreference::First => ChoiceOutcome::First,
        PairPreference::Second => ChoiceOutcome::Second,
        PairPreference::Tie | PairPreference::BothBad => ChoiceOutcome::Tie,
    };
    SystemPair { first: number(&comparison.first), second: number(&comparison.second), outcome }
}

/// A system with its strength, and how its choices ended.
fn count_choices<P, I, S: Ord + Clone>(
    comparisons: &[SystemComparison<P, I, S>],
    system: &S,
    term: FittedTerm,
) -> SystemStrength<S> {
    let mut strength = SystemStrength { system: system.clone(), wins: 0, losses: 0, ties: 0, both_bad: 0, term };
    let is_about =
        |comparison: &&SystemComparison<P, I, S>| comparison.first == *system || comparison.second == *system;
    for comparison in comparisons.iter().filter(is_about) {
        match comparison.preference {
            PairPreference::Tie => strength.ties += 1,
            PairPreference::BothBad => {
                strength.ties += 1;
                strength.both_bad += 1;
            }
            PairPreference::First | PairPreference::Second => {
                let is_won = (comparison.preference == PairPreference::First) == (comparison.first == *system);
                strength.wins += usize::from(is_won);
                strength.losses += usize::from(!is_won);
            }
        }
    }
    strength
}

/// Computes the standard errors of a fit, clustered by persons and items.
struct FitErrors<'a> {
    fit: &'a StrengthFit,
    pairs: &'a [SystemPair],
    groups: AnswerGroups,
    level: f64,
}

impl FitErrors<'_> {
    /// The parts of the variance of the sum of parameters weighted by `direction`. It is the sandwich estimate, clustered over the
    /// contributions of single choices to the error.
    fn variance_parts(&self, direction: &[f64]) -> VarianceParts {
        self.groups.variance_parts(&self.fit.choice_influences(direction, self.pairs), direction.len())
    }

    /// The sum of parameters weighted by `direction`, with its standard error and interval.
    fn fitted_term(&self, direction: &[f64]) -> Result<FittedTerm, NoStrength> {
        let parts = self.variance_parts(direction);
        let quantile = quantile::student_quantile(0.5 + self.level / 2.0, parts.fewest_groups().saturating_sub(1));
        let t = quantile.filter(|_| is_level(self.level) && parts.is_sample()).ok_or(NoStrength::OneSource)?;
        let (value, se) = (self.fit.value_along(direction), parts.variance().sqrt());
        Ok(FittedTerm { value, se, interval: ConfidenceInterval { low: value - t * se, high: value + t * se } })
    }
}

#[cfg(test)]
mod tests;
