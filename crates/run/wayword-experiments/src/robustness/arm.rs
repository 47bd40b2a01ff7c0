//! The arms of a robustness run. Each arm is one condition, such as a changed world, in which a text is written for every path.

use wayword_robustness::{Change, WholeChange};

/// One arm.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum RobustnessArm {
    /// In the run's world, as it is. All other arms are compared with this one.
    Unchanged,
    /// In the same world, with another sample of the model: how much texts vary by chance.
    Again,
    /// About another path of the building: how much texts differ at most.
    Other,
    /// About the path without a turn before the first hop. The reversed path is compared with this one.
    Forward,
    /// In a changed world, or about a changed path.
    Changed(Change),
}

impl RobustnessArm {
    /// All arms that some changes need, in the order in which they are made. Those with which others are compared come first.
    pub(super) fn for_changes(changes: &[Change]) -> Vec<Self> {
        let is_measured =
            changes.iter().any(|change| change.dose_value().is_some() || matches!(change, Change::Platform(_)));
        let reverses = changes.contains(&Change::Whole(WholeChange::Reverse));
        let mut arms = vec![Self::Unchanged];
        if is_measured {
            arms.extend([Self::Again, Self::Other]);
        }
        if reverses {
            arms.push(Self::Forward);
        }
        arms.extend(changes.iter().cloned().map(Self::Changed));
        arms
    }

    /// The name of the arm in the files.
    pub(super) fn id(&self) -> String {
        match self {
            Self::Unchanged => "unchanged".to_owned(),
            Self::Again => "again".to_owned(),
            Self::Other => "other-path".to_owned(),
            Self::Forward => "forward".to_owned(),
            Self::Changed(change) => change.id(),
        }
    }

    /// The label beside the progress bar while the arm is made.
    pub(super) fn progress_label(&self) -> String {
        match self {
            Self::Changed(change) => change.to_string(),
            other => other.id(),
        }
    }

    /// How strong the change of the arm is for a scripted eye, from 0 to 1.
    pub(super) fn change_strength(&self) -> f64 {
        match self {
            Self::Changed(change) => change.dose_strength().unwrap_or(0.0),
            _ => 0.0,
        }
    }

    /// Whether the effect that its change must have on a text is known beforehand.
    pub(super) fn is_exact(&self) -> bool {
        matches!(self, Self::Forward | Self::Changed(Change::Whole(_)))
    }

    /// Whether the change affects one thing of the world, chosen for each text.
    pub(super) fn is_edit(&self) -> bool {
        matches!(self, Self::Changed(Change::Whole(WholeChange::Remove | WholeChange::Add | WholeChange::Material)))
    }

    /// Whether the agent walks by the texts of the arm: they must describe the run's path from its start to its end.
    pub(super) fn is_walked(&self) -> bool {
        match self {
            Self::Unchanged | Self::Again => true,
            Self::Other | Self::Forward => false,
            Self::Changed(change) => *change != Change::Whole(WholeChange::Reverse) && !self.is_edit(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arms_to_compare_with_come_first() {
        let arms = |typed: &[&str]| -> Vec<String> {
            let changes: Vec<Change> = typed.iter().flat_map(|typed| Change::parse_list(typed).unwrap()).collect();
            RobustnessArm::for_changes(&changes).iter().map(RobustnessArm::id).collect()
        };
        assert_eq!(arms(&["mirror"]), ["unchanged", "mirror"]);
        assert_eq!(arms(&["reverse"]), ["unchanged", "forward", "reverse"]);
        let spaced = ["unchanged", "again", "other-path", "frame-spacing-m-0.5", "frame-spacing-m-3"];
        assert_eq!(arms(&["frame_spacing_m=0.5,3"]), spaced);
    }
}
