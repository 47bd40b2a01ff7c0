//! The statistics of a study with people: shares, means, agreement and preferences of persons over items, with intervals.
//!
//! Persons and items are both samples: a figure should hold for other persons and other items. Answers of one person are not
//! independent, and neither are answers to one item, so the intervals cluster by both.

mod agreement;
mod bradley_terry;
mod crossed;
mod logit_normal;
mod power;
mod quantile;
mod wilson;

pub use agreement::{AnswerScale, RaterAgreement, krippendorff_alpha};
pub use bradley_terry::{
    BradleyTerry, FittedTerm, NoStrength, PairPreference, SystemComparison, SystemStrength, bradley_terry,
};
pub use crossed::{
    FigureDifference, IntervalMethod, StudyFigure, answer_mean, answer_share, mean_difference, share_difference,
};
pub use power::{PlannedAnswer, PlannedTest, PowerPlan, SimulatedPower, search_for_power};
use serde::{Deserialize, Serialize};
pub use wilson::wilson_interval;

/// One person's answer to one item.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StudyAnswer<P, I> {
    /// The person.
    pub person: P,
    /// The item.
    pub item: I,
    /// 0 or 1 for a share, any number for a mean, the level that was chosen for agreement.
    pub value: f64,
}

/// The ends of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConfidenceInterval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Whether a level is a share between 0 and 1.
fn is_level(level: f64) -> bool {
    level > 0.0 && level < 1.0
}
