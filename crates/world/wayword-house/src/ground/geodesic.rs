//! Shortest ways: A* over the cells, then pulled taut.

use super::{CELL_CM, Cell, Ground, NoWay};
use std::{cmp::Reverse, collections::BinaryHeap};
use wayword_core::DVec3;

/// A shortest way over the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// Corners, from start to goal, on the ground; metres.
    pub corners: Vec<DVec3>,
    /// Places along it at most 2.5 cm apart, on the ground; metres.
    pub places: Vec<DVec3>,
    /// Its length along the ground, slopes included; metres.
    pub length_m: f64,
}

const STEPS: [(i32, i32); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Lengths in thousandths of a cell, so that sums are exact and the same everywhere.
const STRAIGHT: u32 = 1000;
const DIAGONAL: u32 = 1414;

impl Ground {
    /// The shortest way between two places of the floor (metres, each within a cell of walkable ground).
    ///
    /// Taut to within a cell: it hugs corners at the walker's radius. Up to 1 or 2 % longer than the exact geodesic.
    ///
    /// # Errors
    /// When one cannot stand at one of the two, or no way leads from one to the other.
    pub fn geodesic(&self, from: DVec3, to: DVec3) -> Result<Way, NoWay> {
        let start = self.cell_at(from).ok_or(NoWay::NotWalkable(from))?;
        let goal = self.cell_at(to).ok_or(NoWay::NotWalkable(to))?;
        let cells = self.over_cells(start, goal).ok_or(NoWay::NotJoined(from, to))?;
        let mut corners = self.shortened(&cells);
        self.pull(&mut corners);
        Ok(self.way(&corners))
    }

    fn over_cells(&self, start: Cell, goal: Cell) -> Option<Vec<Cell>> {
        let size = self.grid.len();
        let number = |cell: Cell| cell.layer * size + cell.index;
        let mut best = vec![u32::MAX; size * self.grid.layers()];
        let mut before = vec![u32::MAX; best.len()];
        let (gx, gy) = self.grid.centre_m(goal.index);
        let left = |index: usize| {
            let (x, y) = self.grid.centre_m(index);
            let cells = |d: f64| (d.abs() * 100.0 / f64::from(CELL_CM)) as u32;
            let (dx, dy) = (cells(x - gx), cells(y - gy));
            STRAIGHT * dx.max(dy) + (DIAGONAL - STRAIGHT) * dx.min(dy)
        };
        let mut open = BinaryHeap::from([Reverse((left(start.index), number(start) as u32))]);
        best[number(start)] = 0;
        while let Some(Reverse((estimate, at))) = open.pop() {
            let cell = Cell { layer: at as usize / size, index: at as usize % size };
            let cost = best[at as usize];
            if cell == goal {
                return Some(self.traced(&before, at, size));
            }
            if estimate > cost + left(cell.index) {
                continue;
            }
            for (next, step) in self.neighbours(cell) {
                let to = number(next);
                if cost + step < best[to] {
                    best[to] = cost + step;
                    before[to] = at;
                    open.push(Reverse((cost + step + left(next.index), to as u32)));
                }
            }
        }
        None
    }

    fn traced(&self, before: &[u32], goal: u32, size: usize) -> Vec<Cell> {
        let chain = std::iter::successors(Some(goal), |at| Some(before[*at as usize]).filter(|next| *next != u32::MAX));
        let mut cells: Vec<_> = chain.map(|at| Cell { layer: at as usize / size, index: at as usize % size }).collect();
        cells.reverse();
        cells
    }

    pub(super) fn neighbours(&self, cell: Cell) -> impl Iterator<Item = (Cell, u32)> + '_ {
        let free = move |step: (i32, i32)| {
            let next = Cell { index: self.grid.offset(cell.index, step)?, ..cell };
            self.grid.is_free(next).then_some(next)
        };
        let walks = STEPS.into_iter().filter_map(move |step| {
            let is_diagonal = step.0 != 0 && step.1 != 0;
            // A corner is not cut: both cells beside a diagonal step must be free.
            let clear = !is_diagonal || (free((step.0, 0)).is_some() && free((0, step.1)).is_some());
            free(step).filter(|_| clear).map(|next| (next, if is_diagonal { DIAGONAL } else { STRAIGHT }))
        });
        let stairs = self.storeys as usize;
        let linked = self.grid.linked_floors(cell.index);
        let layers = (0..=stairs).filter(move |layer| {
            let joins = |floor: usize| linked >> floor & 1 == 1;
            (cell.layer == stairs && *layer < stairs && joins(*layer))
                || (*layer == stairs && cell.layer < stairs && joins(cell.layer))
        });
        walks.chain(layers.map(move |layer| (Cell { layer, ..cell }, 0)))
    }

    /// Leaves out every cell that a straight walk can skip.
    fn shortened(&self, cells: &[Cell]) -> Vec<Cell> {
        let mut kept = vec![cells[0]];
        let mut at = 0;
        while at + 1 < cells.len() {
            let far = (at + 1..cells.len()).rev().find(|next| self.is_straight(cells[at], cells[*next]));
            at = far.unwrap_or(at + 1);
            kept.push(cells[at]);
        }
        kept
    }

    /// Moves corners, as far as the walk stays open, to where the way is shorter, until none helps.
    fn pull(&self, corners: &mut Vec<Cell>) {
        for _ in 0..40 {
            let mut changed = false;
            for at in 1..corners.len().saturating_sub(1) {
                let (before, here, after) = (corners[at - 1], corners[at], corners[at + 1]);
                let length = |cell: Cell| self.flat_m(before, cell) + self.flat_m(cell, after);
                let reaches = [8, 4, 2, 1].into_iter().flat_map(|reach| STEPS.map(|(dx, dy)| (dx * reach, dy * reach)));
                let candidates =
                    reaches.filter_map(|step| Some(Cell { index: self.grid.offset(here.index, step)?, ..here }));
                let open = |cell: &Cell| {
                    self.grid.is_free(*cell) && self.is_straight(before, *cell) && self.is_straight(*cell, after)
                };
                let better = candidates
                    .filter(|cell| length(*cell) + 1e-9 < length(here))
                    .filter(open)
                    .min_by(|a, b| length(*a).total_cmp(&length(*b)));
                if let Some(better) = better {
                    corners[at] = better;
                    changed = true;
                }
            }
            *corners = self.shortened(corners);
            if !changed {
                return;
            }
        }
    }

    fn flat_m(&self, a: Cell, b: Cell) -> f64 {
        let ((ax, ay), (bx, by)) = (self.grid.centre_m(a.index), self.grid.centre_m(b.index));
        ((ax - bx) * (ax - bx) + (ay - by) * (ay - by)).sqrt()
    }

    fn way(&self, corners: &[Cell]) -> Way {
        let mut places: Vec<DVec3> = Vec::new();
        for pair in corners.windows(2) {
            let leg = self.straight(pair[0], pair[1]).unwrap_or_default();
            places.extend(leg.into_iter().skip(usize::from(!places.is_empty())));
        }
        if places.is_empty() {
            places.extend(corners.iter().map(|cell| self.place(*cell)));
        }
        let length_m = places.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        Way { corners: corners.iter().map(|cell| self.place(*cell)).collect(), places, length_m }
    }
}
