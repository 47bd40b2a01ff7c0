//! Reads ROS 2 recordings from MCAP files (`ros2 bag record`, Foxglove): the pictures of one camera, and its poses.
//!
//! A camera's pose comes from a chain of transforms: of the camera on the robot, of the robot in the frame of its odometry,
//! and of that frame in the map. A placing is the position and rotation of one frame in another at one time.
//!
//! Memory holds only the poses, and the places of the pictures in the file.

mod cdr;
mod contents;
mod messages;
mod pixels;
mod poses;
mod record;
mod records;
mod reel;
#[cfg(test)]
mod tests;
mod topics;
mod transform_tree;

use crate::{
    axes::{PoseAxes, PoseBody, rotation_columns},
    describe::RecordingDescription,
    file_kind, names,
    pose_plausibility::{PoseSample, find_doubt},
    reel::{Recording, RecordingSource},
    track::{CameraTrack, TrackFix},
};
use ::mcap::MAGIC;
use contents::{McapContents, TopicMessage};
use glam::DVec3 as Vector;
use messages::{CameraLens, MessageKind, PictureHead, RigidTransform};
use poses::{RecordedPoses, TransformChain};
use record::RecordPlace;
use reel::TopicReel;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::Read,
    ops::ControlFlow,
    path::{Path, PathBuf},
};
use topics::PictureHeads;
use transform_tree::{MessageClock, MessageTimes};
use wayword_core::{DVec3, PlatformError, SceneId};
use wayword_world::files;

const MCAP_HINT: &str = "give a file that `ros2 bag record --storage mcap` wrote";

/// An MCAP file.
pub(crate) struct McapFile {
    path: PathBuf,
    scene: SceneId,
    described: RecordingDescription,
}

impl McapFile {
    /// A file that is MCAP by its ending; its content is not checked yet.
    ///
    /// # Errors
    /// When its name cannot be the name of a scene.
    pub(crate) fn open(path: &Path, described: RecordingDescription) -> Result<Self, PlatformError> {
        Ok(Self { path: path.to_owned(), scene: names::scene_id_for_path(path)?, described })
    }

    /// Checks whether its first bytes are those of an MCAP file.
    fn check_magic(&self) -> Result<(), PlatformError> {
        let mut begin = [0; MAGIC.len()];
        let read = File::open(&self.path).and_then(|mut file| file.read_exact(&mut begin));
        if read.is_ok() && begin == *MAGIC {
            return Ok(());
        }
        let reason = match read {
            Err(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => error.to_string(),
            _ => "byte 0: does not begin like an MCAP file".to_owned(),
        };
        Err(file_kind::refuse_file(&self.path, "an MCAP file", (reason, MCAP_HINT)))
    }

    fn file_error(&self, (reason, hint): topics::UnclearReason) -> PlatformError {
        files::file_error(&self.path, reason, hint)
    }

    /// Finds the camera, and reads the times of its pictures and its track.
    fn read_recording(&self) -> Result<Recording, PlatformError> {
        self.check_magic()?;
        let broken = |why: String| {
            self.file_error((why, "if it is damaged, `mcap recover IN.mcap -o OUT.mcap` saves what can be saved"))
        };
        let file = File::open(&self.path).map_err(|error| broken(error.to_string()))?;
        let contents = McapContents::from_file(&file).map_err(broken)?;
        let unclear = |(why, hint): topics::UnclearReason| match &contents.broken {
            Some(end) => broken(format!("{why} (it can be read only up to {end})")),
            None => self.file_error((why, hint)),
        };
        let (heads, lenses) = read_beginnings(&file, &contents).map_err(broken)?;
        let camera = topics::choose_camera(&contents, &heads, self.described.camera.as_deref()).map_err(unclear)?;
        let named = self.named_poses(&contents).map_err(unclear)?;
        let frame = heads.get(camera).map_or("", |head| head.head.frame.as_str());
        let (mut shots, poses) = gather_messages(&file, &contents, camera, frame).map_err(broken)?;
        let chain = poses.choose_chain(named).map_err(unclear)?;
        let (track, clock) = self.find_track(&shots, chain.as_ref(), frame);
        shots.retain(|shot| shot.times.time_on(clock).is_some());
        let time_ns = |shot: &PictureShot| shot.times.time_on(clock).unwrap_or_default();
        shots.sort_by_key(|shot| (time_ns(shot), shot.place));
        let first_ns = shots.first().map_or(0, time_ns);
        let horizontal_fov_rad = topics::find_lens(&lenses, camera, frame).and_then(|lens| lens.horizontal_fov_rad);
        let pictures = TopicReel {
            file: self.path.clone(),
            topic: camera.to_owned(),
            kind: contents.topics.get(camera).and_then(|topic| topic.kind).unwrap_or(MessageKind::Raw),
            times_s: shots.iter().map(|shot| seconds_since(time_ns(shot), first_ns)).collect(),
            places: shots.iter().map(|shot| shot.place).collect(),
        };
        Ok(Recording { reel: Box::new(pictures), track, horizontal_fov_rad, described: self.described.clone() })
    }

    /// The pose topic that the user named; `None` if the user named none.
    fn named_poses(&self, contents: &McapContents) -> Result<Option<(&str, MessageKind)>, topics::UnclearReason> {
        let Some(named) = self.described.poses.as_deref() else { return Ok(None) };
        let kind = contents.topics.get(named).and_then(|topic| topic.kind).filter(|kind| kind.is_pose());
        kind.map(|kind| Some((named, kind))).ok_or_else(|| {
            let poses = contents.topics.iter().filter(|(_, topic)| topic.kind.is_some_and(MessageKind::is_pose));
            let poses = topics::list_names(poses.map(|(name, _)| name.as_str()));
            let reason = format!(
                "has no pose topic {named}; its pose topics: {}",
                if poses.is_empty() { "none" } else { &poses }
            );
            (reason, "name one of these as `poses`, or leave it out")
        })
    }

    /// The track of the camera, and the clock that pictures and poses share. This is the clock of their own stamps. If all
    /// stamps of either are missing, or if their time spans do not overlap, it is the recorder's clock instead.
    fn find_track(
        &self,
        shots: &[PictureShot],
        chain: Option<&TransformChain<'_>>,
        frame: &str,
    ) -> (Option<CameraTrack>, MessageClock) {
        let has_stamps = shots.iter().any(|shot| shot.times.time_on(MessageClock::Stamp).is_some());
        let usual_clock = if has_stamps { MessageClock::Stamp } else { MessageClock::Log };
        let Some(chain) = chain else { return (None, usual_clock) };
        let track_on = |clock: MessageClock| {
            let times = shots.iter().filter_map(|shot| shot.times.time_on(clock));
            let (first_ns, last_ns) = (times.clone().min()?, times.max()?);
            let placings = chain.chain_placings(clock);
            let overlaps = placings.first()?.0 <= last_ns && placings.last()?.0 >= first_ns;
            let axes = self.described.axes_or_usual(PoseAxes::for_body(if chain.starts_at_camera {
                body_for_frame(&placings, frame)
            } else {
                PoseBody::Robot
            }));
            let track = overlaps.then(|| fixes_from_placings(&placings, first_ns, axes)).and_then(CameraTrack::new)?;
            Some(match find_doubt(&samples_from_placings(&placings), axes, &self.described) {
                Some(doubt) => track.in_doubt(format!("{}: {}", self.path.display(), doubt.into_words())),
                None => track,
            })
        };
        let clocks: &[MessageClock] =
            if has_stamps { &[MessageClock::Stamp, MessageClock::Log] } else { &[MessageClock::Log] };
        clocks.iter().find_map(|clock| Some((Some(track_on(*clock)?), *clock))).unwrap_or((None, usual_clock))
    }
}

/// Placings of the camera as fixes in Wayword's frame.
fn fixes_from_placings(placings: &[(i64, RigidTransform)], first_ns: i64, axes: PoseAxes) -> Vec<TrackFix> {
    let fix = |(time_ns, placing): &(i64, RigidTransform)| TrackFix {
        time_s: seconds_since(*time_ns, first_ns),
        position: axes.wayword_from_recorded(DVec3::from(placing.position.to_array())),
        heading: axes.heading_by_quaternion(placing.rotation.to_array()),
    };
    placings.iter().map(fix).collect()
}

/// Placings of the camera as poses in the recorded frame.
fn samples_from_placings(placings: &[(i64, RigidTransform)]) -> Vec<PoseSample> {
    let sample = |(_, placing): &(i64, RigidTransform)| PoseSample {
        position: DVec3::from(placing.position.to_array()),
        recorded_from_body: rotation_columns(placing.rotation.to_array()),
    };
    placings.iter().map(sample).collect()
}

/// The body that the frame of the pictures belongs to. By `sensor_msgs/msg/Image` it should be the optical frame, but some
/// recorders name the camera's body. An optical frame has its z axis ahead, and a camera does not look
/// straight up. So a frame with z within 37 degrees of up is a body.
fn body_for_frame(placings: &[(i64, RigidTransform)], frame: &str) -> PoseBody {
    let upright = placings.first().is_some_and(|(_, placing)| (placing.rotation * Vector::Z).z > 0.8);
    if upright && !frame.contains("optical") { PoseBody::Robot } else { PoseBody::Optical }
}

fn seconds_since(time_ns: i64, first_ns: i64) -> f64 {
    time_ns.saturating_sub(first_ns) as f64 * 1e-9
}

impl RecordingSource for McapFile {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        if *scene != self.scene {
            return Err(names::unknown_scene(scene, &self.scenes()));
        }
        self.read_recording()
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        if *scene != self.scene {
            return Err(names::unknown_scene(scene, &self.scenes()));
        }
        Ok(names::plain_files([self.path.clone(), RecordingDescription::file_beside(&self.path)]))
    }
}

/// The times of a picture, and its place in the file.
struct PictureShot {
    times: MessageTimes,
    place: RecordPlace,
}

/// The head of the first message of each camera, and the first message of each lens.
fn read_beginnings(
    file: &File,
    contents: &McapContents,
) -> Result<(PictureHeads, BTreeMap<String, CameraLens>), String> {
    let (mut heads, mut lenses) = (PictureHeads::new(), BTreeMap::new());
    let wanted = contents.channels_where(|_, kind| kind.is_picture() || kind == MessageKind::Lens);
    let mut missing: BTreeSet<&str> = wanted.values().map(|(topic, _)| *topic).collect();
    contents.each_message(file, &wanted, &mut |TopicMessage { topic, kind, bytes, .. }| {
        // Only the first message of a topic counts.
        if !missing.remove(topic) {
        } else if kind == MessageKind::Lens {
            // A lens that cannot be read counts as unknown.
            lenses.extend(CameraLens::read(bytes).ok().map(|lens| (topic.to_owned(), lens)));
        } else {
            heads.insert(topic.to_owned(), PictureHead::read(kind, bytes)?);
        }
        Ok(if missing.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok((heads, lenses))
}

/// The places of all pictures of a camera, and all poses.
fn gather_messages(
    file: &File,
    contents: &McapContents,
    camera: &str,
    frame: &str,
) -> Result<(Vec<PictureShot>, RecordedPoses), String> {
    let (mut shots, mut poses) = (Vec::new(), RecordedPoses::new(frame));
    let wanted = contents.channels_where(|topic, kind| kind.is_pose() || topic == camera);
    contents.each_message(file, &wanted, &mut |TopicMessage { topic, kind, logged_ns, place, bytes }| {
        if kind.is_picture() {
            let stamp_ns = PictureHead::read(kind, bytes)?.head.stamp_ns;
            shots.push(PictureShot { times: MessageTimes { stamp_ns, logged_ns }, place });
        } else {
            poses.add_message(topic, kind, logged_ns, messages::read_transforms(kind, bytes)?);
        }
        Ok(ControlFlow::Continue(()))
    })?;
    Ok((shots, poses))
}
