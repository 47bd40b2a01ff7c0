//! The results of a robustness run, as they are stored in `robustness.json`.

use serde::{Deserialize, Serialize};
use wayword_metrics::MeanEstimate;
use wayword_robustness::ratio::RobustnessRatio;

/// How many of the texts that were written again in the unchanged world are equal to the run's own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RepeatedTexts {
    /// The number of equal texts.
    pub equal: usize,
    /// The number of texts that were written again.
    pub of: usize,
}

/// All results of a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RobustnessResults {
    /// The platform of the run.
    pub platform: String,
    /// Who answered and who wrote, in words.
    pub roles: String,
    /// Number of paths.
    pub paths: usize,
    /// Number of scenes.
    pub scenes: usize,
    /// How many of the texts of the unchanged world are those of the run.
    pub again: RepeatedTexts,
    /// The agent that walks by the texts; its success is compared.
    pub agent: String,
    /// Level of the intervals.
    pub level: f64,
    /// The results of each style.
    pub styles: Vec<StyleResults>,
    /// Changes that make no sense on this platform, each with the reason.
    pub refused: Vec<RefusedChange>,
}

/// A change that was not made.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RefusedChange {
    /// The change with its dose.
    pub change: String,
    /// Why it was not made.
    pub reason: String,
}

/// The results for the texts of one style.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StyleResults {
    /// Name of the style.
    pub style: String,
    /// Changes that are measured by R, in the order in which they were asked for.
    pub changes: Vec<ChangeResults>,
    /// Changes with an exact expectation.
    pub expectations: Vec<ExpectationResult>,
    /// The dose curve of each change with several doses.
    pub curves: Vec<DoseCurve>,
}

/// The results for one change: how much it matters to the texts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ChangeResults {
    /// The change with its dose: `camera_height_m=0.3`.
    pub change: String,
    /// Paths with a text in the unchanged and the changed world.
    pub paths: usize,
    /// Paths with a text that failed only in the changed world.
    pub lost: usize,
    /// R of landmarks, turns, rooms and floors, and of their mean.
    pub figures: Vec<RobustnessFigure>,
    /// Change of the agent's success rate: changed less unchanged.
    pub success: Option<MeanEstimate>,
    /// Pairs of texts from the unchanged and the changed world.
    pub examples: Vec<TextPairExample>,
}

/// R of one kind of statement, with the agreements that it is made of.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RobustnessFigure {
    /// `landmarks`, `turns`, `rooms`, `floors` or `mean`.
    pub kind: String,
    /// R with its interval; `None` where it cannot be computed.
    pub r: Option<MeanEstimate>,
    /// The reason why there is no R.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    /// Agreement of the unchanged world's text with that of the changed world.
    pub(crate) changed: Option<f64>,
    /// Agreement with the text that was written once more in the unchanged world.
    pub(crate) repeat: Option<f64>,
    /// Agreement with the text of another path.
    pub(crate) other: Option<f64>,
}

/// An exact expectation, and how many texts keep it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ExpectationResult {
    /// The change with its dose.
    pub change: String,
    /// The property that has to hold, in words.
    pub expected: String,
    /// Texts that mention the thing.
    pub told: usize,
    /// The number of these texts that have the property.
    pub holds: usize,
    /// Texts without the property, with the difference.
    pub examples: Vec<TextPairExample>,
}

/// Two texts of one path.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TextPairExample {
    /// The id of the path.
    pub path: String,
    /// The text of the unchanged world.
    pub before: String,
    /// The text of the changed world.
    pub after: String,
    /// The difference, in words.
    pub note: String,
}

/// R of the mean of all kinds of statements, at each dose of a change.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DoseCurve {
    /// The change without its dose.
    pub change: String,
    /// The dose without any effect, where there is one.
    pub unchanged: Option<f64>,
    /// Dose, and R with its interval where there is one.
    pub points: Vec<(f64, Option<MeanEstimate>)>,
    /// How much R changes for each unit of the dose; `None` for a single point.
    pub slope: Option<f64>,
    /// The doses at which R falls below 0.8, below and above the unchanged one where there is one.
    pub falls_at: Vec<f64>,
}

impl From<RobustnessRatio> for RobustnessFigure {
    fn from(found: RobustnessRatio) -> Self {
        let RobustnessRatio { kind, r, reason, changed, again, other, .. } = found;
        Self { kind, r, reason, changed, repeat: again, other }
    }
}

impl ExpectationResult {
    /// The share of texts that have the property; `None` if no text mentions the thing.
    pub fn share_that_holds(&self) -> Option<f64> {
        (self.told > 0).then(|| self.holds as f64 / self.told as f64)
    }
}
