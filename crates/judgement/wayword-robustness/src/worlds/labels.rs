//! Views with other labels.

use wayword_core::{GroundTruth, Label, View};

/// A view with other labels; one without ground truth stays as it is.
pub(super) fn with_labels(view: View, change: impl FnOnce(&mut Vec<Label>)) -> View {
    with_truth(view, |truth| change(&mut truth.labels))
}

/// A view of which something else is known; one without ground truth stays as it is.
pub(super) fn with_truth(view: View, change: impl FnOnce(&mut GroundTruth)) -> View {
    let Some(mut truth) = view.ground_truth().cloned() else { return view };
    change(&mut truth);
    View::new(view.pose, view.horizontal_fov_rad, view.image, Some(truth))
}
