//! Finds shortest ways over the cells of a grid with A*, and removes the places that a straight walk can skip.
//!
//! The caller decides what a cell is, how cells are numbered and where a walker can stand. So a house of several
//! storeys, each a layer of cells, is searched like one flat floor. Lengths are whole numbers, so the same grid gives
//! the same way on every machine.

use std::{cmp::Reverse, collections::BinaryHeap};

/// Offsets, in columns and rows, from a cell to the eight around it: straight steps first, then diagonal ones.
pub const EIGHT_NEIGHBOUR_STEPS: [(i32, i32); 8] =
    [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];

/// Length of a straight step in thousandths of a cell: a whole number, so that sums are exact.
const STRAIGHT_STEP_MILLICELLS: u64 = 1000;
/// Length of a diagonal step in thousandths of a cell: the square root of 2, rounded down.
const DIAGONAL_STEP_MILLICELLS: u64 = 1414;

/// The free cells around a cell, with the length of the step to each. `free` turns an offset in columns and rows into
/// the cell at that offset, or into `None` if a walker cannot stand there. A diagonal step cuts no corner: the two cells
/// that it passes must be free too.
pub fn free_steps_around<C>(free: impl Fn((i32, i32)) -> Option<C>) -> impl Iterator<Item = (C, u64)> {
    EIGHT_NEIGHBOUR_STEPS.into_iter().filter_map(move |(dx, dy)| {
        if dx == 0 || dy == 0 {
            return Some((free((dx, dy))?, STRAIGHT_STEP_MILLICELLS));
        }
        free((dx, 0)).and(free((0, dy)))?;
        Some((free((dx, dy))?, DIAGONAL_STEP_MILLICELLS))
    })
}

/// A lower bound of the length of a way between two cells: its length if all ground between them were free. `columns` and
/// `rows` are their distances.
#[must_use]
pub fn min_way_length(columns: u64, rows: u64) -> u64 {
    STRAIGHT_STEP_MILLICELLS * columns.max(rows)
        + (DIAGONAL_STEP_MILLICELLS - STRAIGHT_STEP_MILLICELLS) * columns.min(rows)
}

/// A shortest way between two of `count` cells, both ends included; `None` if there is none. `left` gives a lower bound
/// of the length from a cell to the goal (the heuristic of A*). `steps` gives the cells that can be reached from a cell,
/// with the length of each step. If several ways have the same length, the result is always the same one.
pub fn find_shortest_way<S: IntoIterator<Item = (usize, u64)>>(
    count: usize,
    start: usize,
    goal: usize,
    left: impl Fn(usize) -> u64,
    steps: impl Fn(usize) -> S,
) -> Option<Vec<usize>> {
    let mut best = vec![u64::MAX; count];
    let mut before = vec![usize::MAX; count];
    let mut open = BinaryHeap::from([Reverse((left(start), start))]);
    best[start] = 0;
    while let Some(Reverse((estimate, cell))) = open.pop() {
        if cell == goal {
            let back = |cell: &usize| Some(before[*cell]).filter(|before| *before != usize::MAX);
            let mut way: Vec<usize> = std::iter::successors(Some(goal), back).collect();
            way.reverse();
            return Some(way);
        }
        let length = best[cell];
        // This entry of the queue is out of date: a shorter way to the cell was found after it was added.
        if estimate > length + left(cell) {
            continue;
        }
        for (next, step) in steps(cell) {
            if length + step < best[next] {
                (best[next], before[next]) = (length + step, cell);
                open.push(Reverse((length + step + left(next), next)));
            }
        }
    }
    None
}

/// Removes the places of a way that a straight walk can skip: from each place, the way goes on to the last one that
/// `is_straight` allows.
pub fn pull_taut<P: Copy>(places: &[P], is_straight: impl Fn(P, P) -> bool) -> Vec<P> {
    let mut kept = Vec::from_iter(places.first().copied());
    let mut at = 0;
    while at + 1 < places.len() {
        let far = (at + 1..places.len()).rev().find(|next| is_straight(places[at], places[*next]));
        at = far.unwrap_or(at + 1);
        kept.push(places[at]);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shortest way from `a` to `b` over a drawing in which `#` is blocked, and its length.
    fn way(drawing: &[&str]) -> Option<(Vec<usize>, u64)> {
        let columns = drawing[0].len();
        let cells = drawing.concat().into_bytes();
        let find = |name: u8| cells.iter().position(|cell| *cell == name).unwrap();
        let (start, goal) = (find(b'a'), find(b'b'));
        let place = |cell: usize| (cell % columns, cell / columns);
        let steps = |cell: usize| {
            let (column, row) = place(cell);
            let free = |(dx, dy): (i32, i32)| {
                let (column, row) = (column.checked_add_signed(dx as isize)?, row.checked_add_signed(dy as isize)?);
                let next = row * columns + column;
                (column < columns && *cells.get(next)? != b'#').then_some(next)
            };
            free_steps_around(free).collect::<Vec<_>>()
        };
        let left = |cell: usize| {
            let ((x, y), (gx, gy)) = (place(cell), place(goal));
            min_way_length(x.abs_diff(gx) as u64, y.abs_diff(gy) as u64)
        };
        let found = find_shortest_way(cells.len(), start, goal, left, steps)?;
        let length =
            found.windows(2).map(|pair| steps(pair[0]).iter().find(|(next, _)| *next == pair[1]).unwrap().1).sum();
        Some((found, length))
    }

    #[test]
    fn the_shorter_way_round_is_taken_and_no_corner_cut() {
        assert_eq!(way(&["a..b"]).unwrap(), (vec![0, 1, 2, 3], 3000));
        assert_eq!(way(&["a..", "...", "..b"]).unwrap(), (vec![0, 4, 8], 2828));
        assert_eq!(way(&["a#b", "...", "###"]).unwrap(), (vec![0, 3, 4, 5, 2], 4000));
        assert_eq!(way(&["a#.", "#.b"]), None);
        assert_eq!(way(&["a.#.b", "..#..", "..#..", "....."]).unwrap().1, 2 * 2414 + 2 * 2000);
    }

    #[test]
    fn a_way_from_a_place_to_itself_is_that_place() {
        assert_eq!(find_shortest_way(3, 1, 1, |_| 0, |_| []), Some(vec![1]));
    }

    #[test]
    fn pull_taut_leaves_out_places_that_a_straight_walk_skips() {
        let straight = |a: i32, b: i32| a / 10 == b / 10;
        assert_eq!(pull_taut(&[1, 3, 5, 11, 14, 21], straight), [1, 5, 11, 14, 21]);
        assert_eq!(pull_taut(&[7], straight), [7]);
        assert!(pull_taut(&[], straight).is_empty());
    }
}
