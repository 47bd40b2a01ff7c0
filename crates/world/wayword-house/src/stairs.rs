//! The geometry of the stairs: two flights side by side, and a landing at their far end.

use super::{
    model::{HouseStairs, STOREY_CM},
    rect::{RectCm, WallSide},
};

/// Gap between the flights, for the railing, centimetres.
const GAP_CM: i32 = 12;

impl HouseStairs {
    /// Width of the well along its entry, centimetres.
    #[must_use]
    pub fn width_cm(&self) -> i32 {
        if self.entry.along_x() { self.well.width() } else { self.well.depth() }
    }

    /// Depth of the well from its entry, centimetres.
    #[must_use]
    pub fn depth_cm(&self) -> i32 {
        if self.entry.along_x() { self.well.depth() } else { self.well.width() }
    }

    /// Where a flight begins and ends along the entry, centimetres from the well's lower end.
    #[must_use]
    pub fn flight_across(&self, lower: bool) -> (i32, i32) {
        let half = self.width_cm() / 2;
        if lower == self.lower_flight_low { (0, half - GAP_CM / 2) } else { (half + GAP_CM / 2, self.width_cm()) }
    }

    /// The rectangle between two places along the entry and two depths, centimetres.
    #[must_use]
    pub fn rect_across(&self, from: i32, to: i32, deep: [i32; 2]) -> RectCm {
        let well = &self.well;
        match self.entry {
            WallSide::South => RectCm::new(well.x0 + from, well.y0 + deep[0], well.x0 + to, well.y0 + deep[1]),
            WallSide::North => RectCm::new(well.x0 + from, well.y1 - deep[1], well.x0 + to, well.y1 - deep[0]),
            WallSide::West => RectCm::new(well.x0 + deep[0], well.y0 + from, well.x0 + deep[1], well.y0 + to),
            WallSide::East => RectCm::new(well.x1 - deep[1], well.y0 + from, well.x1 - deep[0], well.y0 + to),
        }
    }

    /// The coordinates of a world point along the entry and away from it, metres.
    fn local_m(&self, x_m: f64, y_m: f64) -> (f64, f64) {
        let well = &self.well;
        let (x0, y0) = (f64::from(well.x0) / 100.0, f64::from(well.y0) / 100.0);
        let (x1, y1) = (f64::from(well.x1) / 100.0, f64::from(well.y1) / 100.0);
        match self.entry {
            WallSide::South => (x_m - x0, y_m - y0),
            WallSide::North => (x_m - x0, y1 - y_m),
            WallSide::West => (y_m - y0, x_m - x0),
            WallSide::East => (y_m - y0, x1 - x_m),
        }
    }

    /// Height of a flight's slope at a depth from the entry, metres.
    #[must_use]
    pub fn height_at_depth(&self, lower: bool, depth_m: f64) -> f64 {
        let half_m = f64::from(STOREY_CM) / 200.0;
        let share = (depth_m / (f64::from(self.flight_cm) / 100.0)).clamp(0.0, 1.0);
        if lower { half_m * share } else { half_m * (2.0 - share) }
    }

    /// Height of the slope under a point of the well, metres.
    #[must_use]
    pub fn height_at(&self, x_m: f64, y_m: f64) -> f64 {
        let (across, depth) = self.local_m(x_m, y_m);
        let is_low = across < f64::from(self.width_cm()) / 200.0;
        self.height_at_depth(is_low == self.lower_flight_low, depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_climbs_along_the_lower_flight_and_on_along_the_upper() {
        for entry in WallSide::ALL {
            for lower_flight_low in [true, false] {
                let well = RectCm::new(100, 200, 320, 420);
                let stairs =
                    HouseStairs { id: 1, railing_id: 2, room: 0, well, entry, lower_flight_low, flight_cm: 150 };
                let height = |lower: bool, depth: i32| {
                    let (from, to) = stairs.flight_across(lower);
                    let (x, y) = stairs.rect_across((from + to) / 2, (from + to) / 2, [depth, depth]).centre();
                    stairs.height_at(f64::from(x) / 100.0, f64::from(y) / 100.0)
                };
                assert!(height(true, 0) < 0.01 && (height(false, 0) - 3.0).abs() < 0.01);
                assert!((height(true, 75) - 0.75).abs() < 0.02 && (height(false, 75) - 2.25).abs() < 0.02);
                assert!((height(true, 200) - 1.5).abs() < 1e-9 && (height(false, 200) - 1.5).abs() < 1e-9);
            }
        }
    }
}
