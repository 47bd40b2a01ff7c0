//! Replaces the ground truth of views.

use wayword_core::{GroundTruth, ObjectLabel, View};

/// Changes the labels of a view. A view without ground truth stays as it is.
pub(super) fn with_labels(view: View, change: impl FnOnce(&mut Vec<ObjectLabel>)) -> View {
    with_truth(view, |truth| change(&mut truth.labels))
}

/// Changes the ground truth of a view. A view without ground truth stays as it is.
pub(super) fn with_truth(view: View, change: impl FnOnce(&mut GroundTruth)) -> View {
    let Some(mut truth) = view.ground_truth().cloned() else { return view };
    change(&mut truth);
    View::new(view.pose, view.horizontal_fov_rad, view.image, Some(truth))
}
