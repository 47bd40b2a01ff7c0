//! What a robustness run found, as `robustness.json` has it.

use super::base::Again;
use serde::{Deserialize, Serialize};
use wayword_metrics::Estimate;
use wayword_robustness::ratio::Robustness;

/// Everything that was found.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Results {
    /// The platform of the run.
    pub(crate) platform: String,
    /// Who saw, and who wrote.
    pub(crate) roles: String,
    /// Number of paths, and of scenes.
    pub(crate) paths: usize,
    pub(crate) scenes: usize,
    /// How many of the texts of the unchanged world are those of the run.
    pub(crate) again: Again,
    /// The agent whose success is compared.
    pub(crate) agent: String,
    /// Level of the intervals.
    pub(crate) level: f64,
    /// One for each style.
    pub(crate) styles: Vec<OfStyle>,
    /// Changes that mean nothing here, each with the reason.
    pub(crate) refused: Vec<Refused>,
}

/// A change that was not made.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Refused {
    pub(crate) change: String,
    pub(crate) reason: String,
}

/// What was found of the texts of one style.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct OfStyle {
    pub(crate) style: String,
    /// Changes that are measured by R, in the order in which they were asked for.
    pub(crate) changes: Vec<OfChange>,
    /// Changes with an exact expectation.
    pub(crate) expectations: Vec<Expectation>,
    /// One for each change with several doses.
    pub(crate) curves: Vec<Curve>,
}

/// How much a change changes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct OfChange {
    /// The change with its dose: `camera_height_m=0.3`.
    pub(crate) change: String,
    /// Paths with a text in the unchanged and the changed world.
    pub(crate) paths: usize,
    /// Paths whose text failed in the changed world alone.
    pub(crate) lost: usize,
    /// Of landmarks, turns, rooms, floors, and their mean.
    pub(crate) figures: Vec<Figure>,
    /// Change of the agent's success rate: changed less unchanged.
    pub(crate) success: Option<Estimate>,
    /// Texts beside each other.
    pub(crate) examples: Vec<Example>,
}

/// R of one kind of statement, with the agreements that it is made of.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Figure {
    /// `landmarks`, `turns`, `rooms`, `floors` or `mean`.
    pub(crate) kind: String,
    pub(crate) r: Option<Estimate>,
    /// Why there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    /// Agreement with the text of the changed world, of the same run once more, and of another path.
    pub(crate) changed: Option<f64>,
    pub(crate) repeat: Option<f64>,
    pub(crate) other: Option<f64>,
}

/// An exact expectation, and how many texts keep it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Expectation {
    pub(crate) change: String,
    /// What has to hold.
    pub(crate) expected: String,
    /// Texts in which the thing was told.
    pub(crate) told: usize,
    /// Those of them that keep it.
    pub(crate) holds: usize,
    /// Texts that do not, with what differs.
    pub(crate) examples: Vec<Example>,
}

/// Two texts of one path.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Example {
    pub(crate) path: String,
    pub(crate) before: String,
    pub(crate) after: String,
    /// What differs.
    pub(crate) note: String,
}

/// R of the mean over doses.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Curve {
    /// The change without its dose.
    pub(crate) change: String,
    /// The dose at which nothing changes, where there is one.
    pub(crate) unchanged: Option<f64>,
    /// Dose, and R with its interval where there is one.
    pub(crate) points: Vec<(f64, Option<Estimate>)>,
    /// Change of R for one more of the dose's unit; `None` of a single point.
    pub(crate) slope: Option<f64>,
    /// The doses at which R falls below 0.8, below and above the unchanged one where there is one.
    pub(crate) falls_at: Vec<f64>,
}

impl From<Robustness> for Figure {
    fn from(found: Robustness) -> Self {
        let Robustness { kind, r, reason, changed, again, other, .. } = found;
        Self { kind, r, reason, changed, repeat: again, other }
    }
}

impl Expectation {
    /// The share of the texts that keep it; `None` where the thing was never told.
    pub(crate) fn share(&self) -> Option<f64> {
        (self.told > 0).then(|| self.holds as f64 / self.told as f64)
    }
}
