//! Changes of paths: reversal, other distances between frames, dropped frames, and another start heading. All of them keep frames on
//! the polyline of the path.

use crate::draws::draw_uniform;
use wayword_core::{Frame, Heading, Path, Pose, path::PathStop};

/// A new frame at most this far along the path from an existing one, metres, is that frame.
const SAME_POSITION_M: f64 = 1e-6;

/// Smallest distance between two frames, metres. A request for less is raised to it.
const MIN_SPACING_M: f64 = 0.05;

/// A changed path.
#[derive(Debug, Clone, PartialEq)]
pub struct ChangedPath {
    /// The path, under the same id.
    pub path: Path,
    /// For each of its frames, the corresponding frame of the path before the change.
    pub base_frame_of: Vec<usize>,
}

/// Reverses the path. The new path starts along its first hop and has no target, because the target was at the other end. If the
/// motion is unknown, only the order of the frames changes.
#[must_use]
pub fn reverse_path(path: &Path) -> ChangedPath {
    let base_frame_of: Vec<usize> = (0..path.frames.len()).rev().collect();
    let frames = if path.motion.is_known() {
        Path::frames_along(base_frame_of.iter().map(|base| stop_from_frame(&path.frames[*base])).collect(), None)
    } else {
        base_frame_of.iter().map(|base| path.frames[*base].clone()).collect()
    };
    ChangedPath { path: Path { frames, target: None, ..path.clone() }, base_frame_of }
}

/// Places frames at equal distances of at most `spacing_m` metres along the path, including both ends. A new frame that coincides
/// with one of the path keeps its viewpoint; the storey is that of the nearest frame. A path of unknown motion, or with a single
/// frame, stays as it is.
#[must_use]
pub fn space_frames(path: &Path, spacing_m: f64) -> ChangedPath {
    let at_m = frame_positions_m(path);
    let length_m = at_m.last().copied().unwrap_or(0.0);
    if !path.motion.is_known() || length_m <= SAME_POSITION_M || !spacing_m.is_finite() {
        return unchanged_path(path);
    }
    let steps = libm::ceil(length_m / spacing_m.max(MIN_SPACING_M) - 1e-9).max(1.0) as usize;
    let places: Vec<f64> = (0..=steps).map(|step| length_m * step as f64 / steps as f64).collect();
    let base_frame_of: Vec<usize> = places.iter().map(|place_m| nearest_frame(&at_m, *place_m)).collect();
    let stops = places.iter().zip(&base_frame_of).map(|(place_m, base)| stop_at(path, &at_m, *place_m, *base));
    rejoin_stops(path, stops.collect(), base_frame_of)
}

/// Keeps only frames that are at least `spacing_m` metres along the path from the last one that was kept, and both ends. For platforms
/// that have no views between frames.
#[must_use]
pub fn thin_frames(path: &Path, spacing_m: f64) -> ChangedPath {
    let at_m = frame_positions_m(path);
    let last = path.frames.len().saturating_sub(1);
    let mut kept: Vec<usize> = Vec::new();
    for frame in 0..path.frames.len() {
        let is_far = kept.last().is_none_or(|before| at_m[frame] - at_m[*before] >= spacing_m - SAME_POSITION_M);
        if is_far || frame == last {
            kept.push(frame);
        }
    }
    keep_frames(path, kept)
}

/// Drops each frame between the first and the last with a probability of `percent` per cent. The draw of a frame depends on the seed
/// and the path's id alone, so a frame that is dropped at 10 % is also dropped at 30 %.
#[must_use]
pub fn drop_frames(path: &Path, percent: f64, seed: u64) -> ChangedPath {
    let last = path.frames.len().saturating_sub(1);
    let is_kept = |frame: &usize| {
        let draw = || draw_uniform(seed, &["dropped frames", &path.id, &frame.to_string()]);
        *frame == 0 || *frame == last || draw() >= percent / 100.0
    };
    keep_frames(path, (0..path.frames.len()).filter(is_kept).collect())
}

/// Turns the start heading by `turn_deg` degrees, positive to the right. A path of unknown motion stays as it is.
#[must_use]
pub fn turn_start_heading(path: &Path, turn_deg: f64) -> ChangedPath {
    let mut changed = unchanged_path(path);
    if path.motion.is_known()
        && let Some(first) = changed.path.frames.first_mut()
    {
        first.pose.heading = first.pose.heading.turned_by(turn_deg.to_radians());
    }
    changed
}

/// Removes the opening turn: the first frame then looks along the first hop.
#[must_use]
pub fn face_first_hop(path: &Path) -> ChangedPath {
    let mut changed = unchanged_path(path);
    let hop = path.frames.windows(2).find_map(|pair| Heading::towards(pair[0].pose.position, pair[1].pose.position));
    if path.motion.is_known()
        && let (Some(first), Some(hop)) = (changed.path.frames.first_mut(), hop)
    {
        first.pose.heading = hop;
    }
    changed
}

fn unchanged_path(path: &Path) -> ChangedPath {
    ChangedPath { path: path.clone(), base_frame_of: (0..path.frames.len()).collect() }
}

/// Keeps only the given frames of a path.
fn keep_frames(path: &Path, kept: Vec<usize>) -> ChangedPath {
    if kept.len() == path.frames.len() {
        return unchanged_path(path);
    }
    if path.motion.is_known() {
        return rejoin_stops(path, kept.iter().map(|frame| stop_from_frame(&path.frames[*frame])).collect(), kept);
    }
    let frames = kept.iter().map(|frame| path.frames[*frame].clone()).collect();
    ChangedPath { path: Path { frames, ..path.clone() }, base_frame_of: kept }
}

/// Makes a path along other stops, with the start heading and the end of the original.
fn rejoin_stops(path: &Path, stops: Vec<PathStop>, base_frame_of: Vec<usize>) -> ChangedPath {
    let start = path.frames.first().map(|frame| frame.pose.heading);
    let mut after = Path { frames: Path::frames_along(stops, start), ..path.clone() };
    if let (Some(before), Some(now), Some(target)) = (path.frames.last(), after.frames.last(), &mut after.target)
        && before.pose.heading.turn_to(now.pose.heading).abs() > SAME_POSITION_M
    {
        // The tolerance, in metres, serves for the turn too, in radians. A walker who arrives from another direction sees the target on
        // another side.
        target.told_by.retain(|distinction| !distinction.needs_pose());
    }
    ChangedPath { path: after, base_frame_of }
}

/// A frame without its heading.
fn stop_from_frame(frame: &Frame) -> PathStop {
    let Frame { pose: Pose { position, .. }, viewpoint, level } = frame.clone();
    PathStop { position, viewpoint, level }
}

/// Distance of each frame from the start along the path, metres.
fn frame_positions_m(path: &Path) -> Vec<f64> {
    let mut at_m = 0.0;
    let mut before = path.frames.first().map(|frame| frame.pose.position);
    let place = |frame: &Frame| {
        let here = frame.pose.position;
        at_m += before.replace(here).map_or(0.0, |before| before.distance(here));
        at_m
    };
    path.frames.iter().map(place).collect()
}

/// The frame nearest to a position along the path; of two, the earlier one. `at_m` has the position of each frame.
fn nearest_frame(at_m: &[f64], place_m: f64) -> usize {
    let off = |frame: &usize| (at_m[*frame] - place_m).abs();
    (0..at_m.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

/// The stop at a position along the path. `at_m` has the position of each frame, and `base` is the nearest frame.
fn stop_at(path: &Path, at_m: &[f64], place_m: f64, base: usize) -> PathStop {
    let here = stop_from_frame(&path.frames[base]);
    if (at_m[base] - place_m).abs() <= SAME_POSITION_M {
        return here;
    }
    let to = at_m.partition_point(|at_m| *at_m < place_m).clamp(1, at_m.len() - 1);
    let share = (place_m - at_m[to - 1]) / (at_m[to] - at_m[to - 1]);
    let position = path.frames[to - 1].pose.position.lerp(path.frames[to].pose.position, share);
    PathStop { position, viewpoint: None, ..here }
}

#[cfg(test)]
mod tests;
