//! The single actions by which an agent moves in continuous space: stop, one step forward, one turn.

use serde::{Deserialize, Serialize};

/// An action, with its number in VLN-CE and habitat-lab (`HabitatSimActions`). The length of a step and the angle of a
/// turn are settings of the walk, not part of the action (in VLN-CE 0.25 m and 15 degrees).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "u8", try_from = "u8")]
pub enum AgentAction {
    /// Ends the walk.
    Stop = 0,
    /// One step forward.
    Forward = 1,
    /// One turn to the left, on the spot.
    Left = 2,
    /// One turn to the right, on the spot.
    Right = 3,
}

/// A number that belongs to no action.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{0} is no action: expected 0 (stop), 1 (forward), 2 (left) or 3 (right)")]
pub struct NoAction(u8);

impl From<AgentAction> for u8 {
    fn from(action: AgentAction) -> Self {
        action as Self
    }
}

impl TryFrom<u8> for AgentAction {
    type Error = NoAction;

    fn try_from(number: u8) -> Result<Self, NoAction> {
        let all = [Self::Stop, Self::Forward, Self::Left, Self::Right];
        all.get(usize::from(number)).copied().ok_or(NoAction(number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_have_habitats_numbers() {
        let all = [AgentAction::Stop, AgentAction::Forward, AgentAction::Left, AgentAction::Right];
        let told = serde_json::to_string(&all).unwrap();
        assert_eq!((told.as_str(), serde_json::from_str::<[AgentAction; 4]>(&told).unwrap()), ("[0,1,2,3]", all));
        assert!(serde_json::from_str::<AgentAction>("4").unwrap_err().to_string().contains("4 is no action"));
    }
}
