//! Reads ROS 2 recordings from MCAP files (`ros2 bag record`, Foxglove): the pictures of one camera, and its poses.
//!
//! A camera's pose comes from a chain of transforms: of the camera on the robot, of the robot in the frame of its odometry,
//! and of that frame in the map. A placing is the position and rotation of one frame in another at one time.
//!
//! Memory holds only the poses, and the places of the pictures in the file.

mod bag;
mod cdr;
mod clock_gap;
mod clock_parts;
#[cfg(test)]
mod clock_tests;
mod clocks;
mod contents;
mod gather;
mod message_times;
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

pub(crate) use bag::find_bag_files;

use crate::{
    axes::{PoseAxes, PoseBody, rotation_columns},
    describe::{self, RecordingDescription},
    names,
    pose_plausibility::{PoseSample, find_doubt},
    reel::{Recording, RecordingSource},
    track::{CameraTrack, TrackFix},
};
use clocks::{ClockPlan, plan_clocks};
use gather::{McapPart, PictureShot};
use glam::DVec3 as Vector;
use message_times::{MessageClock, StreamTiming};
use messages::{MessageKind, RigidTransform};
use poses::TransformChain;
use reel::TopicReel;
use std::path::{Path, PathBuf};
use topics::TopicsByName;
use wayword_core::{DVec3, PlatformError, SceneId};
use wayword_world::files;

const MCAP_HINT: &str = "give a file that `ros2 bag record --storage mcap` wrote";

/// A recording in one MCAP file, or in the several files of a bag.
pub(crate) struct McapFile {
    /// The file, or the bag's folder.
    path: PathBuf,
    /// The files in their order.
    files: Vec<PathBuf>,
    scene: SceneId,
    described: RecordingDescription,
}

impl McapFile {
    /// A file that is MCAP by its ending; its content is not checked yet.
    ///
    /// # Errors
    /// When its name cannot be the name of a scene.
    pub(crate) fn open(path: &Path, described: RecordingDescription) -> Result<Self, PlatformError> {
        Self::open_bag(path, vec![path.to_owned()], described)
    }

    /// The files of a bag in a folder; their contents are not checked yet.
    ///
    /// # Errors
    /// When the folder's name cannot be the name of a scene.
    pub(crate) fn open_bag(
        path: &Path,
        files: Vec<PathBuf>,
        described: RecordingDescription,
    ) -> Result<Self, PlatformError> {
        Ok(Self { path: path.to_owned(), files, scene: names::scene_id_for_path(path)?, described })
    }

    /// Finds the camera, and reads the times of its pictures and its track.
    fn read_recording(&self) -> Result<Recording, PlatformError> {
        let parts: Vec<McapPart> = self.files.iter().map(|file| McapPart::open(file)).collect::<Result<_, _>>()?;
        let unclear = |(why, hint): topics::UnclearReason| {
            let broken = parts.iter().find_map(|part| part.broken_error(&why));
            broken.unwrap_or_else(|| files::file_error(&self.path, why, hint))
        };
        let topics = gather::join_topics(&parts);
        let (heads, lenses) = gather::read_beginnings(&parts)?;
        let camera = topics::choose_camera(&topics, &heads, self.described.camera.as_deref()).map_err(unclear)?;
        let named = self.named_poses(&topics).map_err(unclear)?;
        let frame = heads.get(camera).map_or("", |head| head.head.frame.as_str());
        let (shots, poses) = gather::gather_messages(&parts, camera, frame)?;
        let chain = poses.choose_chain(named).map_err(unclear)?;
        let times: Vec<_> = shots.iter().map(|shot| shot.times).collect();
        let edges = chain.as_ref().map_or(&[][..], TransformChain::edges);
        let plan = plan_clocks(&times, edges, &self.described).map_err(unclear)?;
        let (track, camera_timing) = self.find_track(&shots, chain.as_ref(), frame, &plan);
        let shots = timed_shots(shots, &camera_timing);
        let first_ns = shots.first().map_or(0, |(time_ns, _)| *time_ns);
        let horizontal_fov_rad = topics::find_lens(&lenses, camera, frame).and_then(|lens| lens.horizontal_fov_rad);
        let broken: Vec<String> = parts.iter().filter_map(McapPart::describe_break).collect();
        let last_s = shots.last().map_or(0.0, |(time_ns, _)| seconds_since(*time_ns, first_ns));
        let lost = (!broken.is_empty()).then(|| {
            format!(
                "{}, so the pictures end after {last_s:.1} s, and what was recorded later is missing; `mcap recover` may save more",
                broken.join(", and ")
            )
        });
        let remarks = lost.into_iter().chain(plan.remarks).chain(poses.describe_unturned(chain.as_ref()));
        let pictures = TopicReel {
            files: self.files.clone(),
            topic: camera.to_owned(),
            kind: topics.get(camera).and_then(|topic| topic.kind).unwrap_or(MessageKind::Raw),
            times_s: shots.iter().map(|(time_ns, _)| seconds_since(*time_ns, first_ns)).collect(),
            places: shots.iter().map(|(_, shot)| shot.place).collect(),
            remarks: remarks.map(|remark| format!("{}: {remark}", self.path.display())).collect(),
        };
        Ok(Recording { reel: Box::new(pictures), track, horizontal_fov_rad, described: self.described.clone() })
    }

    /// The pose topic that the user named; `None` if the user named none.
    fn named_poses(&self, topics: &TopicsByName) -> Result<Option<(&str, MessageKind)>, topics::UnclearReason> {
        let Some(named) = self.described.poses.as_deref() else { return Ok(None) };
        let kind = topics.get(named).and_then(|topic| topic.kind).filter(|kind| kind.is_pose());
        kind.map(|kind| Some((named, kind))).ok_or_else(|| {
            let poses = topics.iter().filter(|(_, topic)| topic.kind.is_some_and(MessageKind::is_pose));
            let poses = topics::list_names(poses.map(|(name, _)| name.as_str()));
            let reason = format!(
                "has no pose topic {named}; its pose topics: {}",
                if poses.is_empty() { "none" } else { &poses }
            );
            (reason, "name one of these as `poses`, or leave it out")
        })
    }

    /// The track of the camera, and the timing of the pictures. The clock of both is that of the stamps. If all stamps of either are
    /// missing, or if their time spans do not overlap, it is the recorder's clock instead.
    fn find_track(
        &self,
        shots: &[PictureShot],
        chain: Option<&TransformChain<'_>>,
        frame: &str,
        plan: &ClockPlan,
    ) -> (Option<CameraTrack>, StreamTiming) {
        let has_stamps = plan.camera.clock == MessageClock::Stamp && shots.iter().any(|shot| shot.times.stamp_ns != 0);
        let by_recorder = plan.on_recorder_clock();
        let usual = if has_stamps { &plan.camera } else { &by_recorder.camera };
        let Some(chain) = chain else { return (None, usual.clone()) };
        let track_on = |plan: &ClockPlan| {
            let times = shots.iter().filter_map(|shot| plan.camera.time_of(shot.times));
            let (first_ns, last_ns) = (times.clone().min()?, times.max()?);
            let placings = chain.chain_placings(&plan.edges);
            let overlaps = placings.first()?.0 <= last_ns && placings.last()?.0 >= first_ns;
            let axes = self.described.axes_or_usual(PoseAxes::for_body(if chain.starts_at_camera {
                body_for_frame(&placings, frame)
            } else {
                PoseBody::Robot
            }));
            let fixes = || fixes_from_placings(&placings, first_ns, axes, chain.has_rotations);
            let track = overlaps.then(fixes).and_then(CameraTrack::new)?;
            let samples = samples_from_placings(&placings, chain.has_rotations);
            Some(match find_doubt(&samples, axes, &self.described) {
                Some(doubt) => track.in_doubt(format!("{}: {}", self.path.display(), doubt.into_words())),
                None => track,
            })
        };
        let plans = has_stamps.then_some(plan).into_iter().chain([&by_recorder]);
        let found = plans.map(|plan| track_on(plan).map(|track| (Some(track), plan.camera.clone())));
        found.flatten().next().unwrap_or_else(|| (None, usual.clone()))
    }
}

/// The pictures that count, with their times, in the order of these. Of messages that were recorded twice, the first counts.
fn timed_shots(shots: Vec<PictureShot>, timing: &StreamTiming) -> Vec<(i64, PictureShot)> {
    let timed = shots.into_iter().filter_map(|shot| Some((timing.time_of(shot.times)?, shot)));
    let mut shots: Vec<(i64, PictureShot)> = timed.collect();
    shots.sort_by_key(|(time_ns, shot)| (*time_ns, shot.place));
    // Without a clock, all pictures have one time.
    let is_clock = shots.first().map(|(time_ns, _)| time_ns) != shots.last().map(|(time_ns, _)| time_ns);
    shots.dedup_by(|(later_ns, _), (first_ns, _)| is_clock && later_ns == first_ns);
    shots
}

/// Placings of the camera as fixes in Wayword's frame.
fn fixes_from_placings(
    placings: &[(i64, RigidTransform)],
    first_ns: i64,
    axes: PoseAxes,
    has_rotations: bool,
) -> Vec<TrackFix> {
    let fix = |(time_ns, placing): &(i64, RigidTransform)| TrackFix {
        time_s: seconds_since(*time_ns, first_ns),
        position: axes.wayword_from_recorded(DVec3::from(placing.position.to_array())),
        heading: axes.heading_by_quaternion(placing.rotation.to_array()).filter(|_| has_rotations),
    };
    placings.iter().map(fix).collect()
}

/// Placings of the camera as poses in the recorded frame.
fn samples_from_placings(placings: &[(i64, RigidTransform)], has_rotations: bool) -> Vec<PoseSample> {
    let sample = |(_, placing): &(i64, RigidTransform)| PoseSample {
        position: DVec3::from(placing.position.to_array()),
        recorded_from_body: rotation_columns(placing.rotation.to_array()).filter(|_| has_rotations),
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
        let described = if self.path.is_dir() {
            vec![self.path.join(describe::FOLDER_FILE), self.path.join(bag::METADATA_FILE)]
        } else {
            RecordingDescription::files_beside(&self.path).to_vec()
        };
        Ok(names::plain_files(self.files.iter().cloned().chain(described)))
    }
}
