//! Straight walks over the grid: whether one is possible, and the places along it.

use super::{GroundCell, HouseGround};
use wayword_core::DVec3;

/// Longest step between two tested places, metres: half a cell.
const STEP_M: f64 = 0.025;

impl HouseGround {
    /// The layers on which a walker may be at a cell, one bit for each, if the walker comes from the layers `on`.
    fn layers_at(&self, on: u8, index: usize) -> u8 {
        let (free, linked) = (self.grid.free_layers(index), self.grid.linked_floors(index));
        let stairs = 1_u8 << self.storeys;
        let kept = on & free;
        let down = if kept & stairs != 0 { linked } else { 0 };
        let up = if kept & linked != 0 { stairs } else { 0 };
        kept | ((down | up) & free)
    }

    /// The places of a straight walk between two cells, on the ground, half a cell apart; `None` if something is in the way.
    pub(super) fn straight_walk(&self, from: GroundCell, to: GroundCell) -> Option<Vec<DVec3>> {
        let mut places = Vec::new();
        self.march_straight(from, to, |x_m, y_m, on| {
            let stairs = self.storeys as usize;
            let layer = if on >> stairs & 1 == 1 { stairs } else { on.trailing_zeros() as usize };
            places.push(DVec3::new(x_m, y_m, self.height_at_m(layer, x_m, y_m)));
        })
        .then_some(places)
    }

    /// Whether one can walk straight from one cell to another.
    pub(in super::super) fn is_straight(&self, from: GroundCell, to: GroundCell) -> bool {
        self.march_straight(from, to, |_, _, _| {})
    }

    /// Whether a diagonal step leads between two blocked cells that touch at a corner. A search from cell to cell does not go there either.
    fn is_between_corners(&self, on: u8, from: usize, to: usize) -> bool {
        let (columns, rows) = self.grid.offset_between(from, to);
        let is_blocked = |step| self.grid.offset_index(from, step).is_none_or(|index| self.layers_at(on, index) == 0);
        columns != 0 && rows != 0 && is_blocked((columns, 0)) && is_blocked((0, rows))
    }

    /// Walks straight from one cell to another in small steps. `visit` gets the place of each step and the layers that are
    /// possible there. Returns whether the walk arrives.
    fn march_straight(&self, from: GroundCell, to: GroundCell, mut visit: impl FnMut(f64, f64, u8)) -> bool {
        let ((ax, ay), (bx, by)) = (self.grid.centre_m(from.index), self.grid.centre_m(to.index));
        let (dx, dy) = (bx - ax, by - ay);
        let count = ((dx * dx + dy * dy).sqrt() / STEP_M).ceil().max(1.0) as usize;
        let mut on = self.layers_at(1 << from.layer, from.index);
        let mut before = from.index;
        for step in 0..=count {
            let share = step as f64 / count as f64;
            let (x_m, y_m) = (ax + dx * share, ay + dy * share);
            match self.grid.index_at(x_m, y_m) {
                Some(index) if self.is_between_corners(on, before, index) => return false,
                Some(index) => (on, before) = (self.layers_at(on, index), index),
                None => return false,
            }
            if on == 0 {
                return false;
            }
            visit(x_m, y_m, on);
        }
        on >> to.layer & 1 == 1
    }
}
