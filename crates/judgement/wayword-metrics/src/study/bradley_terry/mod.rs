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

mod fit;
mod links;
mod reason;

use super::crossed::{Groups, Parts};
use super::{Interval, is_level, quantile};
use fit::{Fit, Outcome, Pair};
pub use reason::NoStrength;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fmt::Display;

/// A person's preference between two texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Preference {
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
pub struct Comparison<P, I, S> {
    /// The person.
    pub person: P,
    /// The item.
    pub item: I,
    /// The system that was shown first.
    pub first: S,
    /// The system that was shown second.
    pub second: S,
    /// The person's preference.
    pub preference: Preference,
}

/// A parameter on the logarithmic scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Its most likely value.
    pub value: f64,
    /// Its standard error, clustered by persons and items.
    pub se: f64,
    /// Its interval.
    pub interval: Interval,
}

/// A system with its strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Strength<S> {
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
    pub term: Term,
}

/// The strengths of systems by choices between them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BradleyTerry<S> {
    /// The systems, the strongest first. Their strengths sum to 0.
    pub strengths: Vec<Strength<S>>,
    /// The logarithm of the odds that a system gains by being shown first.
    pub side: Term,
    /// The logarithm of Davidson's parameter; `None` where no choice was a tie.
    pub tie: Option<Term>,
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
    comparisons: &[Comparison<P, I, S>],
    level: f64,
) -> Result<BradleyTerry<S>, NoStrength> {
    if comparisons.iter().any(|one| one.first == one.second) {
        return Err(NoStrength::Itself);
    }
    let systems: BTreeSet<&S> = comparisons.iter().flat_map(|one| [&one.first, &one.second]).collect();
    let systems: Vec<&S> = systems.into_iter().collect();
    let pairs: Vec<Pair> = comparisons.iter().map(|one| pair(one, &systems)).collect();
    links::check(&pairs, &systems)?;
    let fit = Fit::of(&pairs, systems.len())?;
    let groups = Groups::of(comparisons.iter().map(|one| (&one.person, &one.item)));
    let errors = Errors { fit: &fit, pairs: &pairs, groups, level };
    let mut strengths = Vec::with_capacity(systems.len());
    for (at, system) in systems.iter().enumerate() {
        strengths.push(counted(comparisons, system, errors.term(&fit.strength(at))?));
    }
    strengths.sort_by(|a, b| b.term.value.total_cmp(&a.term.value));
    let Parts { persons, items, .. } = errors.parts(&fit.side());
    Ok(BradleyTerry {
        strengths,
        side: errors.term(&fit.side())?,
        tie: fit.tie().map(|direction| errors.term(&direction)).transpose()?,
        comparisons: comparisons.len(),
        persons,
        items,
    })
}

fn pair<P, I, S: Ord>(of: &Comparison<P, I, S>, systems: &[&S]) -> Pair {
    let place = |system: &S| systems.partition_point(|one| *one < system);
    let outcome = match of.preference {
        Preference::First => Outcome::First,
        Preference::Second => Outcome::Second,
        Preference::Tie | Preference::BothBad => Outcome::Tie,
    };
    Pair { first: place(&of.first), second: place(&of.second), outcome }
}

fn counted<P, I, S: Ord + Clone>(comparisons: &[Comparison<P, I, S>], system: &S, term: Term) -> Strength<S> {
    let mut strength = Strength { system: system.clone(), wins: 0, losses: 0, ties: 0, both_bad: 0, term };
    for one in comparisons.iter().filter(|one| one.first == *system || one.second == *system) {
        match one.preference {
            Preference::Tie => strength.ties += 1,
            Preference::BothBad => {
                strength.ties += 1;
                strength.both_bad += 1;
            }
            Preference::First | Preference::Second => {
                let is_won = (one.preference == Preference::First) == (one.first == *system);
                strength.wins += usize::from(is_won);
                strength.losses += usize::from(!is_won);
            }
        }
    }
    strength
}

/// Computes the standard errors of a fit, clustered by persons and items.
struct Errors<'a> {
    fit: &'a Fit,
    pairs: &'a [Pair],
    groups: Groups,
    level: f64,
}

impl Errors<'_> {
    /// The parts of the variance of the sum of parameters weighted by `direction`. It is the sandwich estimate, clustered over the
    /// contributions of single choices to the error.
    fn parts(&self, direction: &[f64]) -> Parts {
        self.groups.parts(&self.fit.influence(direction, self.pairs), direction.len())
    }

    fn term(&self, direction: &[f64]) -> Result<Term, NoStrength> {
        let parts = self.parts(direction);
        let quantile = quantile::student(0.5 + self.level / 2.0, parts.fewest() - 1);
        let t = quantile.filter(|_| is_level(self.level)).ok_or(NoStrength::OneSource)?;
        let (value, se) = (self.fit.value(direction), parts.variance().sqrt());
        Ok(Term { value, se, interval: Interval { low: value - t * se, high: value + t * se } })
    }
}

#[cfg(test)]
mod tests;
