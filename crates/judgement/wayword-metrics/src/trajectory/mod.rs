//! The figures of vision-and-language navigation (success, SPL, nDTW and others): how well an agent's trajectory over a viewpoint
//! graph meets the demand of its episode.

mod distance_atlas;
mod distances;
mod episode_scorer;
mod fidelity;
mod numbered_viewpoints;
mod score;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod trajectory_error;
mod walk_survey;

pub use distance_atlas::DistanceAtlas;
pub use distances::SceneDistances;
pub use episode_scorer::EpisodeScorer;
pub use score::score_trajectory;
pub use trajectory_error::{TrajectoryError, find_problems};
pub use walk_survey::{GraphRoute, WalkSurvey, survey_walks};

use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use wayword_core::{ObjectId, ViewpointId};

/// The rule that decides what counts as success. Every figure is shown with its rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrajectorySuccessRule {
    /// The last viewpoint lies under 3 m (graph distance, strictly) from the goal (R2R, `tasks/R2R/eval.py`). On a REVERIE item this is
    /// the lenient rule.
    Distance,
    /// The target object is visible from the last viewpoint (REVERIE, `tasks/REVERIE/eval_release.py`).
    Visible,
}

/// The demand of an episode: the annotated path, and the target object if there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeDemand {
    /// The annotated path, from start to goal; never empty.
    pub reference: Vec<ViewpointId>,
    /// The target object, where one is named.
    pub object: Option<ObjectId>,
    /// The viewpoints from which it can be seen; `None` where no object is named, or where that is not known.
    pub visible_from: Option<BTreeSet<ViewpointId>>,
}

/// A trajectory to score.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentTrajectory {
    /// Every viewpoint, from the start; a stay is the same one again. Never empty.
    pub viewpoints: Vec<ViewpointId>,
    /// The object that the agent takes for the target.
    pub object: Option<ObjectId>,
}

/// All figures of one trajectory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryScore {
    /// Length over the graph, metres.
    pub length_m: f64,
    /// Distance from the last viewpoint to the goal, metres; `None` where there is no way.
    pub navigation_error_m: Option<f64>,
    /// The same from the viewpoint of the trajectory that is nearest to the goal.
    pub oracle_error_m: Option<f64>,
    /// By the distance rule.
    pub distance: SuccessOutcome,
    /// By the rule of visibility; `None` if the episode names no object, or it is not known from where the object is visible.
    pub visible: Option<SuccessOutcome>,
    /// Whether the agent named the target object; `None` if the episode has none.
    pub grounding: Option<TargetGrounding>,
    /// Normalised dynamic time warping, in [0, 1].
    pub ndtw: f64,
    /// Coverage weighted by length score, in [0, 1].
    pub cls: f64,
}

/// The figures of a trajectory that depend on the rule of success.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SuccessOutcome {
    /// At the last viewpoint.
    pub success: bool,
    /// At any viewpoint, the start included.
    pub oracle_success: bool,
    /// Success weighted by path length, at most 1, and 0 without success.
    pub spl: f64,
    /// nDTW where it is a success, else 0.
    pub sdtw: f64,
}

/// Whether the right object was named.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TargetGrounding {
    /// Remote grounding success, whatever the navigation.
    pub rgs: bool,
    /// The same weighted by path length, as in SPL.
    pub rgspl: f64,
}

/// A figure of a trajectory, by its usual name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrajectoryMetric {
    /// SR, success rate.
    SuccessRate,
    /// OSR, oracle success rate.
    OracleSuccessRate,
    /// SPL, success weighted by path length.
    Spl,
    /// NE, navigation error, metres.
    NavigationErrorM,
    /// TL, trajectory length, metres.
    TrajectoryLengthM,
    /// nDTW, normalised dynamic time warping.
    Ndtw,
    /// SDTW, success weighted by normalised dynamic time warping.
    Sdtw,
    /// CLS, coverage weighted by length score.
    Cls,
    /// RGS, remote grounding success.
    Rgs,
    /// RGSPL, remote grounding success weighted by path length.
    Rgspl,
}

impl TrajectoryMetric {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 10] = [
        Self::SuccessRate,
        Self::OracleSuccessRate,
        Self::Spl,
        Self::NavigationErrorM,
        Self::TrajectoryLengthM,
        Self::Ndtw,
        Self::Sdtw,
        Self::Cls,
        Self::Rgs,
        Self::Rgspl,
    ];

    /// Its abbreviation in tables.
    #[must_use]
    pub fn table_name(self) -> &'static str {
        match self {
            Self::SuccessRate => "SR",
            Self::OracleSuccessRate => "OSR",
            Self::Spl => "SPL",
            Self::NavigationErrorM => "NE (m)",
            Self::TrajectoryLengthM => "TL (m)",
            Self::Ndtw => "nDTW",
            Self::Sdtw => "SDTW",
            Self::Cls => "CLS",
            Self::Rgs => "RGS",
            Self::Rgspl => "RGSPL",
        }
    }
}

impl TrajectoryScore {
    /// A figure by its name. Figures that depend on success use `rule`. `None` where the trajectory has none: a goal
    /// that cannot be reached, an episode without an object, a rule that cannot be applied.
    #[must_use]
    pub fn get(&self, metric: TrajectoryMetric, rule: TrajectorySuccessRule) -> Option<f64> {
        let outcome = match rule {
            TrajectorySuccessRule::Distance => Some(self.distance),
            TrajectorySuccessRule::Visible => self.visible,
        };
        let share = |is: bool| f64::from(u8::from(is));
        match metric {
            TrajectoryMetric::SuccessRate => outcome.map(|outcome| share(outcome.success)),
            TrajectoryMetric::OracleSuccessRate => outcome.map(|outcome| share(outcome.oracle_success)),
            TrajectoryMetric::Spl => outcome.map(|outcome| outcome.spl),
            TrajectoryMetric::Sdtw => outcome.map(|outcome| outcome.sdtw),
            TrajectoryMetric::NavigationErrorM => self.navigation_error_m,
            TrajectoryMetric::TrajectoryLengthM => Some(self.length_m),
            TrajectoryMetric::Ndtw => Some(self.ndtw),
            TrajectoryMetric::Cls => Some(self.cls),
            TrajectoryMetric::Rgs => self.grounding.map(|grounding| share(grounding.rgs)),
            TrajectoryMetric::Rgspl => self.grounding.map(|grounding| grounding.rgspl),
        }
    }
}
