//! Shortest ways over the cells: A*, then every corner left out that a straight walk can skip.

use super::{Raster, STRAIGHT};
use std::{cmp::Reverse, collections::BinaryHeap};

const DIAGONAL: [(i64, i64); 4] = [(1, 1), (-1, 1), (-1, -1), (1, -1)];
/// Lengths in thousandths of a cell, so that sums are exact and the same everywhere.
const STEP: u64 = 1000;
const DIAGONAL_STEP: u64 = 1414;
const NONE: usize = usize::MAX;

impl Raster {
    /// The corners of a way between two points, both among them; `None` where there is none. Within a few percent of the
    /// shortest: it keeps to the middles of cells.
    pub(crate) fn shortest(&self, from: [f64; 2], to: [f64; 2]) -> Option<Vec<[f64; 2]>> {
        let start = self.cell_at(from).filter(|cell| self.free[*cell])?;
        let goal = self.cell_at(to).filter(|cell| self.free[*cell])?;
        let before = self.search(start, goal)?;
        let chain = std::iter::successors(Some(goal), |cell| Some(before[*cell]).filter(|next| *next != NONE));
        let mut points: Vec<[f64; 2]> = chain.map(|cell| self.middle(cell)).collect();
        points.reverse();
        // The ends are where they were asked for, as far as the walk stays open.
        points.insert(0, from);
        points.push(to);
        Some(self.taut(&points))
    }

    fn search(&self, start: usize, goal: usize) -> Option<Vec<usize>> {
        let place = |cell: usize| ((cell % self.columns) as u64, (cell / self.columns) as u64);
        let left = |cell: usize| {
            let ((x, y), (gx, gy)) = (place(cell), place(goal));
            let (dx, dy) = (x.abs_diff(gx), y.abs_diff(gy));
            STEP * dx.max(dy) + (DIAGONAL_STEP - STEP) * dx.min(dy)
        };
        let mut best = vec![u64::MAX; self.free.len()];
        let mut before = vec![NONE; self.free.len()];
        let mut open = BinaryHeap::from([Reverse((left(start), start))]);
        best[start] = 0;
        while let Some(Reverse((estimate, cell))) = open.pop() {
            if cell == goal {
                return Some(before);
            }
            if estimate > best[cell] + left(cell) {
                continue;
            }
            for (next, step) in self.steps(cell) {
                let length = best[cell] + step;
                if length < best[next] {
                    (best[next], before[next]) = (length, cell);
                    open.push(Reverse((length + left(next), next)));
                }
            }
        }
        None
    }

    /// Free cells around one; a diagonal step needs both cells beside it.
    fn steps(&self, cell: usize) -> impl Iterator<Item = (usize, u64)> + '_ {
        let free = move |step| self.neighbour(cell, step).filter(|next| self.free[*next]);
        let straight = STRAIGHT.into_iter().filter_map(move |step| Some((free(step)?, STEP)));
        let diagonal = DIAGONAL.into_iter().filter_map(move |(dx, dy)| {
            free((dx, 0)).and(free((0, dy)))?;
            Some((free((dx, dy))?, DIAGONAL_STEP))
        });
        straight.chain(diagonal)
    }

    fn taut(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut kept = vec![points[0]];
        let mut at = 0;
        while at + 1 < points.len() {
            let far = (at + 1..points.len()).rev().find(|next| self.is_straight(points[at], points[*next]));
            at = far.unwrap_or(at + 1);
            kept.push(points[at]);
        }
        kept
    }
}
