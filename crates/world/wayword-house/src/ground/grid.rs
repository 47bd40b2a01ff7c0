//! The grid behind the walkable ground: cells in layers above one another, each free or blocked.

use super::{
    super::{model::House, rect::RectCm},
    CELL_CM,
};
use std::collections::VecDeque;

/// A cell of a layer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in super::super) struct GroundCell {
    pub(in super::super) layer: usize,
    pub(in super::super) index: usize,
}

/// The areas that make a layer: a cell is free if an `open` area covers it and no `blocked` area does.
pub(super) struct GroundLayer {
    pub(super) open: Vec<RectCm>,
    pub(super) blocked: Vec<RectCm>,
}

/// All layers over one raster.
#[derive(Debug, Clone)]
pub(super) struct GroundGrid {
    x0_cm: i32,
    y0_cm: i32,
    columns: i32,
    rows: i32,
    layers: usize,
    /// For each cell, one bit for each layer in which it is free.
    free: Vec<u8>,
    /// For each cell, one bit for each storey that is linked with the stairs there.
    linked: Vec<u8>,
}

impl GroundGrid {
    pub(super) fn new(house: &House, layers: &[GroundLayer]) -> Self {
        let outlines = || house.rooms.iter().map(|room| room.outline);
        let low = |side: fn(&RectCm) -> i32| outlines().map(|outline| side(&outline)).min().unwrap_or(0);
        let high = |side: fn(&RectCm) -> i32| outlines().map(|outline| side(&outline)).max().unwrap_or(0);
        let (x0_cm, y0_cm) = (low(|outline| outline.x0), low(|outline| outline.y0));
        let columns = (high(|outline| outline.x1) - x0_cm) / CELL_CM;
        let rows = (high(|outline| outline.y1) - y0_cm) / CELL_CM;
        let cells = (columns * rows).max(0) as usize;
        let mut grid =
            Self { x0_cm, y0_cm, columns, rows, layers: layers.len(), free: vec![0; cells], linked: vec![0; cells] };
        for (layer, areas) in layers.iter().enumerate() {
            let bit = 1 << layer;
            areas.open.iter().for_each(|area| grid.each_in(area, true, |cell| *cell |= bit));
            areas.blocked.iter().for_each(|area| grid.each_in(area, false, |cell| *cell &= !bit));
        }
        grid
    }

    /// Changes the cells that have their middle in a rectangle; a middle on its edge counts as inside if `closed` is true.
    fn each_in(&mut self, area: &RectCm, closed: bool, change: impl Fn(&mut u8)) {
        // Doubled centimetres, since a cell's middle may lie between two.
        let first = |edge: i32, origin: i32| {
            let from = 2 * (edge - origin) - CELL_CM + i32::from(!closed);
            from.div_euclid(2 * CELL_CM) + i32::from(from.rem_euclid(2 * CELL_CM) != 0)
        };
        let after = |edge: i32, origin: i32| {
            let to = 2 * (edge - origin) - CELL_CM - i32::from(!closed);
            to.div_euclid(2 * CELL_CM) + 1
        };
        for row in first(area.y0, self.y0_cm).max(0)..after(area.y1, self.y0_cm).min(self.rows) {
            for column in first(area.x0, self.x0_cm).max(0)..after(area.x1, self.x0_cm).min(self.columns) {
                change(&mut self.free[(row * self.columns + column) as usize]);
            }
        }
    }

    pub(super) fn len(&self) -> usize {
        self.free.len()
    }

    pub(super) fn column_count(&self) -> usize {
        self.columns.max(0) as usize
    }

    /// South-western corner of the raster, metres.
    pub(super) fn origin_m(&self) -> (f64, f64) {
        (f64::from(self.x0_cm) / 100.0, f64::from(self.y0_cm) / 100.0)
    }

    pub(super) fn layer_count(&self) -> usize {
        self.layers
    }

    pub(super) fn is_free(&self, cell: GroundCell) -> bool {
        self.free[cell.index] >> cell.layer & 1 == 1
    }

    pub(super) fn block_cell(&mut self, cell: GroundCell) {
        self.free[cell.index] &= !(1 << cell.layer);
    }

    /// The layers in which a cell is free, one bit for each.
    pub(super) fn free_layers(&self, index: usize) -> u8 {
        self.free[index]
    }

    /// The storeys that are linked with the stairs at a cell, one bit for each.
    pub(super) fn linked_floors(&self, index: usize) -> u8 {
        self.linked[index]
    }

    pub(super) fn set_linked(&mut self, index: usize, floor: usize, linked: bool) {
        self.linked[index] |= u8::from(linked) << floor;
    }

    /// The index of the cell at a point of the world frame; `None` outside the raster.
    pub(super) fn index_at(&self, x_m: f64, y_m: f64) -> Option<usize> {
        let step = |place_m: f64, origin_cm: i32, count: i32| {
            let cell = ((place_m * 100.0 - f64::from(origin_cm)) / f64::from(CELL_CM)).floor();
            (cell >= 0.0 && cell < f64::from(count)).then_some(cell as i32)
        };
        let (column, row) = (step(x_m, self.x0_cm, self.columns)?, step(y_m, self.y0_cm, self.rows)?);
        Some((row * self.columns + column) as usize)
    }

    /// The middle of a cell, metres, world frame.
    pub(super) fn centre_m(&self, index: usize) -> (f64, f64) {
        let (column, row) = (index as i32 % self.columns, index as i32 / self.columns);
        let middle = |origin: i32, cell: i32| f64::from(2 * (origin + cell * CELL_CM) + CELL_CM) / 200.0;
        (middle(self.x0_cm, column), middle(self.y0_cm, row))
    }

    /// How many columns and rows lie between two cells.
    pub(super) fn offset_between(&self, from: usize, to: usize) -> (i32, i32) {
        let place = |index: usize| (index as i32 % self.columns, index as i32 / self.columns);
        let ((from_column, from_row), (column, row)) = (place(from), place(to));
        (column - from_column, row - from_row)
    }

    /// The cell that lies `dx` columns and `dy` rows away.
    pub(super) fn offset_index(&self, index: usize, (dx, dy): (i32, i32)) -> Option<usize> {
        let (column, row) = (index as i32 % self.columns + dx, index as i32 / self.columns + dy);
        let inside = (0..self.columns).contains(&column) && (0..self.rows).contains(&row);
        inside.then_some((row * self.columns + column) as usize)
    }

    /// For each cell of a layer, the steps to the nearest cell that is not free; 0 for a cell that is not free itself.
    pub(super) fn layer_clearances(&self, layer: usize) -> Vec<u32> {
        let mut steps = vec![u32::MAX; self.len()];
        let mut open = VecDeque::new();
        for (index, step) in steps.iter_mut().enumerate() {
            if !self.is_free(GroundCell { layer, index }) {
                *step = 0;
                open.push_back(index);
            }
        }
        while let Some(index) = open.pop_front() {
            for next in [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().filter_map(|step| self.offset_index(index, step))
            {
                if steps[next] == u32::MAX {
                    steps[next] = steps[index] + 1;
                    open.push_back(next);
                }
            }
        }
        steps
    }
}
