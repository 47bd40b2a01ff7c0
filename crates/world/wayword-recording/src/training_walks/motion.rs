//! The motion along a walk of training data: counted from its actions, or read from a table of poses.

use crate::track::{CameraTrack, TrackFix};
use std::path::PathBuf;
use wayword_core::{AgentAction, DVec3, Heading, PlatformError};

/// Length of a step, metres, and angle of a turn, degrees, that the actions of StreamVLN and NaVILA mean.
const STEP_M: f64 = 0.25;
const TURN_DEG: f64 = 15.0;

/// What is known of the motion along a walk.
pub(super) enum WalkMotion {
    /// The agent's actions, one after each picture.
    Actions(Vec<AgentAction>),
    /// A column of poses in a table, one for each picture.
    #[cfg(feature = "lerobot")]
    Poses(super::pose_column::PoseColumn),
    /// Nothing.
    Unknown,
}

impl WalkMotion {
    /// The track of the camera; `None` if the motion is unknown.
    ///
    /// # Errors
    /// When the table of poses cannot be read.
    pub(super) fn read_track(&self, times_s: &[f64]) -> Result<Option<CameraTrack>, PlatformError> {
        let stances = match self {
            Self::Actions(actions) => stances_along(actions),
            #[cfg(feature = "lerobot")]
            Self::Poses(column) => column.read_stances()?,
            Self::Unknown => return Ok(None),
        };
        let fix = |(time_s, (position, heading)): (&f64, (DVec3, Option<Heading>))| TrackFix {
            time_s: *time_s,
            position,
            heading,
        };
        Ok(CameraTrack::new(times_s.iter().zip(stances).map(fix).collect()))
    }

    /// What the user should know of it.
    pub(super) fn remark(&self) -> Option<String> {
        match self {
            Self::Actions(_) => Some(format!(
                "poses are counted from the actions: steps of {STEP_M} m and turns of {TURN_DEG} degrees, as if nothing stood in the way"
            )),
            _ => None,
        }
    }

    /// The files that it is read from, beside the list of walks.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        match self {
            #[cfg(feature = "lerobot")]
            Self::Poses(column) => vec![column.table.clone()],
            _ => Vec::new(),
        }
    }
}

/// Where the agent stands and looks before each action, from a start at the origin that looks north.
fn stances_along(actions: &[AgentAction]) -> Vec<(DVec3, Option<Heading>)> {
    let (mut position, mut turns) = (DVec3::ZERO, 0_i32);
    let mut stances = Vec::with_capacity(actions.len());
    for action in actions {
        let heading_rad = (f64::from(turns) * TURN_DEG).to_radians();
        stances.push((position, Heading::new(heading_rad).ok()));
        match action {
            AgentAction::Forward => {
                position += DVec3::new(libm::sin(heading_rad), libm::cos(heading_rad), 0.0) * STEP_M;
            }
            AgentAction::Left => turns -= 1,
            AgentAction::Right => turns += 1,
            AgentAction::Stop => {}
        }
    }
    stances
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_turns_to_the_left_and_a_step_lead_west() {
        let actions: Vec<AgentAction> =
            [2, 2, 2, 2, 2, 2, 1, 0].map(|number| AgentAction::try_from(number).unwrap()).to_vec();
        let stances = stances_along(&actions);
        assert_eq!(stances.len(), 8);
        let (end, heading) = stances[7];
        assert!(end.distance(DVec3::new(-0.25, 0.0, 0.0)) < 1e-9, "{end}");
        assert!((heading.unwrap().rad() - 1.5 * std::f64::consts::PI).abs() < 1e-9);
    }
}
