//! The listing of objects around one frame, for platforms that know no more of the building.

use super::BuildingListing;
use wayword_core::{Frame, View};

/// Lists the objects that the labels of the views around a frame contain.
#[must_use]
pub fn list_around_frame(frame: &Frame, views: &[View]) -> BuildingListing {
    BuildingListing::around_frame(frame, views.iter().filter_map(View::ground_truth).flat_map(|truth| &truth.labels))
}
