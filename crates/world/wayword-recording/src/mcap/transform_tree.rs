//! The tree of coordinate frames that ROS publishes (`tf2`): each frame is placed in its parent, at many times.

use super::{
    message_times::{MessageTimes, StreamTiming},
    messages::{RigidTransform, StampedTransform},
};
use std::collections::{BTreeMap, BTreeSet};

/// Names of fixed frames, the best first (REP 105).
const FIXED_FRAMES: [&str; 3] = ["map", "odom", "world"];
/// Most frames of a file; further ones are ignored. No robot has so many.
const MAX_FRAMES: usize = 100_000;

/// The placings of one frame in another, over time.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct TransformEdge {
    /// Its name for the user: a topic, or the two frames.
    pub(crate) name: String,
    /// The frame that is placed; empty if messages do not name it.
    pub(crate) frame: String,
    /// The frame in which it is placed.
    pub(crate) parent: String,
    /// Another frame in which it is placed too, if there is one: tf2 allows only one parent.
    pub(crate) other_parent: Option<String>,
    /// Whether it never moves.
    pub(crate) fixed: bool,
    /// In the order of the file.
    pub(crate) samples: Vec<(MessageTimes, RigidTransform)>,
}

impl TransformEdge {
    /// Whether the frame moves in its parent.
    pub(crate) fn is_moving(&self) -> bool {
        !self.fixed && self.samples.len() > 1
    }

    /// The two parents of its frame, if it has two.
    pub(crate) fn describe_parents(&self) -> Option<String> {
        let other = self.other_parent.as_ref()?;
        Some(format!("the transforms place the frame {} both in {} and in {other}", self.frame, self.parent))
    }

    /// Whether a frame of the ground is placed, such as `odom` in `map`, and not a robot.
    pub(crate) fn places_ground(&self) -> bool {
        fixed_frame_rank(&self.frame).is_some()
    }

    /// The times of its placings in the order of the file.
    pub(crate) fn message_times(&self) -> Vec<MessageTimes> {
        self.samples.iter().map(|(times, _)| *times).collect()
    }

    /// The edge in the order of its times; a single placing is valid at all times.
    fn timed_by(&self, timing: &StreamTiming) -> TimedEdge {
        if !self.is_moving() {
            return TimedEdge {
                samples: self.samples.last().map(|(_, placing)| (0, *placing)).into_iter().collect(),
                moves: false,
            };
        }
        let timed = self.samples.iter().filter_map(|(times, placing)| Some((timing.time_of(*times)?, *placing)));
        let mut samples: Vec<(i64, RigidTransform)> = timed.collect();
        samples.sort_by_key(|(time_ns, _)| *time_ns);
        samples.dedup_by_key(|(time_ns, _)| *time_ns);
        TimedEdge { samples, moves: true }
    }
}

/// Longest time between two transforms over which the way is interpolated on a straight line, nanoseconds: as long as
/// tf2 stores transforms.
const MAX_GAP_NS: i64 = 10_000_000_000;

/// An edge on one clock.
struct TimedEdge {
    /// Placings with their times, nanoseconds, ascending; a single one if the frame does not move.
    samples: Vec<(i64, RigidTransform)>,
    moves: bool,
}

impl TimedEdge {
    /// The placing at a time, interpolated between the two samples around it. `None` before the first, after
    /// the last, and in gaps longer than [`MAX_GAP_NS`].
    fn placing_at(&self, time_ns: i64) -> Option<RigidTransform> {
        if !self.moves {
            return self.samples.first().map(|(_, placing)| *placing);
        }
        let next = self.samples.partition_point(|(sample_ns, _)| *sample_ns < time_ns);
        let (after_ns, after) = *self.samples.get(next)?;
        if after_ns == time_ns {
            return Some(after);
        }
        let (before_ns, before) = *self.samples.get(next.checked_sub(1)?)?;
        if after_ns.saturating_sub(before_ns) > MAX_GAP_NS {
            return None;
        }
        let share = time_ns.saturating_sub(before_ns) as f64 / after_ns.saturating_sub(before_ns) as f64;
        Some(before.interpolate_to(after, share))
    }
}

/// The placing of the first frame of a chain in the last one, at each time at which a frame of the chain moved. Each edge has a
/// timing.
pub(crate) fn placings_along(chain: &[&TransformEdge], timings: &[StreamTiming]) -> Vec<(i64, RigidTransform)> {
    let chain: Vec<TimedEdge> = chain.iter().zip(timings).map(|(edge, timing)| edge.timed_by(timing)).collect();
    let moving = chain.iter().filter(|edge| edge.moves);
    let mut times: Vec<i64> = moving.flat_map(|edge| edge.samples.iter().map(|(time_ns, _)| *time_ns)).collect();
    times.sort_unstable();
    times.dedup();
    let at = |time_ns: i64| {
        chain.iter().try_fold(RigidTransform::IDENTITY_TRANSFORM, |inner, edge| {
            Some(edge.placing_at(time_ns)?.compose_with(inner))
        })
    };
    times.into_iter().filter_map(|time_ns| Some((time_ns, at(time_ns)?))).collect()
}

/// Frames by name, each with its parent.
#[derive(Debug, Clone, Default)]
pub(crate) struct TransformTree {
    /// The camera's frame: only this and the frames above it are needed.
    camera: String,
    edges: BTreeMap<String, TransformEdge>,
    /// The only frames that are still needed, once the way up to a fixed frame is known.
    kept: Option<BTreeSet<String>>,
}

impl TransformTree {
    /// An empty tree for the camera with this frame.
    pub(crate) fn new(camera: &str) -> Self {
        Self { camera: camera.to_owned(), ..Self::default() }
    }

    /// Adds a placing of a frame.
    pub(crate) fn add_placed(&mut self, logged_ns: i64, placed: StampedTransform, fixed: bool) {
        let Some(frame) = placed.child_frame else { return };
        let unknown = !self.edges.contains_key(&frame);
        if self.kept.as_ref().is_some_and(|kept| !kept.contains(&frame)) || (unknown && self.edges.len() == MAX_FRAMES)
        {
            return;
        }
        let edge = self.edges.entry(frame).or_insert_with_key(|frame| TransformEdge {
            name: format!("{frame} in {}", placed.head.frame),
            frame: frame.clone(),
            parent: placed.head.frame.clone(),
            fixed,
            ..TransformEdge::default()
        });
        if edge.parent != placed.head.frame {
            edge.other_parent.get_or_insert(placed.head.frame);
        } else {
            edge.fixed = fixed;
            if fixed {
                edge.samples.clear();
            }
            edge.samples.push((MessageTimes { stamp_ns: placed.head.stamp_ns, logged_ns }, placed.placing));
        }
        if unknown {
            self.drop_unneeded_frames();
        }
    }

    /// Once the way from the camera's frame up to a fixed frame is known, drops all frames that are not on it.
    fn drop_unneeded_frames(&mut self) {
        let above = self.frames_above(&self.camera);
        let root = above.last().copied().unwrap_or_default();
        if fixed_frame_rank(root).is_some() {
            let kept: BTreeSet<String> = above.iter().map(|frame| (*frame).to_owned()).collect();
            self.edges.retain(|frame, _| kept.contains(frame));
            self.kept = Some(kept);
        }
    }

    /// What is wrong with the way from the camera's frame up: a frame with two parents, or a circle.
    pub(crate) fn find_fault(&self) -> Option<String> {
        let above = self.frames_above(&self.camera);
        let edges = || above.iter().filter_map(|frame| self.edges.get(*frame));
        if let Some(fault) = edges().find_map(TransformEdge::describe_parents) {
            return Some(fault);
        }
        let last = above.last().and_then(|frame| self.edges.get(*frame))?;
        Some(if last.parent == last.frame {
            format!("the transforms place the frame {} in itself", last.frame)
        } else {
            format!("the transforms go round in a circle: {} in {}", above.join(" in "), last.parent)
        })
    }

    /// A frame, its parent, and so on up to the root.
    pub(crate) fn frames_above<'a>(&'a self, frame: &'a str) -> Vec<&'a str> {
        let (mut above, mut seen) = (vec![frame], BTreeSet::from([frame]));
        while let Some(edge) = above.last().and_then(|frame| self.edges.get(*frame)) {
            if !seen.insert(&edge.parent) {
                break;
            }
            above.push(&edge.parent);
        }
        above
    }

    /// The edges from the camera's frame up to another one; `None` if that is not above it.
    pub(crate) fn edges_up_to(&self, frame: &str) -> Option<Vec<&TransformEdge>> {
        let above = self.frames_above(&self.camera);
        let to = above.iter().position(|above| *above == frame)?;
        above.iter().take(to).map(|frame| self.edges.get(*frame)).collect()
    }

    /// The edges from the camera's frame up to the best fixed frame. With `any`, up to the root if there is no fixed frame.
    /// `None` if there is no way, or no edge of it ever moves.
    pub(crate) fn edges_to_fixed_frame(&self, any: bool) -> Option<Vec<&TransformEdge>> {
        let above = self.frames_above(&self.camera);
        let best =
            above.iter().filter_map(|frame| Some((fixed_frame_rank(frame)?, *frame))).min().map(|(_, frame)| frame);
        let way = self.edges_up_to(best.or(above.last().copied().filter(|_| any))?)?;
        way.iter().any(|edge| edge.is_moving()).then_some(way)
    }
}

/// Index in [`FIXED_FRAMES`] of a frame with one of those names: `map`, `robot1/map`.
fn fixed_frame_rank(frame: &str) -> Option<usize> {
    let name = frame.rsplit('/').next().unwrap_or(frame);
    FIXED_FRAMES.iter().position(|standing| *standing == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mcap::{message_times::MessageClock, messages::MessageHead};
    use glam::{DQuat, DVec3};

    fn placed(frame: &str, what: &str, stamp_ns: i64, x: f64) -> StampedTransform {
        let placing = RigidTransform { position: DVec3::new(x, 0.0, 0.0), rotation: DQuat::IDENTITY };
        StampedTransform {
            head: MessageHead { stamp_ns, frame: frame.to_owned() },
            child_frame: Some(what.to_owned()),
            placing,
            has_rotation: true,
        }
    }

    fn on_stamps(way: &[&TransformEdge]) -> Vec<(i64, RigidTransform)> {
        placings_along(way, &vec![StreamTiming::whole(MessageClock::Stamp); way.len()])
    }

    fn tree(all: &[(&str, &str, i64, f64, bool)]) -> TransformTree {
        let mut tree = TransformTree::new("cam");
        for (frame, what, stamp_ns, x, fixed) in all {
            tree.add_placed(0, placed(frame, what, *stamp_ns, *x), *fixed);
        }
        tree
    }

    #[test]
    fn a_way_up_is_taken_at_every_time_at_which_something_moved() {
        let tree = tree(&[
            ("base", "cam", 0, 0.25, true),
            ("odom", "base", 10, 1.0, false),
            ("odom", "base", 30, 3.0, false),
            ("map", "odom", 5, 100.0, false),
            ("map", "odom", 20, 200.0, false),
            ("map", "odom", 40, 200.0, false),
            ("base", "arm", 40, 7.0, false),
        ]);
        let way = tree.edges_to_fixed_frame(false).unwrap();
        let found: Vec<_> = on_stamps(&way).iter().map(|(at, placing)| (*at, placing.position.x)).collect();
        let third = 100.0 + 100.0 / 3.0;
        assert_eq!(found.len(), 3);
        for ((at, x), (expected_at, expected)) in found.iter().zip([(10, third + 1.25), (20, 202.25), (30, 203.25)]) {
            assert_eq!(*at, expected_at);
            assert!((x - expected).abs() < 1e-9, "{x} {expected}");
        }
        assert!(!tree.edges.contains_key("arm"));
    }

    #[test]
    fn a_map_that_is_known_later_counts() {
        let tree =
            tree(&[("odom", "cam", 1, 1.0, false), ("odom", "cam", 3, 1.0, false), ("map", "odom", 2, 10.0, true)]);
        assert_eq!(tree.edges_to_fixed_frame(false).unwrap().len(), 2);
        assert_eq!(on_stamps(&tree.edges_to_fixed_frame(false).unwrap())[1].1.position.x, 11.0);
    }

    #[test]
    fn edges_to_fixed_frame_needs_a_fixed_frame() {
        let moving = [("base", "cam", 1, 0.0, false), ("base", "cam", 2, 0.0, false)];
        assert!(tree(&moving).edges_to_fixed_frame(false).is_none());
        assert!(tree(&moving).edges_to_fixed_frame(true).is_some());
        assert!(tree(&[("map", "cam", 1, 0.0, true)]).edges_to_fixed_frame(true).is_none());
        // Two frames that are placed in each other do not make an endless loop.
        let round = [("b", "cam", 1, 0.0, false), ("cam", "b", 1, 0.0, false), ("b", "cam", 2, 0.0, false)];
        assert!(tree(&round).edges_to_fixed_frame(false).is_none());
    }

    #[test]
    fn find_fault_names_two_parents_and_circles() {
        let good = [("base", "cam", 0, 0.0, true), ("odom", "base", 1, 0.0, false), ("odom", "base", 2, 1.0, false)];
        assert_eq!(tree(&good).find_fault(), None);
        let fault = |more: &[(&str, &str, i64, f64, bool)]| tree(&[&good[..], more].concat()).find_fault();
        let two = fault(&[("map", "base", 3, 0.0, false)]).unwrap();
        assert_eq!(two, "the transforms place the frame base both in odom and in map");
        // Not on the way up.
        assert_eq!(fault(&[("base", "arm", 3, 0.0, false), ("cam", "arm", 3, 0.0, false)]), None);
        let round = tree(&[("b", "cam", 1, 0.0, false), ("cam", "b", 1, 0.0, false)]).find_fault().unwrap();
        assert_eq!(round, "the transforms go round in a circle: cam in b in cam");
        let own = tree(&[("b", "cam", 1, 0.0, false), ("b", "b", 1, 0.0, false)]).find_fault().unwrap();
        assert_eq!(own, "the transforms place the frame b in itself");
    }
}
