//! Views: what an eye sees from a pose in one direction.

use crate::{Heading, Image, ObjectLabel, Pose, Side, heading::CompassPoint};
use serde::{Deserialize, Serialize};
use std::{f64::consts::FRAC_PI_2, sync::Arc};

/// Where to look, and how wide.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ViewGaze {
    /// Direction of the view's centre; the elevation is 0.
    pub heading: Heading,
    /// Horizontal field of view, radians.
    pub horizontal_fov_rad: f64,
}

/// A view from a pose: the picture, and what the platform knows about it.
#[derive(Debug, Clone)]
pub struct View {
    /// Where the eye is, and which way it looks.
    pub pose: Pose,
    /// Horizontal field of view, radians.
    pub horizontal_fov_rad: f64,
    /// The picture, where there is one.
    pub image: Option<Arc<Image>>,
    truth: Option<GroundTruth>,
}

/// The ground truth of a view: labels and a room that the platform itself knows.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct GroundTruth {
    /// Objects of which the box's centre lies in the view.
    pub labels: Vec<ObjectLabel>,
    /// Whether the platform lists the objects here. If not, missing labels are no evidence of absence.
    pub lists_objects: bool,
    /// The room in which the eye is ("living room").
    pub room: Option<String>,
}

impl ViewGaze {
    /// One of the four views of a panorama: 90 degrees wide.
    #[must_use]
    pub fn quarter_view(heading: Heading) -> Self {
        Self { heading, horizontal_fov_rad: FRAC_PI_2 }
    }

    /// The four views of a panorama relative to a heading: ahead, right, behind, left.
    #[must_use]
    pub fn around_heading(heading: Heading) -> [Self; 4] {
        Side::ALL.map(|side| Self::quarter_view(heading.turned_by(side.turn_rad())))
    }

    /// The four views of a panorama by the compass: north, east, south, west.
    #[must_use]
    pub fn compass_views() -> [Self; 4] {
        CompassPoint::ALL.map(|point| Self::quarter_view(point.to_heading()))
    }

    /// Whether a direction lies within the gaze's width. Half open on the right, so that each direction belongs to
    /// exactly one view of a panorama.
    #[must_use]
    pub fn holds_heading(&self, heading: Heading) -> bool {
        let off = self.heading.turn_to(heading);
        let half = self.horizontal_fov_rad / 2.0;
        (-half..half).contains(&off)
    }
}

impl View {
    /// A view. `truth` is `None` where the platform knows only the picture.
    #[must_use]
    pub fn new(pose: Pose, horizontal_fov_rad: f64, image: Option<Arc<Image>>, truth: Option<GroundTruth>) -> Self {
        Self { pose, horizontal_fov_rad, image, truth }
    }

    /// Whether it has neither a picture nor ground truth, as where a camera did not look.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.image.is_none() && self.truth.is_none()
    }

    /// The ground truth. Only `labels` as a role and the checks' evidence may use it. The program's invariants
    /// test keeps every other role to the picture.
    #[must_use]
    pub fn ground_truth(&self) -> Option<&GroundTruth> {
        self.truth.as_ref()
    }

    /// The objects with a known outline in the picture. They serve only to find the object that a box is of: REVERIE's
    /// task gives an agent the candidates' boxes in the same way.
    pub(crate) fn outlined_labels(&self) -> impl Iterator<Item = &ObjectLabel> {
        self.truth.iter().flat_map(|truth| &truth.labels).filter(|label| label.box_px.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn each_direction_belongs_to_one_view_of_a_panorama(around in 0.0..std::f64::consts::TAU, seen in 0.0..std::f64::consts::TAU) {
            let (around, seen) = (Heading::new(around).unwrap(), Heading::new(seen).unwrap());
            let holders = ViewGaze::around_heading(around).iter().filter(|gaze| gaze.holds_heading(seen)).count();
            // Rounding can put a direction on a seam into none or two.
            let on_seam = ((around.turn_to(seen).abs() / FRAC_PI_2).fract() - 0.5).abs() < 1e-9;
            prop_assert!(holders == 1 || on_seam);
        }
    }
}
