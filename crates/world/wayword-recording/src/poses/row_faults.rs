//! Finds poses of a file that contradict each other: a clock that begins again, two places at one time, and leaps.

use super::rows::{PoseFacing, PoseKey, PoseRow, PoseRows};
use crate::track::{MAX_GAP_S, TrackFix};

/// A time that is earlier than the one before by more than this begins a new stretch, seconds: messages may arrive late.
const MAX_LATE_S: f64 = 1.0;
/// A file whose times go back at a larger share of its rows is in another order, such as that of names.
const MAX_RESTARTS_SHARE: f64 = 0.1;
/// Poses of one time may differ by this much, metres: some programs round times.
const MAX_SAME_TIME_M: f64 = 0.5;
/// Nobody moves a camera faster than this, metres per second, and a tracker does not correct itself by more than the length.
const MAX_SPEED_M_PER_S: f64 = 40.0;
const MAX_CORRECTION_M: f64 = 20.0;
/// Pictures without times are nearer to each other than this, metres.
const MAX_PICTURE_LEAP_M: f64 = 100.0;
/// A leap is longer than the usual step of its recording by this factor.
const LEAP_FACTOR: f64 = 10.0;

pub(super) const RESTART_HINT: &str = "keep the lines of one part; if only their order is wrong, sort them by time";
pub(super) const ROTATION_HINT: &str =
    "write the matrix that places the camera in the world, row by row, without scale or shear";
pub(super) const LEAP_HINT: &str = "correct or delete the wrong pose; if the tracker lost its place there, also delete the poses of \
                                    two seconds around it, so that no path crosses the gap";
/// How far the lengths of the columns of a rotation may be from 1, and the cosines between them from 0: files have few digits.
const ROTATION_SLACK: f64 = 0.05;

/// The first row whose matrix is no rotation, in words. A mirrored matrix passes: the directions in it are those of the camera.
pub(super) fn find_no_rotation(rows: &PoseRows) -> Option<String> {
    rows.rows.iter().find_map(|row| {
        let PoseFacing::Columns([x, y, z]) = row.facing else { return None };
        let lengths = [x.length(), y.length(), z.length()];
        // A scanner that lost its place writes -inf everywhere.
        if !lengths.iter().all(|length| length.is_finite()) {
            return None;
        }
        let cosines = [x.dot(y), y.dot(z), z.dot(x)];
        let off = lengths.map(|length| length - 1.0).into_iter().chain(cosines).map(f64::abs).fold(0.0, f64::max);
        let [a, b, c] = lengths;
        (off > ROTATION_SLACK).then(|| {
            format!(
                "{}: its matrix is no rotation: the lengths of the columns are {a:.3}, {b:.3} and {c:.3}, and the largest \
                 difference from a rotation is {off:.3}",
                rows.name_row(row)
            )
        })
    })
}

/// The number of rows whose time is earlier than one before, so that they have to be moved.
///
/// # Errors
/// When the times begin again.
pub(super) fn count_late_rows(rows: &PoseRows) -> Result<usize, String> {
    let timed = rows.rows.iter().filter_map(|row| match row.key {
        PoseKey::Time(time_s) => Some((row, time_s)),
        PoseKey::Picture(_) | PoseKey::Number(_) => None,
    });
    let timed: Vec<(&PoseRow, f64)> = timed.collect();
    let (mut late, mut falls, mut restart) = (0, 0_usize, None);
    let mut latest_s = f64::NEG_INFINITY;
    for (at, [(before, before_s), (row, time_s)]) in timed.array_windows().enumerate() {
        latest_s = latest_s.max(*before_s);
        late += usize::from(*time_s < latest_s);
        falls += usize::from(time_s < before_s);
        // A single late pose is followed by one that is in order, and a single early one follows one that is.
        let goes_on = timed.get(at + 2).is_some_and(|(_, next_s)| (*time_s..latest_s).contains(next_s));
        let is_early = at.checked_sub(1).and_then(|at| timed.get(at)).is_some_and(|(_, first_s)| first_s <= time_s);
        if before_s - time_s > MAX_LATE_S && goes_on && !is_early && restart.is_none() {
            restart = Some((before, before_s, row, time_s));
        }
    }
    match restart {
        Some((before, before_s, row, time_s))
            if falls == 1 || falls as f64 <= MAX_RESTARTS_SHARE * timed.len() as f64 =>
        {
            let (before, row) = (rows.name_row(before), rows.name_row(row));
            Err(format!("{row} has the time {time_s} s, but {before} has {before_s} s: the times begin again"))
        }
        _ => Ok(late),
    }
}

/// A contradiction between fixes and the rows that they come from: two places at one time, or a leap between two pictures.
pub(super) fn find_contradiction(rows: &PoseRows, fixes: &[(&PoseRow, TrackFix)], times_s: &[f64]) -> Option<String> {
    let mut fixes: Vec<(&PoseRow, TrackFix)> = fixes.to_vec();
    fixes.sort_by(|(_, a), (_, b)| a.time_s.total_cmp(&b.time_s));
    let step = |(before, after): (&TrackFix, &TrackFix)| {
        (before.position.distance(after.position), after.time_s - before.time_s)
    };
    let is_timed = fixes.iter().all(|(row, _)| matches!(row.key, PoseKey::Time(_)));
    // The speed, or for pictures without times the length.
    let size = |(length_m, lasts_s): (f64, f64)| if is_timed { length_m / lasts_s } else { length_m };
    let steps = fixes.array_windows().map(|[(_, before), (_, after)]| size(step((before, after))));
    let mut sizes: Vec<f64> = steps.filter(|size| size.is_finite() && *size > 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    let usual = sizes.get(sizes.len().saturating_sub(1) / 2).copied().unwrap_or(0.0);
    let most = f64::max(if is_timed { MAX_SPEED_M_PER_S } else { MAX_PICTURE_LEAP_M }, LEAP_FACTOR * usual);
    let is_leap = |(before, after): (&TrackFix, &TrackFix)| {
        let (length_m, lasts_s) = step((before, after));
        // The path breaks where pictures have no pose.
        let next = times_s.partition_point(|time_s| *time_s <= before.time_s);
        let are_neighbours = times_s.get(next).is_none_or(|time_s| *time_s >= after.time_s);
        let is_crossed = if is_timed { lasts_s <= MAX_GAP_S } else { are_neighbours };
        is_crossed && length_m > MAX_CORRECTION_M && size((length_m, lasts_s)) > most
    };
    for (at, [(row, before), (next_row, after)]) in fixes.array_windows().enumerate() {
        let (length_m, lasts_s) = step((before, after));
        let names = || (rows.name_row(row), rows.name_row(next_row));
        if lasts_s == 0.0 && length_m > MAX_SAME_TIME_M {
            let ((name, next_name), time_s) = (names(), before.time_s);
            return Some(format!(
                "{name} and {next_name} place the camera in two places at one time ({time_s} s), {length_m:.1} m apart"
            ));
        }
        if is_leap((before, after)) {
            let (name, next_name) = names();
            let returns = fixes.get(at + 2).is_some_and(|(_, last)| is_leap((after, last)));
            let back = if returns { ", and back again" } else { "" };
            // The times of pictures without times are made up.
            let time = if is_timed { format!(" in {} s", (lasts_s * 1e3).round() / 1e3) } else { String::new() };
            return Some(format!("from {name} to {next_name} the camera leaps {length_m:.0} m{time}{back}"));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use crate::{describe::RecordingDescription, poses::read_track, track::CameraTrack};

    /// Reads `poses.tum` with these times and places on the x axis, for a picture every half second.
    fn read(poses: &[(f64, f64)]) -> Result<CameraTrack, String> {
        let line = |(time_s, x): &(f64, f64)| format!("{time_s} {x} 0 1.5 -0.5 0.5 -0.5 0.5\n");
        read_text("poses.tum", &poses.iter().map(line).collect::<String>())
    }

    fn read_text(name: &str, text: &str) -> Result<CameraTrack, String> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        let times_s: Vec<f64> = (0..40).map(|at| f64::from(at) * 0.5).collect();
        read_track(&file, &RecordingDescription::default(), &times_s, &|at| format!("{at}.png"))
            .map_err(|error| error.to_string())
    }

    fn walk(steps: u32) -> Vec<(f64, f64)> {
        (0..steps).map(|at| (f64::from(at) * 0.5, f64::from(at) * 0.3)).collect()
    }

    #[test]
    fn read_track_refuses_a_clock_that_begins_again() {
        for (poses, told) in [
            ([walk(20), walk(10)].concat(), "line 21 has the time 0 s, but line 20 has 9.5 s: the times begin again"),
            // The second part does not reach the times of the first.
            ([walk(20).split_off(10), walk(5)].concat(), "line 11 has the time 0 s, but line 10 has 9.5 s"),
            ([walk(15), walk(15), walk(15)].concat(), "line 16 has the time 0 s"),
        ] {
            let error = read(&poses).unwrap_err();
            assert!(error.contains(told) && error.contains("sort them by time"), "{error}");
        }
    }

    #[test]
    fn read_track_counts_poses_in_another_order() {
        let mut poses = walk(20);
        poses.swap(8, 12);
        assert_eq!(read(&poses).unwrap().tally().late, 4);
        let backwards: Vec<_> = walk(20).into_iter().rev().collect();
        assert_eq!(read(&backwards).unwrap().tally().late, 19);
        assert_eq!(read(&walk(20)).unwrap().tally().late, 0);
    }

    #[test]
    fn read_track_counts_poses_without_a_valid_place_or_time() {
        let mut poses = walk(20);
        (poses[3].1, poses[5].1, poses[7].0, poses[9].0) = (1e308, f64::NAN, f64::NAN, f64::INFINITY);
        assert_eq!(read(&poses).unwrap().tally().invalid, 4);
    }

    #[test]
    fn read_track_refuses_two_places_at_one_time() {
        let mut poses = walk(20);
        poses.push((3.0, 79.0));
        let error = read(&poses).unwrap_err();
        assert!(
            error.contains("line 7 and line 21 place the camera in two places at one time (3 s), 77.2 m"),
            "{error}"
        );
        // The same pose twice, and a time that was rounded.
        poses[20] = (3.0, poses[6].1);
        assert_eq!(read(&poses).unwrap().tally().repeated, 0);
        poses[20] = (3.0, poses[6].1 + 0.2);
        assert_eq!(read(&poses).unwrap().tally().repeated, 1);
        let error = read_text("poses.csv", "image,x,y\n0.png,0,0\n1.png,1,0\n0.png,9,0\n").unwrap_err();
        assert!(error.contains("line 2 and line 4"), "{error}");
        let json = r#"[{"image": "0.png", "position": [0,0,0]}, {"image": "0", "position": [0,9,0]}]"#;
        assert!(read_text("poses.json", json).unwrap_err().contains("pose 0 and pose 1"));
    }

    #[test]
    fn read_track_refuses_matrices_that_are_no_rotations() {
        let kitti = |matrix: &str| read_text("poses.txt", &format!("1 0 0 0 0 1 0 0 0 0 1 0\n{matrix}\n"));
        for (matrix, is_rotation) in [
            ("1 0 0 0 0 1 0 0 0 0 1 2", true),
            // Few digits, and a mirror image.
            ("0.71 0 0.71 0 0 1 0 0 -0.71 0 0.71 1", true),
            ("-1 0 0 0 0 1 0 0 0 0 1 2", true),
            ("3 0 0 0 0 3 0 0 0 0 3 2", false),
            ("1 0.4 0 0 0 1 0 0 0 0 1 2", false),
            ("1 1 1 0 1 1 1 0 1 1 1 2", false),
            ("0 0 0 0 0 0 0 0 0 0 0 2", false),
        ] {
            match kitti(matrix) {
                Ok(_) => assert!(is_rotation, "{matrix}"),
                Err(error) => assert!(!is_rotation && error.contains("line 2: its matrix is no rotation"), "{error}"),
            }
        }
        let nerf = r#"{"frames": [{"file_path": "0", "transform_matrix": [[2,0,0,0],[0,2,0,0],[0,0,2,0],[0,0,0,1]]}]}"#;
        assert!(read_text("transforms.json", nerf).unwrap_err().contains("frame 0: its matrix"));
    }

    #[test]
    fn read_track_names_the_pose_that_leaps() {
        let mut poses = walk(20);
        poses[12].1 = 5003.6;
        let error = read(&poses).unwrap_err();
        assert!(error.contains("from line 12 to line 13 the camera leaps 5000 m in 0.5 s, and back again"), "{error}");
        // It stays there.
        let mut poses = walk(20);
        poses.iter_mut().skip(12).for_each(|(_, x)| *x += 100.0);
        let error = read(&poses).unwrap_err();
        assert!(error.contains("from line 12 to line 13 the camera leaps 100 m in 0.5 s;"), "{error}");
        // No path crosses a gap, and a tracker may correct itself.
        poses.iter_mut().skip(12).for_each(|(time_s, _)| *time_s += 2.0);
        assert!(read(&poses).is_ok());
        poses = walk(20);
        poses.iter_mut().skip(12).for_each(|(_, x)| *x += 15.0);
        assert!(read(&poses).is_ok());
        let matrix = |x: f64| format!("1 0 0 {x} 0 1 0 0 0 0 1 0\n");
        let kitti: String = [0.0, 1.0, 2.0, 5000.0, 4.0, 5.0, 6.0, 7.0].map(matrix).concat();
        assert!(read_text("poses.txt", &kitti).unwrap_err().contains("from line 3 to line 4"));
    }
}
