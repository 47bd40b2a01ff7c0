//! What the views of one frame list, where nothing is known of the rest of the building.

use super::Listing;
use wayword_core::{Frame, View};

/// The objects that are listed in the views around a frame.
#[must_use]
pub fn around(frame: &Frame, views: &[View]) -> Listing {
    Listing::around(frame, views.iter().filter_map(View::ground_truth).flat_map(|truth| &truth.labels))
}
