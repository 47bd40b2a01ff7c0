//! A path through a scene: frames in order, and the target where there is one.

use crate::{Heading, Motion, Move, ObjectId, Pose, SceneId, Side, ViewpointId};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A stop on a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Where the eye is, and which way the agent looks when it arrives.
    pub pose: Pose,
    /// The node of the viewpoint graph, where the stop is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viewpoint: Option<ViewpointId>,
    /// The storey, the lowest being 1, where the platform knows it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
}

/// A path: frames in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Name of the path, unique within its dataset or run.
    pub id: String,
    /// The scene that it lies in.
    pub scene: SceneId,
    /// At least one frame. The first looks along the episode's heading, every later one along the hop just made.
    pub frames: Vec<Frame>,
    /// Whether the frames' poses mean anything.
    #[serde(default, skip_serializing_if = "Motion::is_known")]
    pub motion: Motion,
    /// The object that the task at the end is about, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<Target>,
}

/// The object that an instruction's task is about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Its id in the scene.
    pub object: ObjectId,
    /// Its name, as the labels have it.
    pub name: String,
    /// Ways to tell it from its namesakes at the last frame, best first; empty where none is visible.
    #[serde(default)]
    pub told_by: Vec<Distinction>,
    /// Whether something of the same name is visible at the last frame too.
    #[serde(default)]
    pub has_namesake: bool,
}

/// One way to tell an object from its namesakes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum Distinction {
    /// Its colour, which no namesake has.
    Colour {
        /// The word for it.
        colour: String,
    },
    /// It is the only one on that side of an agent that has just arrived.
    OnSide {
        /// Which side.
        side: Side,
    },
    /// It stands nearer to an object of this (unique) name than any namesake.
    NextTo {
        /// Name of that neighbour.
        neighbour: String,
    },
    /// It is the nearest to the last frame, or the farthest.
    Range {
        /// Nearest where true, farthest where false.
        nearest: bool,
    },
}

impl Frame {
    /// A key that is equal for frames of one place, because these see the same. It holds the name beside the position,
    /// because frames without poses differ only by name.
    #[must_use]
    pub fn place(&self) -> ([u64; 3], Option<ViewpointId>) {
        (self.pose.position.to_array().map(f64::to_bits), self.viewpoint.clone())
    }
}

impl Path {
    /// Frames along `stops`. The first looks along `start_heading` (along the first hop where there is none), each
    /// later one along the hop just made. A hop straight up or down keeps the heading.
    #[must_use]
    pub fn frames_along(stops: Vec<Stop>, start_heading: Option<Heading>) -> Vec<Frame> {
        let first_hop = stops.windows(2).find_map(|pair| Heading::towards(pair[0].position, pair[1].position));
        let mut heading = start_heading.or(first_hop).unwrap_or(Heading::NORTH);
        let mut before: Option<DVec3> = None;
        stops
            .into_iter()
            .map(|stop| {
                if let Some(hop) = before.and_then(|from| Heading::towards(from, stop.position)) {
                    heading = hop;
                }
                before = Some(stop.position);
                Frame { pose: Pose::level(stop.position, heading), viewpoint: stop.viewpoint, level: stop.level }
            })
            .collect()
    }

    /// The moves between its frames, one fewer than frames: move `i` turns at frame `i` and walks to frame `i + 1`.
    /// Empty where the motion is unknown.
    #[must_use]
    pub fn moves(&self) -> Vec<Move> {
        if !self.motion.is_known() {
            return Vec::new();
        }
        self.frames.windows(2).map(|pair| Move::between(&pair[0].pose, &pair[1].pose)).collect()
    }

    /// Its length, metres; `None` where the motion is unknown.
    #[must_use]
    pub fn length_m(&self) -> Option<f64> {
        self.motion.is_known().then(|| self.moves().iter().map(|step| step.distance_m).sum())
    }
}

/// A position on a path before its heading is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// The eye, metres, world frame.
    pub position: DVec3,
    /// The node of the viewpoint graph, where it is one.
    pub viewpoint: Option<ViewpointId>,
    /// The storey, the lowest being 1.
    pub level: Option<u32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stop(x: f64, y: f64, z: f64) -> Stop {
        Stop { position: DVec3::new(x, y, z), viewpoint: None, level: None }
    }

    fn path(stops: Vec<Stop>, start: Option<Heading>) -> Path {
        Path {
            id: "p".into(),
            scene: SceneId::new("s").unwrap(),
            frames: Path::frames_along(stops, start),
            motion: Motion::Known,
            target: None,
        }
    }

    #[test]
    fn the_opening_turn_is_the_first_move() {
        let south = Heading::new(std::f64::consts::PI).unwrap();
        let path = path(vec![stop(0.0, 0.0, 0.0), stop(0.0, 2.0, 0.0), stop(2.0, 2.0, 0.0)], Some(south));
        let turns: Vec<_> = path.moves().iter().map(|step| step.turn_rad.to_degrees().round()).collect();
        assert_eq!(turns, [180.0, 90.0]);
        assert!((path.length_m().unwrap() - 4.0).abs() < 1e-12);
    }

    #[test]
    fn without_an_episode_heading_the_first_frame_looks_along_the_first_hop() {
        let path = path(vec![stop(0.0, 0.0, 0.0), stop(3.0, 0.0, 0.0)], None);
        assert!((path.frames[0].pose.heading.deg() - 90.0).abs() < 1e-9);
        assert_eq!(path.moves()[0].turn_rad, 0.0);
    }

    #[test]
    fn a_hop_straight_up_keeps_the_heading() {
        let path = path(vec![stop(0.0, 0.0, 0.0), stop(1.0, 0.0, 0.0), stop(1.0, 0.0, 3.0)], None);
        assert_eq!(path.frames[1].pose.heading, path.frames[2].pose.heading);
    }

    #[test]
    fn frames_without_poses_are_told_apart_by_their_names() {
        let frame = |name: &str| Frame {
            pose: Pose::level(DVec3::ZERO, Heading::NORTH),
            viewpoint: Some(ViewpointId::new(name).unwrap()),
            level: None,
        };
        assert_ne!(frame("a").place(), frame("b").place());
        assert_eq!(frame("a").place(), frame("a").place());
    }

    #[test]
    fn of_an_unknown_motion_there_are_neither_moves_nor_a_length() {
        let known = path(vec![stop(0.0, 0.0, 0.0), stop(2.0, 0.0, 0.0)], None);
        let unknown = Path { motion: Motion::Unknown, ..known.clone() };
        assert_eq!((unknown.moves(), unknown.length_m()), (Vec::new(), None));
        assert_eq!(known.length_m(), Some(2.0));
        // Paths with poses are written as before.
        assert!(!serde_json::to_string(&known).unwrap().contains("motion"));
        let text = serde_json::to_string(&unknown).unwrap();
        assert!(text.contains(r#""motion":"unknown""#), "{text}");
        assert_eq!(serde_json::from_str::<Path>(&text).unwrap(), unknown);
    }
}
