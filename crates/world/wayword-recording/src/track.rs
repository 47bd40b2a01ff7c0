//! The poses of the camera over time. A fix is one recorded pose; between two fixes the pose is interpolated.

use wayword_core::{DVec3, Heading};

/// Longest time between two fixes over which the track is interpolated on a straight line, seconds.
pub(crate) const MAX_GAP_S: f64 = 2.0;
/// A fix also counts for times this far before the first fix, after the last, or into a gap, seconds: cameras and
/// trackers do not start together.
const MAX_BEYOND_S: f64 = 0.1;
/// Positions with a larger coordinate are invalid, metres: UTM counts up to ten million from the equator.
const MAX_COORDINATE_M: f64 = 2e7;

/// The pose of the camera at one time, in Wayword's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TrackFix {
    /// Time on the clock of the pictures, seconds.
    pub(crate) time_s: f64,
    /// Position of the camera, or of the robot that carries it, metres.
    pub(crate) position: DVec3,
    /// Direction in which the camera looks, if it is known.
    pub(crate) heading: Option<Heading>,
}

/// Fixes in the order of their times.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CameraTrack {
    fixes: Vec<TrackFix>,
    tally: PoseTally,
    /// A warning about the fixes for the user, if there is one.
    doubt: Option<String>,
    /// What of the poses is not read or not used, for the user, if there is something.
    unread: Option<String>,
}

/// Poses of a recording that do not count as they stand in it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct PoseTally {
    /// Left out, because their place or their time is not a valid number.
    pub(crate) invalid: usize,
    /// Left out, because another pose has their time.
    pub(crate) repeated: usize,
    /// Moved to their time, although they stand after later ones.
    pub(crate) late: usize,
}

impl CameraTrack {
    /// A track from fixes in any order; `None` where no fix is left. Fixes without a valid position or time are
    /// dropped, and of several fixes at one time the first counts. The tally counts both.
    pub(crate) fn new(mut fixes: Vec<TrackFix>) -> Option<Self> {
        let all = fixes.len();
        fixes.retain(|fix| fix.time_s.is_finite() && is_valid_place(fix.position));
        let mut tally = PoseTally { invalid: all - fixes.len(), ..PoseTally::default() };
        fixes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        fixes.dedup_by(|later, first| {
            let is_repeated = later.time_s == first.time_s;
            // A pose that was only recorded twice loses nothing.
            tally.repeated += usize::from(is_repeated && later != first);
            is_repeated
        });
        (!fixes.is_empty()).then_some(Self { fixes, tally, doubt: None, unread: None })
    }

    /// The same track with more poses that do not count.
    pub(crate) fn with_tally(mut self, more: PoseTally) -> Self {
        self.tally.invalid += more.invalid;
        self.tally.repeated += more.repeated;
        self.tally.late += more.late;
        self
    }

    /// The poses that do not count.
    pub(crate) fn tally(&self) -> PoseTally {
        self.tally
    }

    /// The same track with a warning.
    pub(crate) fn in_doubt(self, doubt: String) -> Self {
        Self { doubt: Some(doubt), ..self }
    }

    /// The same track with what of its poses is not read.
    pub(crate) fn with_unread(self, unread: Option<String>) -> Self {
        Self { unread, ..self }
    }

    /// What of the poses is not read, for the user, if there is something.
    pub(crate) fn unread(&self) -> Option<&str> {
        self.unread.as_deref()
    }

    /// The warning about the track for the user, if there is one.
    pub(crate) fn doubt(&self) -> Option<&str> {
        self.doubt.as_deref()
    }

    /// Times of the first and last fix, seconds.
    pub(crate) fn span_s(&self) -> (f64, f64) {
        let time_s = |fix: Option<&TrackFix>| fix.map_or(0.0, |fix| fix.time_s);
        (time_s(self.fixes.first()), time_s(self.fixes.last()))
    }

    /// The pose at a time: on the straight line between two fixes that are at most [`MAX_GAP_S`] apart, else at the nearest
    /// fix if it is at most [`MAX_BEYOND_S`] away; `None` otherwise.
    pub(crate) fn fix_at(&self, time_s: f64) -> Option<TrackFix> {
        let next = self.fixes.partition_point(|fix| fix.time_s < time_s);
        let before = next.checked_sub(1).and_then(|at| self.fixes.get(at)).copied();
        let after = self.fixes.get(next).copied();
        if let (Some(before), Some(after)) = (before, after)
            && after.time_s - before.time_s <= MAX_GAP_S
        {
            return Some(fix_between(before, after, time_s));
        }
        let nearest = [before, after].into_iter().flatten().min_by(|a, b| {
            let off = |fix: &TrackFix| (fix.time_s - time_s).abs();
            off(a).total_cmp(&off(b))
        })?;
        ((nearest.time_s - time_s).abs() <= MAX_BEYOND_S).then_some(TrackFix { time_s, ..nearest })
    }
}

/// Whether a position, in metres, can be one.
pub(crate) fn is_valid_place(position: DVec3) -> bool {
    position.is_finite() && position.abs().max_element() <= MAX_COORDINATE_M
}

/// The pose at a time between two fixes, on the straight line and the short turn from one to the other.
fn fix_between(before: TrackFix, after: TrackFix, time_s: f64) -> TrackFix {
    let share = ((time_s - before.time_s) / (after.time_s - before.time_s)).clamp(0.0, 1.0);
    let heading = match (before.heading, after.heading) {
        (Some(from), Some(to)) => Some(from.turned_by(from.turn_to(to) * share)),
        (one, other) => one.or(other),
    };
    TrackFix { time_s, position: before.position.lerp(after.position, share), heading }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fix(time_s: f64, x: f64, deg: f64) -> TrackFix {
        let heading = Heading::new(deg.to_radians()).ok();
        TrackFix { time_s, position: DVec3::new(x, 0.0, 0.0), heading }
    }

    #[test]
    fn between_two_fixes_the_way_is_straight_and_the_turn_the_short_one() {
        let track = CameraTrack::new(vec![fix(2.0, 4.0, 10.0), fix(1.0, 2.0, 350.0)]).unwrap();
        let half = track.fix_at(1.5).unwrap();
        assert_eq!(half.position.x, 3.0);
        assert!(half.heading.unwrap().turn_to(Heading::NORTH).abs() < 1e-9);
    }

    #[test]
    fn track_has_no_fix_in_long_gaps_and_beyond_its_ends() {
        let track = CameraTrack::new(vec![fix(0.0, 0.0, 0.0), fix(10.0, 5.0, 0.0)]).unwrap();
        assert!(track.fix_at(5.0).is_none() && track.fix_at(-1.0).is_none() && track.fix_at(11.0).is_none());
        assert_eq!(track.fix_at(0.05).unwrap().position.x, 0.0);
        assert_eq!(track.fix_at(10.05).unwrap().position.x, 5.0);
        assert_eq!(track.fix_at(9.95).unwrap().position.x, 5.0);
    }

    #[test]
    fn track_drops_fixes_without_a_valid_position() {
        assert!(CameraTrack::new(vec![fix(0.0, f64::NAN, 0.0), fix(f64::NAN, 0.0, 0.0), fix(0.0, 1e9, 0.0)]).is_none());
        assert!(CameraTrack::new(vec![fix(0.0, 5.4e6, 0.0)]).is_some());
    }

    #[test]
    fn track_counts_the_fixes_that_it_drops() {
        let bad = [fix(1.0, f64::NAN, 0.0), fix(f64::NAN, 1.0, 0.0), fix(2.0, 1e308, 0.0)];
        let twice = [fix(0.0, 1.0, 0.0), fix(0.0, 1.0, 0.0), fix(0.0, 1.1, 0.0)];
        let track = CameraTrack::new([bad, twice].concat()).unwrap();
        assert_eq!(track.tally(), PoseTally { invalid: 3, repeated: 1, late: 0 });
        let late = PoseTally { late: 2, invalid: 1, repeated: 0 };
        assert_eq!(track.with_tally(late).tally(), PoseTally { invalid: 4, repeated: 1, late: 2 });
    }

    proptest! {
        #[test]
        fn every_place_lies_between_its_fixes(times in prop::collection::vec(0.0..20.0f64, 1..20), at in -1.0..21.0f64) {
            let fixes = times.iter().map(|time_s| fix(*time_s, *time_s, 0.0)).collect();
            let track = CameraTrack::new(fixes).unwrap();
            let (first, last) = track.span_s();
            if let Some(found) = track.fix_at(at) {
                prop_assert!((first..=last).contains(&found.position.x));
                prop_assert!((found.position.x - at).abs() <= MAX_BEYOND_S + 1e-9);
            }
        }
    }
}
