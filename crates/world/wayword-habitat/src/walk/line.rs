//! The line on the ground that a walk follows: it measures how far along the line a place is, and how far off it.

use wayword_core::DVec3;

/// Two points of the line that are nearer than this count as one, metres.
const SAME_M: f64 = 1e-6;
/// A place farther above or below the line than this is on another storey, metres. On stairs the two differ a little, because the
/// line runs straight from point to point.
const STOREY_TOLERANCE_M: f64 = 1.2;

/// A line of straight pieces on the ground.
#[derive(Debug, Clone, Default)]
pub(super) struct GroundLine {
    /// Each corner with its distance from the beginning along the line, seen from above, metres.
    points: Vec<(DVec3, f64)>,
}

impl GroundLine {
    /// Appends a place to the line. Returns how far along the line the place is, metres.
    pub(super) fn push(&mut self, place: DVec3) -> f64 {
        let at = match self.points.last() {
            Some((last, at)) => at + (place - *last).truncate().length(),
            None => 0.0,
        };
        if self.points.last().is_none_or(|(_, last)| at - last > SAME_M) {
            self.points.push((place, at));
        }
        at
    }

    /// Length of the line, metres.
    pub(super) fn length_m(&self) -> f64 {
        self.points.last().map_or(0.0, |(_, at)| *at)
    }

    /// The place at a distance along the line, metres.
    pub(super) fn place_at(&self, along_m: f64) -> DVec3 {
        let after = self.points.partition_point(|(_, at)| *at < along_m);
        match (after.checked_sub(1).and_then(|before| self.points.get(before)), self.points.get(after)) {
            (Some((a, from)), Some((b, to))) => a.lerp(*b, (along_m - from) / (to - from)),
            (None, Some((place, _))) | (Some((place, _)), None) => *place,
            (None, None) => DVec3::ZERO,
        }
    }

    /// The nearest point to a place on the part of the line from `from_m` to `to_m`: how far along the line it is, and how far from
    /// the place, metres. `None` where the line is on another storey.
    pub(super) fn nearest_point(&self, place: DVec3, from_m: f64, to_m: f64) -> Option<(f64, f64)> {
        let first = self.points.partition_point(|(_, at)| *at <= from_m).saturating_sub(1);
        let pieces = self.points[first..].windows(2).take_while(|pair| pair[0].1 <= to_m);
        let near = pieces.map(|pair| {
            let ((a, from), (b, to)) = (pair[0], pair[1]);
            let flat = (b - a).truncate();
            let share = (place - a).truncate().dot(flat) / flat.length_squared();
            // The range is never empty: this piece begins at or before `to_m` and ends behind `from_m`.
            let along = (from + share * (to - from)).clamp(from.max(from_m), to.min(to_m));
            let on = a.lerp(b, (along - from) / (to - from));
            (along, (on - place).truncate().length(), (on.z - place.z).abs())
        });
        let near = near.filter(|(_, _, height_m)| *height_m <= STOREY_TOLERANCE_M);
        // Of two points at the same distance, the one farther along wins.
        near.min_by(|a, b| a.1.total_cmp(&b.1).then(b.0.total_cmp(&a.0))).map(|(along, off, _)| (along, off))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_along_the_line_and_only_within_the_part_that_is_asked_for() {
        let mut line = GroundLine::default();
        let place = |x, y| DVec3::new(x, y, 0.0);
        let marks = [place(0.0, 0.0), place(4.0, 0.0), place(4.0, 0.0), place(4.0, 3.0)].map(|place| line.push(place));
        assert_eq!((marks, line.length_m()), ([0.0, 4.0, 4.0, 7.0], 7.0));
        assert_eq!(
            (line.place_at(2.0), line.place_at(5.5), line.place_at(99.0)),
            (place(2.0, 0.0), place(4.0, 1.5), place(4.0, 3.0))
        );
        let (along, off) = line.nearest_point(place(1.0, 0.5), 0.0, 2.0).unwrap();
        assert!((along - 1.0).abs() < 1e-9 && (off - 0.5).abs() < 1e-9);
        let (along, off) = line.nearest_point(place(1.0, 0.0), 5.0, 6.0).unwrap();
        assert!((along - 5.0).abs() < 1e-9 && off > 3.0);
        assert!(line.nearest_point(DVec3::new(1.0, 0.0, 3.0), 0.0, 2.0).is_none());
    }
}
