//! Finds the poses of the camera, in the tree of frames, odometry, or poses.

use super::{
    messages::{Head, MessageKind, Placed, Placing},
    topics::{Unclear, listed},
    tree::{Clock, Edge, Times, Tree, placings},
};
use std::collections::BTreeMap;

/// Words in the names of topics with poses that are goals, and not the robot's own.
const WISHED: [&str; 4] = ["goal", "initialpose", "target", "plan"];
const NAME_IT: &str = "write `poses = \"TOPIC\"` into a file NAME.toml beside NAME.mcap, or into recording.toml";

/// All poses of a file.
#[derive(Debug)]
pub(crate) struct Poses {
    /// The frame of the pictures.
    camera: String,
    tree: Tree,
    /// Odometry and poses, by topic.
    topics: BTreeMap<String, Moves>,
}

/// Poses of one topic.
#[derive(Debug)]
struct Moves {
    kind: MessageKind,
    /// The frame that is placed, if the messages name it.
    what: Option<String>,
    edge: Edge,
}

/// The edges from the camera's own frame, or from that of the robot that carries it, up to a fixed frame.
#[derive(Debug)]
pub(crate) struct Way<'a> {
    edges: Vec<&'a Edge>,
    /// Whether the way begins at the camera's own frame.
    pub(crate) of_camera: bool,
}

impl Poses {
    pub(crate) fn new(camera: &str) -> Self {
        Self { camera: camera.to_owned(), tree: Tree::new(camera), topics: BTreeMap::new() }
    }

    /// Takes in a message.
    pub(crate) fn add(&mut self, topic: &str, kind: MessageKind, logged_ns: i64, all: Vec<Placed>) {
        for placed in all {
            if kind == MessageKind::Transforms {
                self.tree.add(logged_ns, placed, topic.ends_with("tf_static"));
                continue;
            }
            let Placed { head: Head { stamp_ns, frame }, what, placing } = placed;
            if !self.topics.contains_key(topic) {
                let edge = Edge { parent: frame, ..Edge::default() };
                self.topics.insert(topic.to_owned(), Moves { kind, what, edge });
            }
            if let Some(moves) = self.topics.get_mut(topic) {
                moves.edge.samples.push((Times { stamp_ns, logged_ns }, placing));
            }
        }
    }

    /// The way by the named topic, or else by the obvious one. `None` if the file has no poses of the camera.
    pub(crate) fn way(&self, named: Option<(&str, MessageKind)>) -> Result<Option<Way<'_>>, Unclear> {
        match named {
            Some((topic, MessageKind::Transforms)) => {
                let way = self.tree.way_up(true).map(|edges| Some(Way { edges, of_camera: true }));
                way.ok_or_else(|| (self.incomplete(topic), "name another topic as `poses`, or leave it out"))
            }
            Some((topic, _)) => Ok(self.topics.get(topic).map(|moves| self.moved(moves))),
            None => self.obvious(),
        }
    }

    fn incomplete(&self, topic: &str) -> String {
        let above = self.tree.above(&self.camera).join(" in ");
        format!("{topic} does not say how the camera moved: its frame is {above}, which never moves or has no parent")
    }

    fn obvious(&self) -> Result<Option<Way<'_>>, Unclear> {
        if let Some(edges) = self.tree.way_up(false) {
            return Ok(Some(Way { edges, of_camera: true }));
        }
        for kind in [MessageKind::Odometry, MessageKind::Pose] {
            let wished = |name: &str| {
                kind == MessageKind::Pose && WISHED.iter().any(|word| name.to_ascii_lowercase().contains(word))
            };
            let of_kind = self.topics.iter().filter(|(name, moves)| moves.kind == kind && !wished(name));
            let found: Vec<(&String, &Moves)> = of_kind.collect();
            match found[..] {
                [] => {}
                [(_, moves)] => return Ok(Some(self.moved(moves))),
                _ => {
                    let names = listed(found.iter().map(|(name, _)| name.as_str()));
                    return Err((format!("has several pose topics: {names}"), NAME_IT));
                }
            }
        }
        Ok(None)
    }

    /// The way that a topic gives. It begins at the camera's frame if the mounting of the camera on the robot is known.
    fn moved<'a>(&'a self, moves: &'a Moves) -> Way<'a> {
        let mounted = moves.what.as_ref().and_then(|what| self.tree.up_to(what));
        let of_camera = mounted.is_some();
        let mut edges = mounted.unwrap_or_default();
        edges.push(&moves.edge);
        Way { edges, of_camera }
    }
}

impl Way<'_> {
    pub(crate) fn placings(&self, clock: Clock) -> Vec<(i64, Placing)> {
        placings(&self.edges, clock)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    fn placed(frame: &str, what: Option<&str>, stamp_ns: i64, position: DVec3) -> Placed {
        let placing = Placing { position, rotation: DQuat::IDENTITY };
        Placed { head: Head { stamp_ns, frame: frame.to_owned() }, what: what.map(str::to_owned), placing }
    }

    fn add_two_poses(poses: &mut Poses, topic: &str, kind: MessageKind, frame: &str, what: Option<&str>, x: f64) {
        for step in 1..=2_i32 {
            let position = DVec3::new(x * f64::from(step), 0.0, 0.0);
            poses.add(topic, kind, i64::from(step), vec![placed(frame, what, i64::from(step), position)]);
        }
    }

    #[test]
    fn odometry_and_where_the_camera_is_on_the_robot_make_the_cameras_way() {
        let mut poses = Poses::new("cam");
        add_two_poses(&mut poses, "/odom", MessageKind::Odometry, "odom", Some("base"), 1.0);
        assert!(!poses.way(None).unwrap().unwrap().of_camera);
        poses.add(
            "/tf_static",
            MessageKind::Transforms,
            0,
            vec![placed("base", Some("cam"), 0, DVec3::new(0.0, 0.0, 0.5))],
        );
        let way = poses.way(None).unwrap().unwrap();
        assert!(way.of_camera);
        assert_eq!(way.placings(Clock::Log)[1].1.position, DVec3::new(2.0, 0.0, 0.5));
    }

    #[test]
    fn the_tree_goes_before_odometry_and_odometry_before_poses() {
        let mut poses = Poses::new("cam");
        assert!(poses.way(None).unwrap().is_none());
        add_two_poses(&mut poses, "/goal_pose", MessageKind::Pose, "map", None, 9.0);
        assert!(poses.way(None).unwrap().is_none());
        add_two_poses(&mut poses, "/pose", MessageKind::Pose, "map", None, 1.0);
        let x = |poses: &Poses, named| poses.way(named).unwrap().unwrap().placings(Clock::Stamp)[0].1.position.x;
        assert_eq!(x(&poses, None), 1.0);
        add_two_poses(&mut poses, "/odom", MessageKind::Odometry, "odom", Some("base"), 2.0);
        assert_eq!(x(&poses, None), 2.0);
        assert_eq!(x(&poses, Some(("/goal_pose", MessageKind::Pose))), 9.0);
        assert!(poses.way(Some(("/tf", MessageKind::Transforms))).unwrap_err().0.contains("/tf"));
        add_two_poses(&mut poses, "/tf", MessageKind::Transforms, "map", Some("cam"), 3.0);
        assert_eq!(x(&poses, None), 3.0);
    }

    #[test]
    fn of_two_odometries_one_has_to_be_named() {
        let mut poses = Poses::new("cam");
        add_two_poses(&mut poses, "/wheels", MessageKind::Odometry, "odom", Some("base"), 1.0);
        add_two_poses(&mut poses, "/filtered", MessageKind::Odometry, "odom", Some("base"), 2.0);
        let (why, hint) = poses.way(None).unwrap_err();
        assert!(why.contains("/filtered, /wheels") && hint.contains("poses ="), "{why}");
        assert!(poses.way(Some(("/wheels", MessageKind::Odometry))).unwrap().is_some());
    }
}
