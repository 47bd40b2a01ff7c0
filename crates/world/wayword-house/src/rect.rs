//! Rectangles and walls on the centimetre grid.
//!
//! With integers, two rooms share a wall exactly, and the plan is the same on every machine.

use serde::{Deserialize, Serialize};

/// A rectangle along the axes, centimetres, world frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct RectCm {
    /// Western edge.
    pub x0: i32,
    /// Southern edge.
    pub y0: i32,
    /// Eastern edge.
    pub x1: i32,
    /// Northern edge.
    pub y1: i32,
}

/// One of the four walls of a rectangle, named by its side; north is +y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WallSide {
    /// +y.
    North,
    /// -x.
    West,
    /// -y.
    South,
    /// +x.
    East,
}

/// A stretch of a line along an axis, centimetres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct SpanCm {
    /// Whether it runs along x (then `at` is a y).
    pub along_x: bool,
    /// The coordinate on the other axis.
    pub at: i32,
    /// Lower end.
    pub from: i32,
    /// Upper end.
    pub to: i32,
}

impl WallSide {
    /// All four, by quarter turns counter-clockwise from north.
    pub const ALL: [Self; 4] = [Self::North, Self::West, Self::South, Self::East];

    /// Quarter turns, counter-clockwise, of a piece that has its back to this wall (0: its back is north, and it faces
    /// south).
    #[must_use]
    pub fn quarter_turns(self) -> u8 {
        self as u8
    }

    /// The wall across the room.
    #[must_use]
    pub fn opposite(self) -> Self {
        Self::ALL[(self as usize + 2) % 4]
    }

    /// Whether the wall runs along x.
    #[must_use]
    pub fn along_x(self) -> bool {
        matches!(self, Self::North | Self::South)
    }

    /// Unit step from the wall into the room.
    #[must_use]
    pub fn inward(self) -> (i32, i32) {
        match self {
            Self::North => (0, -1),
            Self::South => (0, 1),
            Self::West => (1, 0),
            Self::East => (-1, 0),
        }
    }
}

impl SpanCm {
    /// Length, centimetres.
    #[must_use]
    pub fn length(&self) -> i32 {
        self.to - self.from
    }

    /// The rectangle that reaches `depth` to both sides of it.
    #[must_use]
    pub fn thickened_by(&self, depth: i32) -> RectCm {
        if self.along_x {
            RectCm::new(self.from, self.at - depth, self.to, self.at + depth)
        } else {
            RectCm::new(self.at - depth, self.from, self.at + depth, self.to)
        }
    }

    /// Its middle, centimetres.
    #[must_use]
    pub fn middle(&self) -> (i32, i32) {
        let half = (self.from + self.to) / 2;
        if self.along_x { (half, self.at) } else { (self.at, half) }
    }
}

impl RectCm {
    /// From the south-western to the north-eastern corner.
    #[must_use]
    pub fn new(x0: i32, y0: i32, x1: i32, y1: i32) -> Self {
        Self { x0, y0, x1, y1 }
    }

    /// East to west, centimetres.
    #[must_use]
    pub fn width(&self) -> i32 {
        self.x1 - self.x0
    }

    /// South to north, centimetres.
    #[must_use]
    pub fn depth(&self) -> i32 {
        self.y1 - self.y0
    }

    /// Floor area, square metres.
    #[must_use]
    pub fn area_m2(&self) -> f64 {
        f64::from(self.width()) * f64::from(self.depth()) / 1e4
    }

    /// The middle, centimetres.
    #[must_use]
    pub fn centre(&self) -> (i32, i32) {
        ((self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2)
    }

    /// The rectangle made smaller by `by` on every side.
    #[must_use]
    pub fn inset(&self, by: i32) -> Self {
        Self::new(self.x0 + by, self.y0 + by, self.x1 - by, self.y1 - by)
    }

    /// Whether the insides overlap.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.x0 < other.x1 && other.x0 < self.x1 && self.y0 < other.y1 && other.y0 < self.y1
    }

    /// Whether `other` lies within.
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        self.x0 <= other.x0 && other.x1 <= self.x1 && self.y0 <= other.y0 && other.y1 <= self.y1
    }

    /// Whether a point (metres) lies within or on the edge.
    #[must_use]
    pub fn holds_m(&self, x_m: f64, y_m: f64) -> bool {
        let (x, y) = (x_m * 100.0, y_m * 100.0);
        f64::from(self.x0) <= x && x <= f64::from(self.x1) && f64::from(self.y0) <= y && y <= f64::from(self.y1)
    }

    /// One of its edges.
    #[must_use]
    pub fn edge_at(&self, wall: WallSide) -> SpanCm {
        let (at, from, to) = match wall {
            WallSide::North => (self.y1, self.x0, self.x1),
            WallSide::South => (self.y0, self.x0, self.x1),
            WallSide::West => (self.x0, self.y0, self.y1),
            WallSide::East => (self.x1, self.y0, self.y1),
        };
        SpanCm { along_x: wall.along_x(), at, from, to }
    }

    /// The stretch of wall that two rectangles share, and which wall of this one it lies on.
    #[must_use]
    pub fn shared_edge(&self, other: &Self) -> Option<(WallSide, SpanCm)> {
        WallSide::ALL.into_iter().find_map(|wall| {
            let (mine, theirs) = (self.edge_at(wall), other.edge_at(wall.opposite()));
            let (from, to) = (mine.from.max(theirs.from), mine.to.min(theirs.to));
            (mine.at == theirs.at && from < to).then_some((wall, SpanCm { from, to, ..mine }))
        })
    }

    /// The wall of this rectangle on which a span lies, if it lies on one.
    #[must_use]
    pub fn wall_of(&self, span: &SpanCm) -> Option<WallSide> {
        WallSide::ALL.into_iter().find(|wall| {
            let edge = self.edge_at(*wall);
            edge.along_x == span.along_x && edge.at == span.at && edge.from <= span.from && span.to <= edge.to
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_share_the_stretch_where_they_touch() {
        let (a, b) = (RectCm::new(0, 0, 400, 300), RectCm::new(100, 300, 600, 500));
        let (wall, span) = a.shared_edge(&b).unwrap();
        assert_eq!(wall, WallSide::North);
        assert_eq!((span.at, span.from, span.to), (300, 100, 400));
        assert_eq!(b.shared_edge(&a).unwrap().0, WallSide::South);
        assert_eq!(a.shared_edge(&RectCm::new(500, 0, 600, 100)), None);
        assert_eq!(a.wall_of(&span), Some(WallSide::North));
    }

    #[test]
    fn a_back_at_a_wall_faces_away_from_it() {
        // A quarter turn counter-clockwise takes the back from north (+y) to west (-x).
        assert_eq!(WallSide::West.quarter_turns(), 1);
        assert_eq!(WallSide::West.inward(), (1, 0));
        assert_eq!(WallSide::East.opposite(), WallSide::West);
    }
}
