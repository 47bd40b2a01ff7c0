//! Recordings as a [`Platform`]: a scene is one recording, and paths run along its chosen frames.

#![allow(clippy::indexing_slicing, reason = "all indices are counted here, and none is read from a file")]

use crate::{
    choose::{FrameChoice, candidate_pictures, choose_frames},
    film_motion::{sampled_pictures, steps_by_pictures, steps_by_poses},
    open, poses,
    reel::{Recording, RecordingSource},
    track::CameraTrack,
};
use image::imageops::{FilterType, resize};
use rand::Rng;
use std::{
    collections::{BTreeMap, BTreeSet},
    ops::RangeInclusive,
    path::{Path as FilePath, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    CameraMotion, DVec3, Frame, Heading, Image, MotionSource, ObjectId, Path, PathMotion, PathRequest, Platform,
    PlatformError, Pose, RecentCache, SceneCatalogue, SceneFiles, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
    path::PathStop, seeded_rng,
};
use wayword_world::{files, output_lines::OutputListener};

/// Most recordings that stay open. Who works at more of them at the same time opens each again and again.
pub const MAX_OPEN_RECORDINGS: usize = 8;
/// Most pictures that stay in memory: 1.2 MB each at most.
const MAX_CACHED_PICTURES: usize = 256;
/// Frames that are read together, because a video has to be decoded from a key picture on, whichever picture is wanted.
const READ_AHEAD_FRAMES: usize = 16;
/// Pictures are scaled down until their longer side has at most this length, pixels. Other platforms draw pictures of about
/// this size, and vision models take them.
const MAX_LONGER_SIDE_PX: u32 = 640;
/// Horizontal field of view if neither the recording nor the user gives it, radians: that of a robot's or phone's usual
/// camera.
const USUAL_FOV_RAD: f64 = 70.0 * std::f64::consts::PI / 180.0;
/// A recording with at most this many frames is one path, however short or long it is.
pub(crate) const MAX_WHOLE_FRAMES: usize = 12;
/// Most unreadable recordings that an error lists; it gives the number of the others.
const MAX_LISTED_ERRORS: usize = 20;
const INTERVAL_HINT: &str = "record more, or set interval_m or interval_s in a recording.toml (docs/RECORDINGS.md)";

/// Folders of pictures, videos, MCAP files and LeRobot datasets.
///
/// A scene is one recording. Views exist only at the places where its pictures were taken, and in the direction of these
/// pictures. It has no labels and no rooms.
pub struct RecordingPlatform {
    path: PathBuf,
    source: Box<dyn RecordingSource>,
    hear: OutputListener,
    /// The remarks that the user has heard.
    heard: Mutex<BTreeSet<String>>,
    /// Opened one at a time, because opening looks at many pictures of a recording.
    opened: RecentCache<SceneId, OpenedRecording>,
    pictures: RecentCache<(SceneId, usize), Image>,
}

/// An open recording with its chosen frames.
struct OpenedRecording {
    recording: Recording,
    /// Numbers of the pictures that are frames, in order.
    stops: Vec<usize>,
    ids: Vec<ViewpointId>,
    /// The place of each frame; empty if the poses are not known.
    places: Vec<DVec3>,
    /// Indices into `stops`: frames to which the way from the frame before is not known. No path crosses such a gap.
    breaks: BTreeSet<usize>,
    graph: Arc<ViewpointGraph>,
}

impl RecordingPlatform {
    /// Opens a recording, or a folder with several. `hear` gets a line about each recording when its frames are chosen.
    ///
    /// # Errors
    /// When there is none, or this build cannot read its kind.
    pub fn open(path: &FilePath, hear: OutputListener) -> Result<Self, PlatformError> {
        let source = open::open_source(path, &*hear)?;
        Ok(Self::over(path, source, hear))
    }

    /// Opens a LeRobot dataset, to be seen through one of its cameras.
    ///
    /// # Errors
    /// When it is no such dataset, or has no such camera.
    #[cfg(feature = "lerobot")]
    pub fn open_dataset_camera(path: &FilePath, camera: &str, hear: OutputListener) -> Result<Self, PlatformError> {
        Ok(Self::over(path, open::open_lerobot(path, Some(camera))?, hear))
    }

    fn over(path: &FilePath, source: Box<dyn RecordingSource>, hear: OutputListener) -> Self {
        Self {
            path: path.to_owned(),
            source,
            hear,
            heard: Mutex::default(),
            opened: RecentCache::one_at_a_time(MAX_OPEN_RECORDINGS),
            pictures: RecentCache::new(MAX_CACHED_PICTURES),
        }
    }

    fn open_scene(&self, scene: &SceneId) -> Result<Arc<OpenedRecording>, PlatformError> {
        self.opened.get_or_make(scene.clone(), || {
            let recording = self.source.open(scene)?;
            let mut examined: BTreeMap<usize, Image> = BTreeMap::new();
            let choice = choose_frames(&recording, &mut |number, image| {
                if examined.len() < MAX_CACHED_PICTURES {
                    examined.insert(number, scale_down(image));
                }
            })?;
            (self.hear)(&describe_choice(scene, &recording, &choice));
            recording.reel.remarks().iter().for_each(|remark| self.hear_once(remark));
            if let Some(unread) = recording.track.as_ref().and_then(CameraTrack::unread) {
                self.hear_once(unread);
            }
            if recording.track.is_none() && recording.described.poses.is_none() {
                for line in poses::describe_unread(&self.path, &self.source.files(scene)?) {
                    (self.hear)(&line);
                }
            }
            if let Some(doubt) = recording.track.as_ref().and_then(CameraTrack::doubt) {
                (self.hear)(doubt);
            }
            for number in &choice.stops {
                if let Some(image) = examined.remove(number) {
                    self.pictures.put((scene.clone(), *number), image);
                }
            }
            OpenedRecording::new(scene, recording, choice)
        })
    }

    /// Tells the user something that may hold for several recordings.
    fn hear_once(&self, remark: &str) {
        let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        if heard.insert(remark.to_owned()) {
            (self.hear)(remark);
        }
    }

    /// The picture of a frame. The pictures of the next frames are read with it, and stay in memory.
    fn frame_picture(&self, scene: &SceneId, opened: &OpenedRecording, at: usize) -> Result<Arc<Image>, PlatformError> {
        self.pictures.get_or_make((scene.clone(), opened.stops[at]), || {
            let wanted = &opened.stops[at..opened.stops.len().min(at + READ_AHEAD_FRAMES)];
            let mut first = None;
            opened.recording.reel.hand_out_pictures(wanted, &mut |number, image| {
                let image = scale_down(&image);
                if number == wanted[0] {
                    first = Some(image);
                } else {
                    self.pictures.put((scene.clone(), number), image);
                }
                Ok(())
            })?;
            let name = || FilePath::new(opened.ids[at].as_str()).to_owned();
            first.ok_or_else(|| {
                files::file_error(&name(), "this picture cannot be read from the recording", INTERVAL_HINT)
            })
        })
    }
}

impl OpenedRecording {
    fn new(scene: &SceneId, recording: Recording, choice: FrameChoice) -> Result<Self, PlatformError> {
        let FrameChoice { stops, breaks, .. } = choice;
        let ids = stops.iter().map(|number| {
            let name = recording.reel.picture_name(*number);
            ViewpointId::new(name)
                .map_err(|error| files::file_error(FilePath::new(scene.as_str()), error.to_string(), INTERVAL_HINT))
        });
        let ids: Vec<ViewpointId> = ids.collect::<Result<_, _>>()?;
        let times_s = recording.reel.times_s();
        let places: Vec<DVec3> = match &recording.track {
            Some(track) => stops.iter().filter_map(|number| Some(track.fix_at(times_s[*number])?.position)).collect(),
            None => Vec::new(),
        };
        let graph = chain_graph(&ids, &places, &breaks)
            .map_err(|source| PlatformError::Graph { scene: scene.clone(), source })?;
        Ok(Self { recording, stops, ids, places, breaks, graph: Arc::new(graph) })
    }

    /// How its camera moves; `None` where the source is poses, and it has none.
    fn film_motion(&self, source: MotionSource) -> Result<Option<CameraMotion>, PlatformError> {
        let all_s = self.recording.reel.times_s();
        let pictures = sampled_pictures(all_s);
        let times_s: Vec<f64> = pictures.iter().map(|number| all_s[*number]).collect();
        let steps = match (source, &self.recording.track) {
            (MotionSource::Pictures, _) => {
                steps_by_pictures(&self.recording, &pictures, view_width(&self.recording).0)?
            }
            (MotionSource::Poses, Some(track)) => steps_by_poses(track, &times_s),
            (MotionSource::Poses, None) => return Ok(None),
        };
        let nearest = |stop: usize| {
            let after = pictures.partition_point(|number| *number < stop).min(pictures.len() - 1);
            let before = after.saturating_sub(1);
            let off = |at: usize| pictures[at].abs_diff(stop);
            if off(before) < off(after) { before } else { after }
        };
        let frames = self.ids.iter().cloned().zip(self.stops.iter().map(|stop| nearest(*stop))).collect();
        Ok(Some(CameraMotion { source, pictures, times_s, steps, frames }))
    }

    /// Whether turns and distances between the frames are known.
    fn motion(&self) -> PathMotion {
        if self.recording.track.is_some() { PathMotion::Known } else { PathMotion::Unknown }
    }

    /// Whether it has at most [`MAX_WHOLE_FRAMES`] frames, and no gap between them.
    fn is_short(&self) -> bool {
        self.stops.len() <= MAX_WHOLE_FRAMES && self.breaks.is_empty()
    }

    /// Frames from one stop to another, both included. Without a track all of them are at the origin and look north.
    fn frames_between(&self, first: usize, last: usize) -> Vec<Frame> {
        if self.recording.track.is_none() {
            let frame = |id: &ViewpointId| Frame {
                pose: Pose::looking_level(DVec3::ZERO, Heading::NORTH),
                viewpoint: Some(id.clone()),
                level: None,
            };
            return self.ids[first..=last].iter().map(frame).collect();
        }
        let stop =
            |at: usize| PathStop { position: self.places[at], viewpoint: Some(self.ids[at].clone()), level: None };
        Path::frames_along((first..=last).map(stop).collect(), self.heading_at(first))
    }

    /// The camera's heading at a frame: from the track if it has one, else along the path.
    fn heading_at(&self, at: usize) -> Option<Heading> {
        let track = self.recording.track.as_ref()?;
        let along = || {
            let hop = |from: usize, to: usize| Heading::towards(*self.places.get(from)?, *self.places.get(to)?);
            let before = at.checked_sub(1).filter(|_| !self.breaks.contains(&at));
            before.and_then(|before| hop(before, at)).or_else(|| hop(at, at + 1))
        };
        track.fix_at(self.recording.reel.times_s()[self.stops[at]])?.heading.or_else(along)
    }

    /// First and last stop of a path that fits the request: the whole recording if it fits, else a stretch of it;
    /// `None` if there is none. A short recording is taken whole, unless the request asks for another length than usual.
    fn choose_stretch(&self, request: &PathRequest, dice: &mut impl Rng) -> Option<(usize, usize)> {
        let end = self.stops.len().checked_sub(1).filter(|end| *end > 0)?;
        if self.is_short() && *request == PathRequest::default() {
            return Some((0, end));
        }
        let (distances, wanted) = self.measure_stops(request);
        // The last stops with which a stretch from `first` has a wanted length. Lengths grow with the last stop, so these stops
        // follow each other.
        let fitting_lasts = |first: usize| {
            let gap_or_end = self.breaks.range(first + 1..).next().copied().unwrap_or(end + 1);
            let rest = &distances[first + 1..gap_or_end];
            let first_fit = rest.partition_point(|to| to - distances[first] < *wanted.start());
            let fits_end = rest.partition_point(|to| to - distances[first] <= *wanted.end());
            first + 1 + first_fit..first + 1 + fits_end.max(first_fit)
        };
        if fitting_lasts(0).contains(&end) {
            return Some((0, end));
        }
        let firsts: Vec<usize> = (0..end).filter(|first| !fitting_lasts(*first).is_empty()).collect();
        let first = *firsts.get(dice.random_range(0..firsts.len().max(1)))?;
        Some((first, dice.random_range(fitting_lasts(first))))
    }

    /// The distance of each stop from the first along the path, and the lengths that the request allows: in metres, or in
    /// hops without poses.
    fn measure_stops(&self, request: &PathRequest) -> (Vec<f64>, RangeInclusive<f64>) {
        if self.motion() == PathMotion::Unknown {
            let hops = (0..self.stops.len()).map(|at| at as f64).collect();
            return (hops, *request.hops.start() as f64..=*request.hops.end() as f64);
        }
        let mut walked_m = vec![0.0];
        for pair in self.places.windows(2) {
            walked_m.push(walked_m[walked_m.len() - 1] + pair[0].distance(pair[1]));
        }
        (walked_m, request.length_m.clone())
    }
}

impl Platform for RecordingPlatform {
    fn name(&self) -> &'static str {
        "recording"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(self.source.scenes())
    }

    /// The frames in order, each joined to the next unless the way between them is unknown; empty without poses.
    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(self.open_scene(scene)?.graph.clone())
    }

    /// Estimates from pictures are made anew each time: they need all pictures of the recording.
    fn film_motion(&self, scene: &SceneId, source: MotionSource) -> Result<Option<CameraMotion>, PlatformError> {
        self.open_scene(scene)?.film_motion(source)
    }

    /// The whole recording if its length fits, else a stretch of it. Without poses the number of hops counts instead of
    /// the length.
    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        let opened = self.open_scene(scene)?;
        let mut dice = seeded_rng(seed, &["stretch", scene.as_str()]);
        let (first, last) = opened.choose_stretch(request, &mut dice).ok_or_else(|| {
            let (hops, length_m) = (&request.hops, &request.length_m);
            let (request, hint) = match opened.motion() {
                _ if opened.graph.viewpoints().count() < 2 => (
                    format!("2 frames, because it has only {}", opened.graph.viewpoints().count()),
                    "if all poses lie in one place, the camera stood still or the file of poses is another's; else record while moving, or \
                     set a smaller interval_m or interval_s in recording.toml",
                ),
                PathMotion::Known => (
                    format!("{} to {} metres", length_m.start(), length_m.end()),
                    "widen --metres, or set a smaller interval_m in recording.toml (docs/RECORDINGS.md)",
                ),
                PathMotion::Unknown => (
                    format!("{} to {} hops", hops.start(), hops.end()),
                    "widen --hops, or set a smaller interval_s in recording.toml (docs/RECORDINGS.md)",
                ),
            };
            PlatformError::NoSuchPath { scene: scene.clone(), request, hint }
        })?;
        let frames = opened.frames_between(first, last);
        Ok(Path { id: format!("{scene}_{seed}"), scene: scene.clone(), frames, target: None, motion: opened.motion() })
    }

    fn whole_path(&self, scene: &SceneId) -> Result<Option<Path>, PlatformError> {
        let opened = self.open_scene(scene)?;
        let last = opened.stops.len().saturating_sub(1);
        if last == 0 || !opened.breaks.is_empty() {
            let request = "all of it, because it has gaps or fewer than 2 frames".to_owned();
            let hint = "record more, or set a smaller interval_m or interval_s in recording.toml (docs/RECORDINGS.md)";
            return Err(PlatformError::NoSuchPath { scene: scene.clone(), request, hint });
        }
        let frames = opened.frames_between(0, last);
        let id = scene.as_str().to_owned();
        Ok(Some(Path { id, scene: scene.clone(), frames, target: None, motion: opened.motion() }))
    }

    /// The picture of this frame if the camera looked in this direction; else a view without a picture.
    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let opened = self.open_scene(scene)?;
        let id = from.viewpoint.as_ref().ok_or_else(|| PlatformError::NotAViewpoint { scene: scene.clone() })?;
        let unknown = || PlatformError::UnknownViewpoint { scene: scene.clone(), viewpoint: id.clone() };
        let at = opened.ids.iter().position(|other| other == id).ok_or_else(unknown)?;
        // Without a pose, the picture counts as the view ahead.
        let looking = opened.heading_at(at).unwrap_or(from.pose.heading);
        if !gaze.holds_heading(looking) {
            return Ok(View::new(
                Pose::looking_level(from.pose.position, gaze.heading),
                gaze.horizontal_fov_rad,
                None,
                None,
            ));
        }
        let (fov_rad, _) = view_width(&opened.recording);
        let picture = self.frame_picture(scene, &opened, at)?;
        Ok(View::new(Pose::looking_level(from.pose.position, looking), fov_rad, Some(picture), None))
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.open_scene(scene)?;
        Ok(View::new(Pose::looking_level(from.pose.position, gaze.heading), gaze.horizontal_fov_rad, None, None))
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }

    fn files(&self) -> &dyn SceneFiles {
        self
    }
}

impl SceneCatalogue for RecordingPlatform {
    /// It is not known how much the labels of a recording leave out.
    fn lists_everything(&self) -> bool {
        false
    }

    fn object_name(&self, _: &SceneId, _: &Frame, _: &ObjectId) -> Result<Option<String>, PlatformError> {
        Ok(None)
    }

    fn visible_from(&self, _: &SceneId, _: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        Ok(None)
    }
}

/// Checks whether a recording can be read: its list of pictures, and the first picture.
fn check_recording(source: &dyn RecordingSource, scene: &SceneId) -> Result<(), PlatformError> {
    let recording = source.open(scene)?;
    let wanted = candidate_pictures(&recording);
    recording.reel.glance_at(&wanted)?;
    recording.reel.hand_out_pictures(&wanted[..wanted.len().min(1)], &mut |_, _| Ok(()))
}

impl SceneFiles for RecordingPlatform {
    /// Opens each recording and reads its first picture, to report all errors before a run meets them item by item.
    fn check_scenes(&self, scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        let all = self.source.scenes();
        let is_wanted = |scene: &&SceneId| scenes.contains(scene);
        let check = |scene: &SceneId| check_recording(&*self.source, scene).err();
        let mut wrong: Vec<PlatformError> = all.iter().filter(is_wanted).filter_map(check).collect();
        if !wrong.is_empty() {
            // Who mends one would meet the next with the next run, so all of the folder are told together.
            wrong.extend(all.iter().filter(|scene| !is_wanted(scene)).filter_map(check));
        }
        if all.len() < 2 {
            return wrong.pop().map_or(Ok(()), Err);
        }
        if wrong.is_empty() {
            return Ok(());
        }
        let listed: String = wrong.iter().take(MAX_LISTED_ERRORS).map(|error| format!("\n  {error}")).collect();
        let more = wrong.len().saturating_sub(MAX_LISTED_ERRORS);
        let more = if more > 0 { format!("\n  and {more} more") } else { String::new() };
        let reason = format!(
            "{} of {} recordings cannot be read; name the others with --scan, or move away those that are files or \
             folders of their own:{listed}{more}",
            wrong.len(),
            all.len()
        );
        Err(files::file_error(&self.path, reason, "docs/RECORDINGS.md lists what can be read"))
    }

    fn source_files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.source.files(scene)
    }
}

/// A graph of places in order, each joined to the next unless there is a break.
fn chain_graph(
    ids: &[ViewpointId],
    places: &[DVec3],
    breaks: &BTreeSet<usize>,
) -> Result<ViewpointGraph, wayword_core::graph::GraphError> {
    let mut graph = ViewpointGraph::default();
    for (id, place) in ids.iter().zip(places) {
        graph.add_viewpoint(id.clone(), *place, None)?;
    }
    if !places.is_empty() {
        for (before, pair) in ids.windows(2).enumerate() {
            if !breaks.contains(&(before + 1)) {
                graph.join_viewpoints(&pair[0], &pair[1])?;
            }
        }
    }
    Ok(graph)
}

/// A picture at most [`MAX_LONGER_SIDE_PX`] wide and high.
fn scale_down(image: &Image) -> Image {
    let (width, height) = (image.width_px(), image.height_px());
    let longest = width.max(height);
    if longest <= MAX_LONGER_SIDE_PX {
        return image.clone();
    }
    let scaled = |side: u32| {
        let scaled = u64::from(side) * u64::from(MAX_LONGER_SIDE_PX) / u64::from(longest);
        u32::try_from(scaled.max(1)).unwrap_or(MAX_LONGER_SIDE_PX)
    };
    let (wide, high) = (scaled(width), scaled(height));
    let pixels = image::ImageBuffer::<image::Rgb<u8>, &[u8]>::from_raw(width, height, image.rgb_bytes());
    let small = pixels.map(|pixels| resize(&pixels, wide, high, FilterType::Triangle));
    small.and_then(|small| Image::new(wide, high, small.into_raw()).ok()).unwrap_or_else(|| image.clone())
}

/// The horizontal field of view of a recording's pictures, radians, and where it is from.
fn view_width(recording: &Recording) -> (f64, &'static str) {
    let described = recording.described.horizontal_fov_deg.map(f64::to_radians);
    match (described, recording.horizontal_fov_rad) {
        (Some(fov_rad), _) => (fov_rad, "as recording.toml sets it"),
        (None, Some(fov_rad)) => (fov_rad, "as the recording says"),
        (None, None) => (USUAL_FOV_RAD, "assumed (horizontal_fov_deg in recording.toml sets it)"),
    }
}

/// A line with the number of frames that were chosen, and of those that were left out, with the reasons.
fn describe_choice(scene: &SceneId, recording: &Recording, choice: &FrameChoice) -> String {
    let count = |count: usize, what: &str| if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") };
    let left_out = |places: usize, why: &str| match places {
        0 => String::new(),
        places => format!("; {} left out because {why}", count(places, "possible frame")),
    };
    let poses = if recording.track.is_some() { ", with poses" } else { "; no poses, so no turns and distances" };
    let (fov_rad, whence) = view_width(recording);
    let view = format!("; a view of {:.0} degrees, {whence}", fov_rad.to_degrees());
    let without_pose = match choice.without_pose {
        0 => String::new(),
        pictures => format!("; {} without a pose", count(pictures, "picture")),
    };
    let tally = recording.track.as_ref().map(CameraTrack::tally).unwrap_or_default();
    let poses_that = |poses: usize, what: &str| match poses {
        0 => String::new(),
        poses => format!("; {} {what}", count(poses, "pose")),
    };
    let gaps = match choice.breaks.len() {
        0 => String::new(),
        gaps => format!("; {} that no path crosses", count(gaps, "gap")),
    };
    format!(
        "recording {scene}: {}, {}{poses}{}{}{}{without_pose}{}{}{}{gaps}{view}",
        count(recording.reel.times_s().len(), "picture"),
        count(choice.stops.len(), "frame"),
        poses_that(tally.invalid, "left out because the place or the time is not a valid number"),
        poses_that(tally.repeated, "left out because another has the same time"),
        poses_that(tally.late, "moved because of an earlier time than the one before"),
        left_out(choice.blurred, "the pictures are blurred"),
        left_out(choice.alike, "the picture shows the same as the one before"),
        left_out(choice.turned_away, "the camera looked away from the path"),
    )
}

#[cfg(test)]
mod tests;
