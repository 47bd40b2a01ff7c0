//! A path through a scene: frames in order, and the target where there is one.

use crate::{Heading, ObjectId, PathMotion, PathMove, Pose, SceneId, Side, ViewpointId};
use glam::DVec3;
use serde::{Deserialize, Serialize, Serializer, ser::SerializeStruct};

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

/// A path: frames in order. Where its motion is unknown, its JSON has no poses.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(try_from = "ReadPath")]
pub struct Path {
    /// Name of the path, unique within its dataset or run.
    pub id: String,
    /// The scene that it lies in.
    pub scene: SceneId,
    /// At least one frame. The first looks along the episode's heading, every later one along the hop just made.
    pub frames: Vec<Frame>,
    /// Whether the frames' poses mean anything.
    pub motion: PathMotion,
    /// The object that the task at the end is about, where there is one.
    pub target: Option<PathTarget>,
}

/// A path as JSON has it.
#[derive(Deserialize)]
struct ReadPath {
    id: String,
    scene: SceneId,
    frames: Vec<ReadFrame>,
    #[serde(default)]
    motion: PathMotion,
    #[serde(default)]
    target: Option<PathTarget>,
}

/// A frame as JSON has it: without a pose where the motion of its path is unknown.
#[derive(Deserialize)]
struct ReadFrame {
    #[serde(default)]
    pose: Option<Pose>,
    #[serde(default)]
    viewpoint: Option<ViewpointId>,
    #[serde(default)]
    level: Option<u32>,
}

impl TryFrom<ReadPath> for Path {
    type Error = String;

    fn try_from(read: ReadPath) -> Result<Self, String> {
        let ReadPath { id, scene, frames, motion, target } = read;
        let frame = |(at, ReadFrame { pose, viewpoint, level }): (usize, ReadFrame)| {
            let unknown = (!motion.is_known()).then(|| Pose::looking_level(DVec3::ZERO, Heading::NORTH));
            let pose = pose.or(unknown).ok_or_else(|| format!("frame {at} has no field `pose`"))?;
            Ok(Frame { pose, viewpoint, level })
        };
        let frames = frames.into_iter().enumerate().map(frame).collect::<Result<_, String>>()?;
        Ok(Self { id, scene, frames, motion, target })
    }
}

/// A frame without its pose.
#[derive(Serialize)]
struct UnposedFrame<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    viewpoint: Option<&'a ViewpointId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<u32>,
}

impl<'a> From<&'a Frame> for UnposedFrame<'a> {
    fn from(frame: &'a Frame) -> Self {
        Self { viewpoint: frame.viewpoint.as_ref(), level: frame.level }
    }
}

impl Serialize for Path {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let is_known = self.motion.is_known();
        let fields = 3 + usize::from(!is_known) + usize::from(self.target.is_some());
        let mut path = serializer.serialize_struct("Path", fields)?;
        path.serialize_field("id", &self.id)?;
        path.serialize_field("scene", &self.scene)?;
        if is_known {
            path.serialize_field("frames", &self.frames)?;
        } else {
            // Their poses are made up.
            path.serialize_field("frames", &self.frames.iter().map(UnposedFrame::from).collect::<Vec<_>>())?;
            path.serialize_field("motion", &self.motion)?;
        }
        if let Some(target) = &self.target {
            path.serialize_field("target", target)?;
        }
        path.end()
    }
}

/// The object that an instruction's task is about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PathTarget {
    /// Its id in the scene.
    pub object: ObjectId,
    /// Its name, as the labels have it.
    pub name: String,
    /// Ways to tell it from its namesakes at the last frame, best first; empty where none is visible.
    #[serde(default)]
    pub told_by: Vec<ObjectDistinction>,
    /// Whether something of the same name is visible at the last frame too.
    #[serde(default)]
    pub has_namesake: bool,
    /// Ways to describe it to a person who knows the whole building, best first: the shortest that fit no other object,
    /// or else those that fit the fewest. Empty where the platform knows no rooms or objects of the building.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub descriptions: Vec<ObjectDescription>,
    /// Whether it certainly hangs on a wall.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub hangs: bool,
    /// How many storeys its building has; 0 where that is not known.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub storeys: usize,
}

impl PathTarget {
    /// All facts that are known of it: those of `told_by` and of its descriptions.
    pub fn known_facts(&self) -> impl Iterator<Item = &ObjectDistinction> {
        self.told_by.iter().chain(self.descriptions.iter().flat_map(|description| &description.by))
    }
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference.
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Facts about an object that distinguish it from others, in addition to its name and the kind of its room.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ObjectDescription {
    /// The facts; all are true of the object.
    pub by: Vec<ObjectDistinction>,
    /// How many objects of the building fit all these facts, the object itself counted.
    pub leaves: usize,
}

impl ObjectDescription {
    /// Whether it names the storey.
    #[must_use]
    pub fn tells_level(&self) -> bool {
        self.by.iter().any(|by| matches!(by, ObjectDistinction::Level { .. }))
    }

    /// Whether it fits one object alone.
    #[must_use]
    pub fn fits_one_object(&self) -> bool {
        self.leaves == 1
    }
}

/// One way to tell an object from its namesakes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum ObjectDistinction {
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
    /// It is nearer to an object of this (unique) name than any namesake.
    NextTo {
        /// Name of that neighbour.
        neighbour: String,
    },
    /// It is the nearest to the last frame, or the farthest.
    Range {
        /// Nearest where true, farthest where false.
        nearest: bool,
    },
    /// Where it is from an object of this name, as seen from the last frame.
    Related {
        /// The relation between the two.
        relation: ObjectRelation,
        /// Name of the other.
        to: String,
    },
    /// It is between two objects of these names.
    Between {
        /// One of them.
        one: String,
        /// The other.
        other: String,
    },
    /// Its place in the row of its namesakes, as seen from the last frame.
    InRow {
        /// Counted from 1.
        place: usize,
        /// How many things the row has.
        of: usize,
        /// From the left, or from the right.
        from: Side,
    },
    /// It is the highest among its namesakes, or the lowest.
    Height {
        /// Highest where true, lowest where false.
        highest: bool,
    },
    /// Its room is on this storey.
    Level {
        /// The lowest is 1.
        level: u32,
    },
    /// Its room is next to a room of this name.
    RoomBy {
        /// The other room.
        room: String,
    },
    /// Its room contains a thing of this name, and no other room of the kind does.
    RoomWith {
        /// Name of the thing.
        thing: String,
    },
}

/// The spatial relation of an object to another that is near it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ObjectRelation {
    /// Next to it, or close to it.
    Near,
    /// Over it.
    Above,
    /// Below it.
    Under,
    /// Resting on it.
    On,
    /// To its left.
    LeftOf,
    /// To its right.
    RightOf,
}

impl ObjectRelation {
    /// The preposition: "above".
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Near => "near",
            Self::Above => "above",
            Self::Under => "under",
            Self::On => "on",
            Self::LeftOf => "to the left of",
            Self::RightOf => "to the right of",
        }
    }
}

impl ObjectDistinction {
    /// Whether it distinguishes the room, and not the object in the room.
    #[must_use]
    pub fn is_about_room(&self) -> bool {
        matches!(self, Self::Level { .. } | Self::RoomBy { .. } | Self::RoomWith { .. })
    }

    /// The other rooms and things that it names, in addition to the object.
    pub fn named_things(&self) -> impl Iterator<Item = &str> {
        let (one, other) = match self {
            Self::NextTo { neighbour: name }
            | Self::Related { to: name, .. }
            | Self::RoomBy { room: name }
            | Self::RoomWith { thing: name } => (Some(name), None),
            Self::Between { one, other } => (Some(one), Some(other)),
            _ => (None, None),
        };
        one.into_iter().chain(other).map(String::as_str)
    }

    /// Words that follow "it is": "next to the bed".
    #[must_use]
    pub fn to_predicate(&self) -> String {
        let side = |side: Side| match side {
            Side::Ahead => "ahead",
            Side::Right => "on the right",
            Side::Behind => "behind",
            Side::Left => "on the left",
        };
        match self {
            Self::Colour { colour } => colour.clone(),
            Self::OnSide { side: on } => format!("{} of somebody who arrives", side(*on)),
            Self::NextTo { neighbour } => format!("next to the {neighbour}"),
            Self::Range { nearest: true } => "the nearest one".to_owned(),
            Self::Range { nearest: false } => "the farthest one".to_owned(),
            Self::Related { relation, to } => format!("{} the {to}", relation.word()),
            Self::Between { one, other } => format!("between the {one} and the {other}"),
            Self::InRow { place, of, from } => {
                let from = if *from == Side::Left { "left" } else { "right" };
                format!("number {place} of {of} from the {from}")
            }
            Self::Height { highest: true } => "the highest one".to_owned(),
            Self::Height { highest: false } => "the lowest one".to_owned(),
            Self::Level { level } => format!("on level {level}"),
            Self::RoomBy { room } => format!("in a room beside the {room}"),
            Self::RoomWith { thing } => format!("in a room with a {thing}"),
        }
    }

    /// Whether it is true only for a person at the last frame who looks along the path.
    #[must_use]
    pub fn needs_pose(&self) -> bool {
        use ObjectRelation::{LeftOf, RightOf};
        let by_side = matches!(self, Self::Related { relation: LeftOf | RightOf, .. });
        by_side || matches!(self, Self::OnSide { .. } | Self::Range { .. } | Self::InRow { .. } | Self::Level { .. })
    }
}

impl Frame {
    /// A key that is equal for frames at one place, which see the same. It contains the viewpoint's name as well as
    /// the position, because frames without poses differ only by name.
    #[must_use]
    pub fn place_key(&self) -> ([u64; 3], Option<ViewpointId>) {
        (self.pose.position.to_array().map(f64::to_bits), self.viewpoint.clone())
    }
}

impl Path {
    /// Frames along `stops`. The first looks along `start_heading` (along the first hop where there is none), each
    /// later one along the hop just made. A hop straight up or down keeps the heading.
    #[must_use]
    pub fn frames_along(stops: Vec<PathStop>, start_heading: Option<Heading>) -> Vec<Frame> {
        let first_hop = stops.windows(2).find_map(|pair| Heading::towards(pair[0].position, pair[1].position));
        let mut heading = start_heading.or(first_hop).unwrap_or(Heading::NORTH);
        let mut last_position: Option<DVec3> = None;
        stops
            .into_iter()
            .map(|stop| {
                if let Some(hop) = last_position.and_then(|from| Heading::towards(from, stop.position)) {
                    heading = hop;
                }
                last_position = Some(stop.position);
                Frame {
                    pose: Pose::looking_level(stop.position, heading),
                    viewpoint: stop.viewpoint,
                    level: stop.level,
                }
            })
            .collect()
    }

    /// The moves between its frames, one fewer than frames: move `i` turns at frame `i` and walks to frame `i + 1`.
    /// Empty where the motion is unknown.
    #[must_use]
    pub fn moves(&self) -> Vec<PathMove> {
        if !self.motion.is_known() {
            return Vec::new();
        }
        self.frames.windows(2).map(|pair| PathMove::between_poses(&pair[0].pose, &pair[1].pose)).collect()
    }

    /// Its length, metres; `None` where the motion is unknown.
    #[must_use]
    pub fn length_m(&self) -> Option<f64> {
        self.motion.is_known().then(|| self.moves().iter().map(|step| step.distance_m).sum())
    }
}

/// A position on a path before its heading is known.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStop {
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

    fn stop(x: f64, y: f64, z: f64) -> PathStop {
        PathStop { position: DVec3::new(x, y, z), viewpoint: None, level: None }
    }

    fn path(stops: Vec<PathStop>, start: Option<Heading>) -> Path {
        Path {
            id: "p".into(),
            scene: SceneId::new("s").unwrap(),
            frames: Path::frames_along(stops, start),
            motion: PathMotion::Known,
            target: None,
        }
    }

    #[test]
    fn json_has_poses_only_where_the_motion_is_known() {
        let known = path(vec![stop(1.0, 0.0, 0.0), stop(1.0, 2.0, 0.0)], None);
        let json = serde_json::to_value(&known).unwrap();
        assert_eq!(json["frames"][1]["pose"]["position"], serde_json::json!([1.0, 2.0, 0.0]));
        assert!(json.get("motion").is_none() && json.get("target").is_none());
        assert_eq!(serde_json::from_value::<Path>(json.clone()).unwrap(), known);
        let unknown = Path { motion: PathMotion::Unknown, ..known };
        let bare = serde_json::to_value(&unknown).unwrap();
        assert_eq!(bare["frames"], serde_json::json!([{}, {}]));
        let read: Path = serde_json::from_value(bare.clone()).unwrap();
        assert_eq!(
            (read.frames.len(), read.frames[1].pose.position, read.motion),
            (2, DVec3::ZERO, PathMotion::Unknown)
        );
        // As older versions wrote it.
        let mut older = json;
        older["motion"] = bare["motion"].clone();
        assert_eq!(serde_json::from_value::<Path>(older.clone()).unwrap(), unknown);
        older["motion"] = "known".into();
        older["frames"][1]["pose"] = serde_json::Value::Null;
        assert_eq!(serde_json::from_value::<Path>(older).unwrap_err().to_string(), "frame 1 has no field `pose`");
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
    fn place_differs_by_name_where_frames_have_no_poses() {
        let frame = |name: &str| Frame {
            pose: Pose::looking_level(DVec3::ZERO, Heading::NORTH),
            viewpoint: Some(ViewpointId::new(name).unwrap()),
            level: None,
        };
        assert_ne!(frame("a").place_key(), frame("b").place_key());
        assert_eq!(frame("a").place_key(), frame("a").place_key());
    }

    #[test]
    fn unknown_motion_has_no_moves_and_no_length() {
        let known = path(vec![stop(0.0, 0.0, 0.0), stop(2.0, 0.0, 0.0)], None);
        let unknown = Path { motion: PathMotion::Unknown, ..known.clone() };
        assert_eq!((unknown.moves(), unknown.length_m()), (Vec::new(), None));
        assert_eq!(known.length_m(), Some(2.0));
        // Paths with poses are written as before.
        assert!(!serde_json::to_string(&known).unwrap().contains("motion"));
        let text = serde_json::to_string(&unknown).unwrap();
        assert!(text.contains(r#""motion":"unknown""#), "{text}");
        let read = serde_json::from_str::<Path>(&text).unwrap();
        assert_eq!((read.motion, serde_json::to_string(&read).unwrap()), (PathMotion::Unknown, text));
    }
}
