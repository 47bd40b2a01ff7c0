//! Changes of the camera's height and field of view.

use super::WorldAlteration;
use wayword_core::{DVec3, Frame, SceneId, ViewGaze};

/// A camera at another height over the floor. Only the eye is moved: frames, routes and rooms stay as they are.
///
/// Platforms refuse positions without a room or ground. They must therefore accept an eye that is lower than their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraHeight {
    /// Height of the eye that looks, metres over the floor.
    pub height_m: f64,
    /// Height of the eye in the platform's frames, metres over the floor.
    pub eye_m: f64,
}

/// A camera with another field of view. A platform with a narrower limit returns narrower views; each view contains its width.
///
/// It wraps a [`CameraTilt`](super::CameraTilt) from outside, because a tilted view has to be made from a wider one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldOfView {
    /// Horizontal field of view, degrees.
    pub deg: f64,
}

impl WorldAlteration for CameraHeight {
    fn look_before(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> (Frame, ViewGaze) {
        let mut eye = from.clone();
        eye.pose.position += DVec3::Z * (self.height_m - self.eye_m);
        (eye, gaze)
    }

    fn keeps_room(&self) -> bool {
        self.height_m != self.eye_m
    }
}

impl WorldAlteration for FieldOfView {
    fn look_before(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> (Frame, ViewGaze) {
        (from.clone(), ViewGaze { horizontal_fov_rad: self.deg.to_radians(), ..gaze })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::{AlteredPlatform, testing::*};
    use std::collections::BTreeSet;
    use wayword_core::{ObjectId, ObjectLabel, Platform, View};

    fn seen(view: &View) -> BTreeSet<ObjectId> {
        labels(view).iter().map(|label| label.object.clone()).collect()
    }

    #[test]
    fn a_narrower_view_shows_no_more_and_contains_its_width() {
        let (scene, path) = walk();
        for frame in &path.frames {
            let gaze = ViewGaze::quarter_view(frame.pose.heading);
            let [narrow, as_it_is] = [60.0, 90.0]
                .map(|deg| AlteredPlatform::new(House, FieldOfView { deg }).look_from(&scene, frame, gaze).unwrap());
            assert!((narrow.horizontal_fov_rad.to_degrees() - 60.0).abs() < 1e-9);
            let outside = |label: &ObjectLabel| gaze.heading.turn_to(label.heading).abs() > 30f64.to_radians();
            assert!(!labels(&narrow).iter().any(outside));
            // In a narrow view things are larger, so it may have labels for things that are too small in the wide one.
            let near = |view: &View| {
                let near = |label: &&ObjectLabel| label.distance_m.is_some_and(|far_m| far_m < 3.0);
                labels(view).iter().filter(near).map(|label| label.object.clone()).collect::<BTreeSet<_>>()
            };
            assert!(near(&narrow).is_subset(&seen(&as_it_is)), "{narrow:?} {as_it_is:?}");
            let plain = House.look_from(&scene, frame, gaze).unwrap();
            assert_eq!((&plain.image, labels(&plain)), (&as_it_is.image, labels(&as_it_is)));
        }
    }

    #[test]
    fn a_raised_eye_sees_more_of_the_floor_and_is_in_the_same_room() {
        let (scene, path) = walk();
        for frame in &path.frames {
            let gaze = ViewGaze::quarter_view(frame.pose.heading);
            let plain = House.look_from(&scene, frame, gaze).unwrap();
            let raised = AlteredPlatform::new(House, CameraHeight { height_m: 1.9, eye_m: 1.5 });
            let view = raised.look_from(&scene, frame, gaze).unwrap();
            assert!((view.pose.position.z - frame.pose.position.z - 0.4).abs() < 1e-12);
            assert_eq!(view.ground_truth().unwrap().room, plain.ground_truth().unwrap().room);
            for label in labels(&view) {
                let Some(before) = labels(&plain).iter().find(|before| before.object == label.object) else { continue };
                assert!(label.elevation_rad < before.elevation_rad);
                assert_eq!((label.heading, label.position), (before.heading, before.position));
            }
            let same = AlteredPlatform::new(House, CameraHeight { height_m: 1.5, eye_m: 1.5 });
            assert_eq!(same.look_from(&scene, frame, gaze).unwrap().image, plain.image);
        }
    }
}
