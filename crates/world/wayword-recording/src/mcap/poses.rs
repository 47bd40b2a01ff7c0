//! Finds the messages that give the poses of the camera: first in the tree of frames (`tf`), then in odometry, then in topics
//! of poses.

use super::{
    message_times::{MessageTimes, StreamTiming},
    messages::{MessageHead, MessageKind, RigidTransform, StampedTransform},
    topics::{UnclearReason, list_names},
    transform_tree::{TransformEdge, TransformTree, placings_along},
};
use std::collections::BTreeMap;

/// Words in the names of topics with poses that are goals, and not the robot's own.
const GOAL_WORDS: [&str; 4] = ["goal", "initialpose", "target", "plan"];
/// Most topics and transforms without rotations that are told.
const MAX_TOLD_TOPICS: usize = 4;
const NAME_POSES_HINT: &str =
    "write `poses = \"TOPIC\"` into a file NAME.toml beside NAME.mcap, or into recording.toml";
const FAULTY_TREE_HINT: &str = "leave the wrong publisher out of the recording, or name a topic with odometry: \
                                `poses = \"TOPIC\"` in a .toml file beside it";

/// All poses of a file.
#[derive(Debug)]
pub(crate) struct RecordedPoses {
    /// The frame of the pictures.
    camera: String,
    tree: TransformTree,
    /// Odometry and poses, by topic.
    topics: BTreeMap<String, TopicPoses>,
    /// The transforms that were left out because their quaternion is 0,0,0,0, counted by their names.
    unturned: BTreeMap<String, usize>,
}

/// Poses of one topic.
#[derive(Debug)]
struct TopicPoses {
    kind: MessageKind,
    /// The frame that is placed, if the messages name it.
    child_frame: Option<String>,
    /// Its poses over time, as one edge of the tree.
    edge: TransformEdge,
    /// Its poses with the quaternion 0,0,0,0. Their rotation means nothing.
    unturned: TransformEdge,
}

/// The edges from the camera's own frame, or from that of the robot that carries it, up to a fixed frame.
#[derive(Debug)]
pub(crate) struct TransformChain<'a> {
    edges: Vec<&'a TransformEdge>,
    /// Whether the chain begins at the camera's own frame.
    pub(crate) starts_at_camera: bool,
    /// Whether the rotations mean something.
    pub(crate) has_rotations: bool,
}

impl RecordedPoses {
    pub(crate) fn new(camera: &str) -> Self {
        Self {
            camera: camera.to_owned(),
            tree: TransformTree::new(camera),
            topics: BTreeMap::new(),
            unturned: BTreeMap::new(),
        }
    }

    /// Takes in a message.
    pub(crate) fn add_message(&mut self, topic: &str, kind: MessageKind, logged_ns: i64, all: Vec<StampedTransform>) {
        for placed in all {
            if kind == MessageKind::Transforms && !placed.has_rotation {
                let frame = placed.child_frame.as_deref().unwrap_or_default();
                *self.unturned.entry(format!("{frame} in {}", placed.head.frame)).or_default() += 1;
                continue;
            }
            if kind == MessageKind::Transforms {
                self.tree.add_placed(logged_ns, placed, topic.ends_with("tf_static"));
                continue;
            }
            let StampedTransform { head: MessageHead { stamp_ns, frame }, child_frame, placing, has_rotation } = placed;
            if !self.topics.contains_key(topic) {
                let edge = TransformEdge { name: topic.to_owned(), parent: frame, ..TransformEdge::default() };
                let unturned = edge.clone();
                self.topics.insert(topic.to_owned(), TopicPoses { kind, child_frame, edge, unturned });
            }
            if let Some(poses) = self.topics.get_mut(topic) {
                let edge = if has_rotation { &mut poses.edge } else { &mut poses.unturned };
                edge.samples.push((MessageTimes { stamp_ns, logged_ns }, placing));
            }
        }
    }

    /// The chain of the named topic, or else of the obvious one. `None` if the file has no poses of the camera.
    pub(crate) fn choose_chain(
        &self,
        named: Option<(&str, MessageKind)>,
    ) -> Result<Option<TransformChain<'_>>, UnclearReason> {
        let is_tree = matches!(named, None | Some((_, MessageKind::Transforms)));
        if let Some(fault) = self.tree.find_fault().filter(|_| is_tree) {
            return Err((fault, FAULTY_TREE_HINT));
        }
        match named {
            Some((topic, MessageKind::Transforms)) => {
                let chain = self
                    .tree
                    .edges_to_fixed_frame(true)
                    .map(|edges| Some(TransformChain { edges, starts_at_camera: true, has_rotations: true }));
                chain.ok_or_else(|| (self.describe_incomplete(topic), "name another topic as `poses`, or leave it out"))
            }
            Some((topic, _)) => {
                let chain = self.topics.get(topic).map(|poses| self.chain_for_topic(poses));
                let mut edges = chain.iter().flat_map(|chain| &chain.edges);
                match edges.find_map(|edge| edge.describe_parents()) {
                    Some(fault) => Err((fault, FAULTY_TREE_HINT)),
                    None => Ok(chain),
                }
            }
            None => self.obvious_chain(),
        }
    }

    /// The reason why the tree of frames gives no chain, for the user who named its topic.
    fn describe_incomplete(&self, topic: &str) -> String {
        let above = self.tree.frames_above(&self.camera).join(" in ");
        format!("{topic} does not say how the camera moved: its frame is {above}, which never moves or has no parent")
    }

    /// The chain without a named topic: of the tree of frames, else of the only topic with odometry, else of the only one
    /// with poses.
    fn obvious_chain(&self) -> Result<Option<TransformChain<'_>>, UnclearReason> {
        if let Some(edges) = self.tree.edges_to_fixed_frame(false) {
            return Ok(Some(TransformChain { edges, starts_at_camera: true, has_rotations: true }));
        }
        for kind in [MessageKind::Odometry, MessageKind::Pose] {
            let is_goal = |name: &str| {
                kind == MessageKind::Pose && GOAL_WORDS.iter().any(|word| name.to_ascii_lowercase().contains(word))
            };
            let of_kind = self.topics.iter().filter(|(name, poses)| poses.kind == kind && !is_goal(name));
            let own_poses: Vec<(&String, &TopicPoses)> = of_kind.collect();
            match *own_poses.as_slice() {
                [] => {}
                [(_, poses)] => return Ok(Some(self.chain_for_topic(poses))),
                _ => {
                    let names = list_names(own_poses.iter().map(|(name, _)| name.as_str()));
                    return Err((format!("has several pose topics: {names}"), NAME_POSES_HINT));
                }
            }
        }
        Ok(None)
    }

    /// The chain that a topic gives. It begins at the camera's frame if the mounting of the camera on the robot is known.
    fn chain_for_topic<'a>(&'a self, poses: &'a TopicPoses) -> TransformChain<'a> {
        if poses.lacks_rotations() {
            return TransformChain { edges: vec![&poses.unturned], starts_at_camera: false, has_rotations: false };
        }
        let mounted = poses.child_frame.as_ref().and_then(|what| self.tree.edges_up_to(what));
        let is_mounting_known = mounted.is_some();
        let mut edges = mounted.unwrap_or_default();
        edges.push(&poses.edge);
        TransformChain { edges, starts_at_camera: is_mounting_known, has_rotations: true }
    }

    /// A line for each topic or transform with the quaternion 0,0,0,0: those of the chain, or all if there is no chain.
    pub(crate) fn describe_unturned(&self, chain: Option<&TransformChain<'_>>) -> Vec<String> {
        let is_used = |name: &String| chain.is_none_or(|chain| chain.edges.iter().any(|edge| edge.name == *name));
        let unturned = self.topics.iter().filter(|(name, poses)| is_used(name) && !poses.unturned.samples.is_empty());
        let topics = unturned.map(|(name, poses)| {
            let (unturned, turned) = (poses.unturned.samples.len(), poses.edge.samples.len());
            let use_of_them = if poses.lacks_rotations() {
                "only the positions are used, and the camera counts as looking along the path"
            } else {
                "these are left out"
            };
            format!(
                "{unturned} of {} poses of {name} have the quaternion 0,0,0,0, which is no rotation: {use_of_them}",
                unturned + turned
            )
        });
        let transforms = self.unturned.iter().filter(|(name, _)| is_used(name)).map(|(name, count)| {
            format!(
                "{count} transforms of {name} have the quaternion 0,0,0,0, which is no rotation: these are left out"
            )
        });
        topics.chain(transforms).take(MAX_TOLD_TOPICS).collect()
    }
}

impl TopicPoses {
    /// Whether most of its poses have no rotation.
    fn lacks_rotations(&self) -> bool {
        self.unturned.samples.len() > self.edge.samples.len()
    }
}

impl<'a> TransformChain<'a> {
    /// The edges from the camera, or the robot, upwards.
    pub(crate) fn edges(&self) -> &[&'a TransformEdge] {
        &self.edges
    }

    /// The placings of the chain's first frame in its last one, in the order of their times (nanoseconds). Each edge has a
    /// timing.
    pub(crate) fn chain_placings(&self, timings: &[StreamTiming]) -> Vec<(i64, RigidTransform)> {
        placings_along(&self.edges, timings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::message_times::MessageClock;
    use glam::{DQuat, DVec3};

    fn placings_on(clock: MessageClock, chain: &TransformChain<'_>) -> Vec<(i64, RigidTransform)> {
        chain.chain_placings(&vec![StreamTiming::whole(clock); chain.edges.len()])
    }

    fn placed(frame: &str, what: Option<&str>, stamp_ns: i64, position: DVec3) -> StampedTransform {
        let placing = RigidTransform { position, rotation: DQuat::IDENTITY };
        StampedTransform {
            head: MessageHead { stamp_ns, frame: frame.to_owned() },
            child_frame: what.map(str::to_owned),
            placing,
            has_rotation: true,
        }
    }

    fn add_two_poses(
        poses: &mut RecordedPoses,
        topic: &str,
        kind: MessageKind,
        frame: &str,
        what: Option<&str>,
        x: f64,
    ) {
        for step in 1..=2_i32 {
            let position = DVec3::new(x * f64::from(step), 0.0, 0.0);
            poses.add_message(topic, kind, i64::from(step), vec![placed(frame, what, i64::from(step), position)]);
        }
    }

    #[test]
    fn odometry_and_where_the_camera_is_on_the_robot_make_the_cameras_way() {
        let mut poses = RecordedPoses::new("cam");
        add_two_poses(&mut poses, "/odom", MessageKind::Odometry, "odom", Some("base"), 1.0);
        assert!(!poses.choose_chain(None).unwrap().unwrap().starts_at_camera);
        poses.add_message(
            "/tf_static",
            MessageKind::Transforms,
            0,
            vec![placed("base", Some("cam"), 0, DVec3::new(0.0, 0.0, 0.5))],
        );
        let way = poses.choose_chain(None).unwrap().unwrap();
        assert!(way.starts_at_camera);
        assert_eq!(placings_on(MessageClock::Log, &way)[1].1.position, DVec3::new(2.0, 0.0, 0.5));
    }

    #[test]
    fn the_tree_goes_before_odometry_and_odometry_before_poses() {
        let mut poses = RecordedPoses::new("cam");
        assert!(poses.choose_chain(None).unwrap().is_none());
        add_two_poses(&mut poses, "/goal_pose", MessageKind::Pose, "map", None, 9.0);
        assert!(poses.choose_chain(None).unwrap().is_none());
        add_two_poses(&mut poses, "/pose", MessageKind::Pose, "map", None, 1.0);
        let x = |poses: &RecordedPoses, named| {
            placings_on(MessageClock::Stamp, &poses.choose_chain(named).unwrap().unwrap())[0].1.position.x
        };
        assert_eq!(x(&poses, None), 1.0);
        add_two_poses(&mut poses, "/odom", MessageKind::Odometry, "odom", Some("base"), 2.0);
        assert_eq!(x(&poses, None), 2.0);
        assert_eq!(x(&poses, Some(("/goal_pose", MessageKind::Pose))), 9.0);
        assert!(poses.choose_chain(Some(("/tf", MessageKind::Transforms))).unwrap_err().0.contains("/tf"));
        add_two_poses(&mut poses, "/tf", MessageKind::Transforms, "map", Some("cam"), 3.0);
        assert_eq!(x(&poses, None), 3.0);
    }

    #[test]
    fn of_two_odometries_one_has_to_be_named() {
        let mut poses = RecordedPoses::new("cam");
        add_two_poses(&mut poses, "/wheels", MessageKind::Odometry, "odom", Some("base"), 1.0);
        add_two_poses(&mut poses, "/filtered", MessageKind::Odometry, "odom", Some("base"), 2.0);
        let (why, hint) = poses.choose_chain(None).unwrap_err();
        assert!(why.contains("/filtered, /wheels") && hint.contains("poses ="), "{why}");
        assert!(poses.choose_chain(Some(("/wheels", MessageKind::Odometry))).unwrap().is_some());
    }
}
