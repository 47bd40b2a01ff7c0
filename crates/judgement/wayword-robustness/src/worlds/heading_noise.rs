//! Adds errors to the headings in the log of a path, as a robot with a bad compass would write them.

use super::{
    WorldAlteration,
    altered_platform::{AlteredLook, frame_key},
    labels::with_labels,
};
use crate::draws::draw_normal;
use wayword_core::{DVec3, Frame, ObjectLabel, Path, PathMotion, PlatformError, Pose, SceneId, View, ViewGaze};

/// Headings in the log with a gaussian error, which is drawn for each place. The camera looks along the true heading, and the view is
/// logged under the wrong one. So a thing ahead of the camera stays ahead of it, but seems to lie elsewhere in the world.
///
/// "Before" is the truth, "after" the log. An error is drawn by the seed, the scene and the frame's
/// [`place_key`](Frame::place_key), so the errors of two values of `deg` with one seed are proportional.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeadingNoise {
    /// Standard deviation of the error, degrees.
    pub deg: f64,
    /// The seed of the draws.
    pub seed: u64,
}

impl HeadingNoise {
    /// The error of the log's heading at a frame, radians, positive to the right.
    #[must_use]
    pub fn error_rad(&self, scene: &SceneId, frame: &Frame) -> f64 {
        self.deg.to_radians() * draw_normal(self.seed, &["heading noise", scene.as_str(), &frame_key(frame)])
    }

    /// Makes the logged path from the true one. Positions stay as they are. Descriptions of the target that depend on the final pose
    /// are dropped. A path of unknown motion stays as it is.
    #[must_use]
    pub fn logged_path(&self, truth: &Path) -> Path {
        let mut log = truth.clone();
        if truth.motion == PathMotion::Unknown {
            return log;
        }
        for frame in &mut log.frames {
            frame.pose.heading = frame.pose.heading.turned_by(self.error_rad(&truth.scene, frame));
        }
        if let Some(target) = &mut log.target {
            target.told_by.retain(|distinction| !distinction.needs_pose());
        }
        log
    }
}

impl WorldAlteration for HeadingNoise {
    fn look_before(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> (Frame, ViewGaze) {
        let error_rad = self.error_rad(scene, from);
        let pose = Pose { heading: from.pose.heading.turned_by(-error_rad), ..from.pose };
        (Frame { pose, ..from.clone() }, ViewGaze { heading: gaze.heading.turned_by(-error_rad), ..gaze })
    }

    fn view_after(&self, look: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        let error_rad = self.error_rad(look.scene, look.from);
        let eye = before.pose.position;
        let logged = |label: &mut ObjectLabel| {
            label.heading = label.heading.turned_by(error_rad);
            label.position = label.position.map(|position| turned_about(eye, position, error_rad));
        };
        let mut after = with_labels(before, |labels| labels.iter_mut().for_each(logged));
        after.pose.heading = after.pose.heading.turned_by(error_rad);
        Ok(after)
    }

    fn path_after(&self, before: Path) -> Path {
        self.logged_path(&before)
    }
}

/// Rotates a position about the vertical axis through the eye by `rad` radians, clockwise seen from above.
fn turned_about(eye: DVec3, position: DVec3, rad: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(rad);
    let offset = position - eye;
    eye + DVec3::new(offset.x * cos + offset.y * sin, offset.y * cos - offset.x * sin, offset.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::{AlteredPlatform, testing::*};
    use wayword_core::{Heading, Platform};

    #[test]
    fn three_times_the_noise_is_three_times_each_error() {
        let (scene, path) = walk();
        let [little, much] = [5.0, 15.0].map(|deg| HeadingNoise { deg, seed: 3 });
        for frame in &path.frames {
            let [one, three] = [little, much].map(|noise| noise.error_rad(&scene, frame));
            assert!((three - 3.0 * one).abs() < 1e-12);
        }
        assert_eq!(HeadingNoise { deg: 0.0, seed: 3 }.logged_path(&path).frames, path.frames);
    }

    #[test]
    fn the_camera_sees_the_same_and_the_log_puts_it_elsewhere() {
        let (scene, path) = walk();
        let noise = HeadingNoise { deg: 20.0, seed: 4 };
        let log = noise.logged_path(&path);
        for (truth, logged) in path.frames.iter().zip(&log.frames) {
            let error_rad = noise.error_rad(&scene, truth);
            let seen = House.look_from(&scene, truth, ViewGaze::quarter_view(truth.pose.heading)).unwrap();
            let noisy = AlteredPlatform::new(House, noise)
                .look_from(&scene, logged, ViewGaze::quarter_view(logged.pose.heading))
                .unwrap();
            // The wrong heading and back is the true one but for rounding, which can shift an edge by a pixel.
            assert!(mean_difference(&seen, &noisy) < 0.1);
            assert!(noisy.pose.heading.turn_to(logged.pose.heading).abs() < 1e-9);
            for (a, b) in labels(&seen).iter().zip(labels(&noisy)) {
                assert_eq!(a.object, b.object);
                assert!((a.heading.turn_to(b.heading) - error_rad).sin().abs() < 1e-9);
                let towards = Heading::towards(logged.pose.position, b.position.unwrap()).unwrap();
                assert!(towards.turn_to(b.heading).abs() < 1e-6, "{b:?}");
            }
        }
    }
}
