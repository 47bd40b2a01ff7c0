//! Chooses the pictures of a recording that become frames of its path.
//!
//! Frames are at equal distances, or at equal times if no poses are known. Blurred pictures, repeated ones and those that
//! look away from the path are left out. First [`marks`] are set along the track, each with some pictures near it as
//! candidates; then the candidates are read and compared.

#![allow(clippy::indexing_slicing, reason = "all indices are counted here, and none is read from a file")]

mod marks;
mod picture_measure;

use crate::reel::Recording;
use marks::FrameMark;
use picture_measure::PictureMeasure;
use std::collections::BTreeSet;
use wayword_core::{Heading, Image, PlatformError, ViewGaze};

/// Default distance between frames, metres.
pub(crate) const INTERVAL_M: f64 = 1.0;
/// Default time between frames, seconds: at a walking speed of 0.7 m/s a bit more than a metre.
pub(crate) const INTERVAL_S: f64 = 2.0;
/// A picture with less than this share of the recording's usual sharpness is blurred.
const BLURRED_SHARPNESS_SHARE: f64 = 0.3;
/// A picture that differs from the one before by less than this shows the same, levels of 255 on average.
const ALIKE_DIFFERENCE_LEVELS: f64 = 2.0;
/// Most marks in a row that may be left out. If more are, the straight line between the two frames around them may not be
/// the way that the camera took, so the path breaks there.
const MAX_LEFT_OUT_MARKS: usize = 2;

/// The frames of a recording, and what was left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct FrameChoice {
    /// Numbers of pictures, ascending.
    pub(crate) stops: Vec<usize>,
    /// Indices into `stops`: the way to these stops from the one before is not known, although the poses are.
    pub(crate) breaks: BTreeSet<usize>,
    /// Places that were left out because every picture there is blurred.
    pub(crate) blurred: usize,
    /// Places that were left out because their picture shows the same as the one before.
    pub(crate) alike: usize,
    /// Places that were left out because the camera looked away from the direction of travel.
    pub(crate) turned_away: usize,
    /// Pictures without a pose at their time, where others have one.
    pub(crate) without_pose: usize,
}

/// Chooses the frames. `each` gets every picture that was examined, so that the caller need not read it again.
///
/// # Errors
/// When a picture cannot be read.
pub(crate) fn choose_frames(
    recording: &Recording,
    each: &mut dyn FnMut(usize, &Image),
) -> Result<FrameChoice, PlatformError> {
    let (marks, without_pose) = marks::marks_for_recording(recording);
    let wanted = all_candidates(&marks);
    let mut measures = Vec::with_capacity(wanted.len());
    recording.reel.hand_out_pictures(&wanted, &mut |number, image| {
        each(number, &image);
        measures.push((number, PictureMeasure::from_image(&image)));
        Ok(())
    })?;
    Ok(FrameChoice { without_pose, ..choose_among(recording, &marks, &measures) })
}

/// The pictures that are examined in order to choose among them, ascending.
pub(crate) fn candidate_pictures(recording: &Recording) -> Vec<usize> {
    all_candidates(&marks::marks_for_recording(recording).0)
}

fn all_candidates(marks: &[FrameMark]) -> Vec<usize> {
    let mut wanted: Vec<usize> = marks.iter().flat_map(|mark| mark.candidates.iter().copied()).collect();
    wanted.sort_unstable();
    wanted.dedup();
    wanted
}

/// Chooses the frames after every candidate was examined.
fn choose_among(recording: &Recording, marks: &[FrameMark], measures: &[(usize, PictureMeasure)]) -> FrameChoice {
    let measure_of = |number: usize| {
        let index = measures.binary_search_by_key(&number, |(number, _)| *number).ok();
        index.map(|at| &measures[at].1)
    };
    let min_sharpness = BLURRED_SHARPNESS_SHARE * usual_sharpness(measures);
    let mut choice = FrameChoice::default();
    // The mark of the last stop, and its picture's measures.
    let mut last: Option<(usize, &PictureMeasure)> = None;
    for (at, mark) in marks.iter().enumerate() {
        // The first and the last mark stay: without them the path would be another one.
        let is_end = at == 0 || at + 1 == marks.len();
        let is_break = recording.track.is_some() && last.is_some_and(|(from, _)| is_lost(&marks[from + 1..=at]));
        let last_stop = choice.stops.last().copied().filter(|_| !is_break);
        let faces = |number: &&usize| last_stop.is_none_or(|last_stop| faces_the_way(recording, last_stop, **number));
        let mut facing: Vec<usize> = mark.candidates.iter().filter(faces).copied().collect();
        if facing.is_empty() && is_end {
            facing.clone_from(&mark.candidates);
        }
        if facing.is_empty() {
            choice.turned_away += 1;
            continue;
        }
        let is_sharp = |number: &&usize| measure_of(**number).is_some_and(|measure| measure.sharpness >= min_sharpness);
        let nearest = |number: &&usize| number.abs_diff(mark.at);
        let sharpest = || {
            facing
                .iter()
                .max_by(|a, b| sharpness_or_zero(measure_of(**a)).total_cmp(&sharpness_or_zero(measure_of(**b))))
        };
        let sharp_enough = facing.iter().filter(is_sharp).min_by_key(nearest);
        let Some(number) = sharp_enough.or_else(|| if is_end { sharpest() } else { None }) else {
            choice.blurred += 1;
            continue;
        };
        let Some(measure) = measure_of(*number) else { continue };
        if last.is_some_and(|(_, last)| last.mean_difference(measure) < ALIKE_DIFFERENCE_LEVELS) {
            choice.alike += 1;
            if at + 1 < marks.len() || choice.stops.len() < 2 {
                continue;
            }
            choice.stops.pop();
        }
        if is_break {
            choice.breaks.insert(choice.stops.len());
        }
        choice.stops.push(*number);
        last = Some((at, measure));
    }
    choice
}

fn sharpness_or_zero(measure: Option<&PictureMeasure>) -> f64 {
    measure.map_or(0.0, |measure| measure.sharpness)
}

/// The median sharpness.
fn usual_sharpness(measures: &[(usize, PictureMeasure)]) -> f64 {
    let mut all: Vec<f64> = measures.iter().map(|(_, measure)| measure.sharpness).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.0)
}

/// Whether the way to the next stop is unknown. `marks` are all marks after the last stop; the last of `marks` would be the
/// next stop.
fn is_lost(marks: &[FrameMark]) -> bool {
    marks.len() > MAX_LEFT_OUT_MARKS + 1 || marks.iter().any(|mark| mark.after_gap)
}

/// Whether a picture shows the view of an agent that comes from the stop `before` and looks ahead; true if this is
/// unknown.
fn faces_the_way(recording: &Recording, before: usize, number: usize) -> bool {
    let fix = |number: usize| recording.track.as_ref()?.fix_at(recording.reel.times_s()[number]);
    let faces = || {
        let (from, to) = (fix(before)?, fix(number)?);
        let walked = Heading::towards(from.position, to.position)?;
        Some(ViewGaze::quarter_view(walked).holds_heading(to.heading?))
    };
    faces().unwrap_or(true)
}

#[cfg(test)]
mod tests;
