//! Runs of equal actions: policies say "move forward 75 cm" for three steps.

use wayword_core::AgentAction;

/// Length of a step, centimetres.
pub(super) const STEP_CM: usize = 25;
/// Steps that one answer of NaVid and NaVILA holds at most: 75 cm.
pub(super) const MAX_ANSWER_STEPS: usize = 3;

/// Equal actions in a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ActionRun {
    /// The number of its first action.
    pub first: usize,
    /// The action.
    pub action: AgentAction,
    /// How many there are.
    pub count: usize,
}

/// The runs of equal actions, each of at most `longest`.
#[must_use]
pub fn action_runs(actions: &[AgentAction], longest: usize) -> Vec<ActionRun> {
    let mut runs: Vec<ActionRun> = Vec::new();
    for (first, action) in actions.iter().copied().enumerate() {
        match runs.last_mut() {
            Some(run) if run.action == action && run.count < longest => run.count += 1,
            _ => runs.push(ActionRun { first, action, count: 1 }),
        }
    }
    runs
}

/// A run of actions in the words that NaVid's and NaVILA's evaluations read back. `turn_deg` is the angle of one turn, and `degree` the
/// unit as the policy writes it.
pub(super) fn action_sentence(run: ActionRun, turn_deg: usize, degree: &str) -> String {
    let turned = turn_deg * run.count;
    match run.action {
        AgentAction::Stop => "The next action is stop.".to_owned(),
        AgentAction::Forward => format!("The next action is move forward {} cm.", STEP_CM * run.count),
        AgentAction::Left => format!("The next action is turn left {turned} {degree}."),
        AgentAction::Right => format!("The next action is turn right {turned} {degree}."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_cut_at_the_longest() {
        let actions = [1, 1, 1, 1, 2, 0].map(|number| AgentAction::try_from(number).unwrap());
        let runs: Vec<_> = action_runs(&actions, 3).iter().map(|run| (run.first, run.count)).collect();
        assert_eq!(runs, [(0, 3), (3, 1), (4, 1), (5, 1)]);
    }
}
