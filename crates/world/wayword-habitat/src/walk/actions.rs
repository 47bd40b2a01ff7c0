//! The actions of an agent, and the position that each of them leads to.

use crate::ground::{Foothold, GroundStride, NavMeshGround};
use wayword_core::{AgentAction, DVec3, Heading};

/// Shortest and longest step forward, metres.
const FORWARD_M: std::ops::RangeInclusive<f64> = 0.01..=2.0;

/// How far an agent steps and turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AgentGait {
    forward_m: f64,
    turn_deg: f64,
}

/// Why steps or turns cannot be used for walking.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GaitError {
    /// The step is too short, too long, or not a number.
    #[error("a step of {0} m: it must be from 0.01 to 2 m long")]
    Forward(f64),
    /// No whole number of turns makes a half turn.
    #[error(
        "a turn of {0} degrees: it must be at least 1 degree, and a whole number of turns must make 180 degrees, as with 15 or 30"
    )]
    Turn(f64),
}

impl AgentGait {
    /// Steps of this length, and turns of this angle.
    ///
    /// # Errors
    /// When the step is not from 0.01 to 2 m long, or a half turn is not a whole number of turns.
    pub fn new(forward_m: f64, turn_deg: f64) -> Result<Self, GaitError> {
        if !FORWARD_M.contains(&forward_m) {
            return Err(GaitError::Forward(forward_m));
        }
        let turns = 180.0 / turn_deg;
        if !(1.0..=180.0).contains(&turn_deg) || (turns - turns.round()).abs() > 1e-9 {
            return Err(GaitError::Turn(turn_deg));
        }
        Ok(Self { forward_m, turn_deg })
    }

    /// Length of a step, metres.
    #[must_use]
    pub fn forward_m(self) -> f64 {
        self.forward_m
    }

    /// Angle of a turn, degrees.
    #[must_use]
    pub fn turn_deg(self) -> f64 {
        self.turn_deg
    }

    /// The number of turns in a half turn.
    pub(super) fn turns_around(self) -> i32 {
        (180.0 / self.turn_deg).round() as i32
    }
}

impl Default for AgentGait {
    /// VLN-CE's: 0.25 m and 15 degrees.
    fn default() -> Self {
        Self { forward_m: 0.25, turn_deg: 15.0 }
    }
}

/// Position and direction of an agent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AgentStance {
    /// Its place on the ground.
    pub foothold: Foothold,
    start: Heading,
    /// Turns to the right, less those to the left. The heading is computed from the start each time, so that no error adds up.
    turns: i32,
}

impl AgentStance {
    /// An agent at a place, that looks along a heading.
    #[must_use]
    pub fn new(foothold: Foothold, heading: Heading) -> Self {
        Self { foothold, start: heading, turns: 0 }
    }

    /// The direction in which the agent looks.
    #[must_use]
    pub fn heading(&self, gait: AgentGait) -> Heading {
        self.start.turned_by(f64::from(self.turns) * gait.turn_deg.to_radians())
    }

    /// The stance after a number of turns to the right; to the left if negative.
    pub(super) fn turned_by(self, turns: i32) -> Self {
        Self { turns: self.turns + turns, ..self }
    }

    /// The end of a step forward.
    pub(super) fn stride_ahead(&self, ground: &NavMeshGround, gait: AgentGait) -> GroundStride {
        let to: DVec3 = self.foothold.place + self.heading(gait).unit_vector() * gait.forward_m;
        ground.stride_to(&self.foothold, to)
    }

    /// The stance after an action, and whether the ground blocked the action.
    #[must_use]
    pub fn after_action(self, action: AgentAction, ground: &NavMeshGround, gait: AgentGait) -> (Self, bool) {
        match action {
            AgentAction::Stop => (self, false),
            AgentAction::Left => (self.turned_by(-1), false),
            AgentAction::Right => (self.turned_by(1), false),
            AgentAction::Forward => {
                let stride = self.stride_ahead(ground, gait);
                (Self { foothold: stride.end, ..self }, stride.is_blocked)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaits_that_lead_nowhere_are_refused() {
        assert!(AgentGait::new(0.25, 15.0).is_ok() && AgentGait::new(0.5, 22.5).is_ok());
        for (forward_m, turn_deg) in
            [(0.0, 15.0), (f64::NAN, 15.0), (0.25, 0.0), (0.25, 50.0), (0.25, -15.0), (9.0, 15.0)]
        {
            assert!(AgentGait::new(forward_m, turn_deg).is_err(), "{forward_m} {turn_deg}");
        }
    }
}
