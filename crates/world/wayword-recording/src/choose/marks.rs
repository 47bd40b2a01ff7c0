//! Sets marks along a recording, at equal distances or times: each of them should become a frame.

use super::{INTERVAL_M, INTERVAL_S, MAX_LEFT_OUT_MARKS};
use crate::{platform::MAX_WHOLE_FRAMES, reel::Recording};
use wayword_core::DVec3;

/// Most candidates for one mark; if there are more, some in between are left out.
const MAX_CANDIDATES: usize = 5;
/// Greatest distance of a candidate from its mark, as a share of the interval.
const NEAR_INTERVAL_SHARE: f64 = 0.2;
/// An interval that is shorter than any time between pictures, seconds: with it every picture gets a mark.
const EVERY_PICTURE_INTERVAL_S: f64 = 1e-6;
/// Least mean time between the pictures of a slide show, seconds; the pictures of a video follow each other faster.
const MIN_SLIDE_SHOW_STEP_S: f64 = 0.5;
/// A rest at the end gets its own mark if it has at least this share of the interval; else the last mark moves to the
/// end.
const MIN_END_MARK_SHARE: f64 = 0.5;

/// A place or time at which there should be a frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrameMark {
    /// Number of the picture at the mark.
    pub(super) at: usize,
    /// Pictures that may be its frame, ascending; `at` is one of them.
    pub(super) candidates: Vec<usize>,
    /// Whether the way from the mark before is not known.
    pub(super) after_gap: bool,
}

/// The marks of a recording, and the number of pictures without a pose where others have one.
pub(super) fn marks_for_recording(recording: &Recording) -> (Vec<FrameMark>, usize) {
    let times_s = recording.reel.times_s();
    let Some(track) = &recording.track else {
        let usual_s = if is_slide_show(times_s) { EVERY_PICTURE_INTERVAL_S } else { INTERVAL_S };
        let interval_s = recording.described.interval_s.unwrap_or(usual_s);
        let all: Vec<usize> = (0..times_s.len()).collect();
        let distance = |a: usize, b: usize| (times_s[a] - times_s[b]).abs();
        return (spread_marks(&all, interval_s, &distance), 0);
    };
    let places: Vec<Option<DVec3>> =
        times_s.iter().map(|time_s| track.fix_at(*time_s).map(|fix| fix.position)).collect();
    let with_pose: Vec<usize> = (0..times_s.len()).filter(|at| places[*at].is_some()).collect();
    let place_of = |at: usize| places[at].unwrap_or_default();
    let interval_m = recording.described.interval_m.unwrap_or(INTERVAL_M);
    let distance = |a: usize, b: usize| place_of(a).distance(place_of(b));
    let mut marks = spread_marks(&with_pose, interval_m, &distance);
    // The tracker lost its place here and found it again far away.
    let leap_m = (MAX_LEFT_OUT_MARKS + 1) as f64 * interval_m;
    let leaps = with_pose.windows(2).filter(|pair| pair[1] - pair[0] > 1 && distance(pair[0], pair[1]) > leap_m);
    let found_again: Vec<usize> = leaps.map(|pair| pair[1]).collect();
    let mut passed_leaps = 0;
    for mark in &mut marks {
        let leaps_so_far = found_again.partition_point(|at| *at <= mark.at);
        mark.after_gap = leaps_so_far > passed_leaps;
        passed_leaps = leaps_so_far;
    }
    (marks, times_s.len() - with_pose.len())
}

/// Whether these are a few single pictures, each of which its photographer meant to be a frame, and no clip of a video.
fn is_slide_show(times_s: &[f64]) -> bool {
    let span_s = times_s.last().zip(times_s.first()).map_or(0.0, |(last, first)| last - first);
    times_s.len() <= MAX_WHOLE_FRAMES && span_s >= MIN_SLIDE_SHOW_STEP_S * times_s.len().saturating_sub(1) as f64
}

/// Marks about one interval apart. `distance` gives the metres or seconds between two pictures. The distance from the last mark
/// counts, not the length of the track, because a tracker's positions jitter while a robot rests.
fn spread_marks(pictures: &[usize], interval: f64, distance: &dyn Fn(usize, usize) -> f64) -> Vec<FrameMark> {
    let (Some(first), Some(last)) = (pictures.first(), pictures.last()) else { return Vec::new() };
    // Indices into `pictures`, not numbers of pictures.
    let mut marks = vec![0];
    let mut from = *first;
    for (at, picture) in pictures.iter().enumerate() {
        let excess = distance(from, *picture) - interval;
        if excess < 0.0 {
            continue;
        }
        // If pictures are far apart, the one before may be nearer to the mark's proper place.
        let before = at.saturating_sub(1);
        if marks.last() != Some(&before) && interval - distance(from, pictures[before]) < excess {
            marks.push(before);
            from = pictures[before];
        }
        if distance(from, *picture) >= interval {
            marks.push(at);
            from = *picture;
        }
    }
    let end = pictures.len() - 1;
    if marks.last() != Some(&end) {
        let moves_to_end = distance(from, *last) < MIN_END_MARK_SHARE * interval && marks.len() > 1;
        if moves_to_end {
            marks.pop();
        }
        if distance(from, *last) > 0.0 || moves_to_end {
            marks.push(end);
        }
    }
    let candidates = |mark: usize| {
        let near = |at: &usize| distance(pictures[*at], pictures[mark]) <= NEAR_INTERVAL_SHARE * interval;
        let before = (0..mark).rev().take_while(near).count();
        let after = (mark + 1..pictures.len()).take_while(near).count();
        thin_out(mark - before..=mark + after, mark).map(|at| pictures[at]).collect()
    };
    let mark = |at: &usize| FrameMark { at: pictures[*at], candidates: candidates(*at), after_gap: false };
    marks.iter().map(mark).collect()
}

/// At most [`MAX_CANDIDATES`] of a range, evenly spread; `kept` is one of them.
fn thin_out(range: std::ops::RangeInclusive<usize>, kept: usize) -> impl Iterator<Item = usize> {
    let length = range.end() - range.start() + 1;
    let step = length.div_ceil(MAX_CANDIDATES).max(1);
    let phase = kept % step;
    range.filter(move |at| at % step == phase)
}
