//! Brings poses onto the clock of the pictures: by the pictures that they name or count, else by their times.

use super::rows::{self, PoseKey, PoseRows};
use crate::track::{CameraTrack, TrackFix};

/// How far the times of poses may stray from those of the pictures that a column `frame` counts, seconds and as a share of the
/// whole time.
const MAX_FRAME_STRAY_S: f64 = 0.5;
const MAX_FRAME_STRAY_SHARE: f64 = 0.02;
/// Least share of a column `frame` that must be numbers of pictures.
const LEAST_COUNTED_SHARE: f64 = 0.9;

/// Fewer pictures show no mistake in the unit of the times.
const LEAST_JUDGED_PICTURES: usize = 4;
/// How much longer or shorter the poses may last than the pictures, as a factor, apart from the unit of their times: the times of
/// pictures are often those of one picture per second.
const MAX_UNIT_STRAY: f64 = 4.0;
/// Units that may stand in place of the one that was read: their name, the end of a column's name, and how much longer times in
/// them seem to last.
const TIME_UNITS: [(&str, &str, f64); 4] =
    [("milliseconds", "ms", 1e3), ("microseconds", "us", 1e6), ("nanoseconds", "ns", 1e9), ("seconds", "s", 1e-3)];

/// The pictures to which poses belong.
#[derive(Clone, Copy)]
pub(super) struct PictureClock<'a> {
    /// The times of the pictures, ascending, seconds.
    pub(super) times_s: &'a [f64],
    /// The name of a picture.
    pub(super) name: &'a dyn Fn(usize) -> String,
}

/// How the numbers in a column `frame` relate to the pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FrameCount {
    /// They count something else, or there are none.
    Other,
    /// They may count the pictures: the times neither prove nor disprove it.
    Likely,
    /// They count the pictures, and the times agree.
    Certain,
}

impl PictureClock<'_> {
    /// The time of each row on the clock of the pictures, seconds; `None` for pictures that do not exist.
    pub(super) fn times_of_rows(self, rows: &PoseRows, offset_s: f64, by_frames: bool) -> Vec<Option<f64>> {
        if let Some(frames) = rows.frames.as_ref().filter(|_| by_frames) {
            let first = self.first_number(frames);
            return frames.iter().map(|number| self.times_s.get(number.checked_sub(first)?).copied()).collect();
        }
        let mut named: Vec<(String, f64)> = Vec::new();
        if rows.rows.iter().any(|row| matches!(row.key, PoseKey::Picture(_))) {
            let stem = |at: usize| rows::picture_stem(&(self.name)(at));
            named = self.times_s.iter().enumerate().map(|(at, time_s)| (stem(at), *time_s)).collect();
            named.sort_by(|a, b| a.0.cmp(&b.0));
        }
        let time_of = |key: &PoseKey| match key {
            PoseKey::Time(time_s) => Some(*time_s + offset_s),
            PoseKey::Number(number) => self.times_s.get(*number).copied(),
            PoseKey::Picture(picture) => {
                let stem = rows::picture_stem(picture);
                let found = named.binary_search_by(|(other, _)| other.as_str().cmp(&stem)).ok();
                found.and_then(|at| named.get(at)).map(|(_, time_s)| *time_s)
            }
        };
        rows.rows.iter().map(|row| time_of(&row.key)).collect()
    }

    /// The number of the first picture in a column `frame`: 1 where its last number is that of the pictures and it has no 0.
    fn first_number(self, frames: &[usize]) -> usize {
        let begins_at_one = frames.first() == Some(&1) && frames.last() == Some(&self.times_s.len());
        usize::from(begins_at_one)
    }

    /// Whether the column `frame` counts the pictures.
    pub(super) fn frame_count(self, rows: &PoseRows) -> FrameCount {
        let Some(frames) = rows.frames.as_deref().filter(|frames| !frames.is_empty()) else { return FrameCount::Other };
        let first = self.first_number(frames);
        let picture_s = |number: usize| self.times_s.get(number.checked_sub(first)?).copied();
        let counted = frames.iter().filter(|number| picture_s(**number).is_some()).count() as f64;
        let ascends = frames.array_windows().all(|[before, after]| before < after);
        if !ascends || counted < LEAST_COUNTED_SHARE * frames.len() as f64 {
            return FrameCount::Other;
        }
        let pairs = frames.iter().zip(&rows.rows).filter_map(|(number, row)| match row.key {
            PoseKey::Time(time_s) => Some((time_s, picture_s(*number)?)),
            PoseKey::Picture(_) | PoseKey::Number(_) => None,
        });
        let pairs: Vec<(f64, f64)> = pairs.collect();
        let (Some((pose_s, picture_s)), Some((_, last_s))) = (pairs.first(), pairs.last()) else {
            return FrameCount::Other;
        };
        let slack_s = MAX_FRAME_STRAY_S.max(MAX_FRAME_STRAY_SHARE * (last_s - picture_s));
        let strays = |(pose, picture): &(f64, f64)| ((pose - pose_s) - (picture - picture_s)).abs() > slack_s;
        if pairs.iter().any(strays) { FrameCount::Likely } else { FrameCount::Certain }
    }
}

/// The doubt that the times of poses are in seconds, as the names of their columns say or because they have no unit; `None` if they
/// may be. Most pictures have no pose then, and would have one in another unit.
pub(super) fn find_time_unit_doubt(rows: &PoseRows, times_s: &[f64]) -> Option<String> {
    let fixes = rows.rows.iter().filter_map(|row| match row.key {
        PoseKey::Time(time_s) => Some(TrackFix { time_s, position: row.position, heading: None }),
        PoseKey::Picture(_) | PoseKey::Number(_) => None,
    });
    let track = CameraTrack::new(fixes.collect())?;
    let unposed = times_s.iter().filter(|time_s| track.fix_at(**time_s).is_none()).count();
    let (from_s, to_s) = track.span_s();
    let (first_s, last_s) = (*times_s.first()?, *times_s.last()?);
    let ratio = (to_s - from_s) / (last_s - first_s);
    if times_s.len() < LEAST_JUDGED_PICTURES || !ratio.is_finite() || unposed == 0 {
        return None;
    }
    let (name, unit, _) = TIME_UNITS.into_iter().find(|(_, _, per_s)| {
        let off = ratio / per_s;
        (1.0 / MAX_UNIT_STRAY..=MAX_UNIT_STRAY).contains(&off)
    })?;
    (unposed * 2 > times_s.len()).then(|| {
        let or_write = if unit == "s" { "" } else { ", or write seconds" };
        format!(
            "{unposed} of {} pictures have no pose: the poses go from {from_s} to {to_s} s, and the pictures from {first_s} to \
             {last_s} s; are the times {name}? then name the column time_{unit}{or_write}; if they \
             are right as they are, write pose_time_offset_s = 0 into a recording.toml beside it",
            times_s.len()
        )
    })
}

/// Why no picture has a pose, and which setting would mend it if both began together.
pub(super) fn describe_clocks((from_s, to_s): (f64, f64), times_s: &[f64]) -> String {
    let (first_s, last_s) = (times_s.first().unwrap_or(&0.0), times_s.last().unwrap_or(&0.0));
    // Milliseconds are enough, and a sum of floating-point numbers may have more digits.
    let offset_s = ((first_s - from_s) * 1000.0).round() / 1000.0;
    let change = if offset_s < 0.0 {
        format!("subtract {} s from the times of the poses", -offset_s)
    } else {
        format!("add {offset_s} s to the times of the poses")
    };
    format!(
        "has poses from {from_s} to {to_s} s, but the pictures were taken from {first_s} to {last_s} s: no picture has a \
         pose. If the first pose and the first picture belong together, {change}: write pose_time_offset_s = {offset_s} \
         into a recording.toml beside it"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_of_frames_may_count_from_one() {
        let clock = PictureClock { times_s: &[0.0, 1.0, 2.0], name: &|at| format!("{at}.png") };
        assert_eq!(clock.first_number(&[1, 2, 3]), 1);
        for from_zero in [&[0, 1, 2][..], &[1, 2], &[]] {
            assert_eq!(clock.first_number(from_zero), 0, "{from_zero:?}");
        }
    }
}
