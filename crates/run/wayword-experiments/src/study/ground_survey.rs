//! What the viewpoint graph of a study is worth: a file beside the plan, and lines on the screen.

use super::choose_paths::StudyWalk;
use serde::Serialize;
use std::fmt;
use wayword_core::Platform;
use wayword_metrics::{GraphRoute, WalkSurvey, survey_walks};
use wayword_run::error::CommandError;

/// The file in the folder of the study.
pub(super) const GROUND_FILE: &str = "ground.json";

/// The survey of the routes of a study.
#[derive(Debug, Serialize)]
pub(super) struct GroundSurvey(WalkSurvey);

impl GroundSurvey {
    /// Surveys the graphs that the walks of a study lie on.
    ///
    /// # Errors
    /// When a scene cannot be read.
    pub(super) fn of_walks(walks: &[StudyWalk], platform: &dyn Platform, seed: u64) -> Result<Self, CommandError> {
        let route =
            |walk: &StudyWalk| GraphRoute { scene: walk.path.scene.clone(), viewpoints: walk.viewpoints.clone() };
        let routes: Vec<GraphRoute> = walks.iter().map(route).collect();
        Ok(Self(survey_walks(platform, &routes, seed)?))
    }
}

impl fmt::Display for GroundSurvey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let survey = &self.0;
        write!(f, "graph: {} of {} steps of the paths are edges", survey.edge_steps, survey.route_steps)?;
        if survey.near_goal > 0 {
            let (arrived, near) = (survey.near_goal_arrived, survey.near_goal);
            write!(f, "; {arrived} of {near} places less than 3 m from a goal on foot count as success")?;
        }
        if let Some((median, p95)) = survey.detour_median.zip(survey.detour_p95) {
            write!(f, "; ways over it are {median:.2} times as long as on foot (median; 95 % under {p95:.2})")?;
        }
        if survey.random_walks > 0 {
            let share = 100.0 * survey.random_arrived as f64 / survey.random_walks as f64;
            write!(f, "\na walker who goes at random arrives in {share:.1} %")?;
        }
        Ok(())
    }
}
