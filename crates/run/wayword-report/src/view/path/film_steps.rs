//! The frames of a film along a path: the path's own, and evenly timed ones between them.

use std::f64::consts::FRAC_PI_2;
use wayword_core::{Frame, Path, PathMove, Pose};
use wayword_run::error::CommandError;

/// How fast the camera turns on the spot, radians for each second.
const TURN_SPEED_RAD_PER_S: f64 = FRAC_PI_2;
/// How fast the camera moves straight on, metres for each second.
const WALK_SPEED_M_PER_S: f64 = 1.0;

/// A place from which a picture of the film is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmStep {
    /// The pose of the camera, with its place in the scene.
    pub frame: Frame,
    /// Whether it lies between two of the path's own frames.
    pub is_between: bool,
}

/// The frames of a path with `between` places between each two of them. As in a move, the camera turns on the spot and
/// then moves straight, at an even pace.
///
/// # Errors
/// When places between frames are asked for, but the path has no poses.
pub fn film_steps(path: &Path, between: usize) -> Result<Vec<FilmStep>, CommandError> {
    if between > 0 && !path.motion.is_known() {
        let problem = format!("path {}: without poses there are no pictures between its frames", path.id);
        return Err(CommandError::usage(problem, "leave --smooth out to see the frames only"));
    }
    let path_step = |frame: &Frame| FilmStep { frame: frame.clone(), is_between: false };
    let mut steps = Vec::new();
    for pair in path.frames.windows(2) {
        steps.push(path_step(&pair[0]));
        steps.extend((1..=between).map(|at| step_between(&pair[0], &pair[1], at as f64 / (between + 1) as f64)));
    }
    steps.extend(path.frames.last().map(path_step));
    Ok(steps)
}

/// The place at a share of the time that a move takes.
fn step_between(from: &Frame, to: &Frame, share: f64) -> FilmStep {
    let step = PathMove::between_poses(&from.pose, &to.pose);
    let turning_s = step.turn_rad.abs() / TURN_SPEED_RAD_PER_S;
    let passed_s = share * (turning_s + from.pose.position.distance(to.pose.position) / WALK_SPEED_M_PER_S);
    let frame = if passed_s <= turning_s {
        let turned = if turning_s > 0.0 { step.turn_rad * passed_s / turning_s } else { 0.0 };
        let heading = from.pose.heading.turned_by(turned);
        Frame { pose: Pose { heading, ..from.pose }, ..from.clone() }
    } else {
        let way = to.pose.position - from.pose.position;
        let position = from.pose.position + way.normalize_or_zero() * ((passed_s - turning_s) * WALK_SPEED_M_PER_S);
        Frame { pose: Pose { position, ..to.pose }, viewpoint: None, level: from.level }
    };
    FilmStep { frame, is_between: true }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DVec3, Heading, PathMotion, SceneId};

    fn path(motion: PathMotion) -> Path {
        let frame = |x: f64, y: f64, degrees: f64| Frame {
            pose: Pose::looking_level(DVec3::new(x, y, 1.5), Heading::new(degrees.to_radians()).unwrap()),
            viewpoint: None,
            level: Some(1),
        };
        let frames = vec![frame(0.0, 0.0, 350.0), frame(2.0, 0.0, 90.0), frame(2.0, 2.0, 0.0)];
        Path { id: "p".into(), scene: SceneId::new("s").unwrap(), frames, motion, target: None }
    }

    #[test]
    fn the_walker_turns_and_then_walks() {
        let path = path(PathMotion::Known);
        let steps = film_steps(&path, 27).unwrap();
        assert_eq!(steps.iter().filter(|step| !step.is_between).map(|step| &step.frame).collect::<Vec<_>>(), {
            path.frames.iter().collect::<Vec<_>>()
        });
        assert_eq!(steps.len(), 2 * 28 + 1);
        for pair in steps.windows(2) {
            let step = PathMove::between_poses(&pair[0].frame.pose, &pair[1].frame.pose);
            let seconds = step.turn_rad.abs() / TURN_SPEED_RAD_PER_S + step.distance_m / WALK_SPEED_M_PER_S;
            // 100 degrees and 2 m, then 90 degrees and 2 m, in 28 steps each.
            assert!([(100.0 / 90.0 + 2.0) / 28.0, 3.0 / 28.0].iter().any(|even| (even - seconds).abs() < 1e-9));
            assert!(step.turn_rad >= -FRAC_PI_2 && (step.distance_m < 1e-9 || step.turn_rad.abs() < 0.2));
        }
    }

    #[test]
    fn steps_refuses_places_between_the_frames_of_a_path_without_poses() {
        assert_eq!(film_steps(&path(PathMotion::Unknown), 0).unwrap().len(), 3);
        assert!(film_steps(&path(PathMotion::Unknown), 1).is_err());
    }
}
