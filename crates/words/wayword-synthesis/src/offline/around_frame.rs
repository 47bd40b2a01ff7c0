//! The listing of the objects around a frame that is no viewpoint of its building.

use super::BuildingListing;
use wayword_core::{Frame, GroundTruth, View};

/// Adds to what is known of a building the objects that the labels of the views around a frame contain. `ahead` has the pictures that the
/// walker sees ahead before coming there.
#[must_use]
pub fn list_around_frame(known: BuildingListing, frame: &Frame, around: &[View], ahead: &[View]) -> BuildingListing {
    let truths = || around.iter().filter_map(View::ground_truth);
    let room = truths().find_map(|truth: &GroundTruth| truth.room.as_deref());
    let pictured = ahead.iter().filter_map(View::ground_truth).flat_map(|truth| &truth.labels);
    known.with_frame(frame, room, truths().flat_map(|truth| &truth.labels)).with_pictured(pictured)
}
