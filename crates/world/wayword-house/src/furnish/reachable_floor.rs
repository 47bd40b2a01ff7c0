//! Checks that one can still walk between all doors of a room, and to most of its floor, with the furniture in place.

use super::super::rect::RectCm;

/// Side of a cell, centimetres.
const CELL_CM: i32 = 10;
/// Half the width of a walker, with a margin, centimetres.
const WALKER_RADIUS_CM: i32 = 27;

/// Whether, with these obstacles, every doorstep can be reached from every other, and no large part of the floor is cut
/// off.
pub(super) fn ways_stay_open(inner: &RectCm, obstacles: &[RectCm], doorsteps: &[RectCm]) -> bool {
    let (columns, rows) = (inner.width() / CELL_CM, inner.depth() / CELL_CM);
    let swollen: Vec<_> = obstacles.iter().map(|area| area.inset(-WALKER_RADIUS_CM)).collect();
    let floor = inner.inset(WALKER_RADIUS_CM);
    // Walls swell too, except at doorsteps, which lead through them.
    let is_free = |column: i32, row: i32| {
        let (x, y) = (inner.x0 + column * CELL_CM + CELL_CM / 2, inner.y0 + row * CELL_CM + CELL_CM / 2);
        let at = RectCm::new(x, y, x + 1, y + 1);
        let open = floor.contains(&at) || doorsteps.iter().any(|step| step.contains(&at));
        open && !swollen.iter().any(|area| area.overlaps(&at))
    };
    let free: Vec<bool> = (0..rows).flat_map(|row| (0..columns).map(move |column| is_free(column, row))).collect();
    let parts = flood_parts(&free, columns, rows);
    let largest = parts.sizes.iter().copied().max().unwrap_or(0);
    let total: usize = parts.sizes.iter().sum();
    let part_of = |step: &RectCm| {
        let cell = |cm: i32, count: i32| (cm / CELL_CM).clamp(0, count - 1);
        let (left, right) = (cell(step.x0 - inner.x0, columns), cell(step.x1 - 1 - inner.x0, columns));
        let (low, high) = (cell(step.y0 - inner.y0, rows), cell(step.y1 - 1 - inner.y0, rows));
        // An open leaf may cover the middle, so any free place on the doorstep counts; those nearest to its middle are
        // tried first.
        let mut cells: Vec<_> = (low..=high).flat_map(|row| (left..=right).map(move |column| (column, row))).collect();
        cells.sort_by_key(|(column, row)| (2 * column - left - right).abs() + (2 * row - low - high).abs());
        cells.into_iter().find_map(|(column, row)| parts.part[(row * columns + column) as usize])
    };
    let steps: Vec<_> = doorsteps.iter().map(part_of).collect();
    let joined = steps.iter().all(|part| part.is_some() && *part == steps[0]);
    // Corners behind furniture may be cut off, but together they are at most 12 % of the free floor.
    joined && largest * 100 >= total * 88
}

/// The connected parts of the free floor: the part of each cell, and the number of cells in each part.
struct FloorParts {
    part: Vec<Option<usize>>,
    sizes: Vec<usize>,
}

/// Divides the free cells of a grid into connected parts. Cells are numbered row by row.
fn flood_parts(free: &[bool], columns: i32, rows: i32) -> FloorParts {
    let mut parts = FloorParts { part: vec![None; free.len()], sizes: Vec::new() };
    for start in 0..free.len() {
        if !free[start] || parts.part[start].is_some() {
            continue;
        }
        let number = parts.sizes.len();
        let (mut size, mut open) = (0, vec![start]);
        parts.part[start] = Some(number);
        while let Some(cell) = open.pop() {
            size += 1;
            let (column, row) = (cell as i32 % columns, cell as i32 / columns);
            for (c, r) in [(column - 1, row), (column + 1, row), (column, row - 1), (column, row + 1)] {
                let next = (r * columns + c) as usize;
                if (0..columns).contains(&c) && (0..rows).contains(&r) && free[next] && parts.part[next].is_none() {
                    parts.part[next] = Some(number);
                    open.push(next);
                }
            }
        }
        parts.sizes.push(size);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_barrier_between_two_doors_is_refused() {
        let inner = RectCm::new(0, 0, 400, 300);
        let doors = [RectCm::new(0, 100, 80, 190), RectCm::new(320, 100, 400, 190)];
        assert!(ways_stay_open(&inner, &[], &doors));
        assert!(!ways_stay_open(&inner, &[RectCm::new(180, 0, 220, 300)], &doors));
        assert!(ways_stay_open(&inner, &[RectCm::new(180, 0, 220, 200)], &doors));
        // A gap that is too narrow for a walker.
        assert!(!ways_stay_open(&inner, &[RectCm::new(180, 0, 220, 260)], &doors));
    }
}
