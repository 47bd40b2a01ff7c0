//! Writes the walkable cells as JSON, for the navigation file of a house.

use super::{CELL_CM, GroundCell, HouseGround};
use serde_json::{Value, json};

impl HouseGround {
    /// Raster and layers, each layer as runs of cells.
    pub(in super::super) fn to_json(&self) -> Value {
        let (x_m, y_m) = self.grid.origin_m();
        let layers = (0..self.grid.layer_count()).map(|layer| {
            let is_stairs = layer == self.storeys as usize;
            let height_m = (!is_stairs).then(|| self.height_at_m(layer, 0.0, 0.0));
            json!({ "kind": if is_stairs { "stairs" } else { "floor" }, "height_m": height_m, "runs": self.free_runs(layer) })
        });
        json!({
            "cell_m": f64::from(CELL_CM) / 100.0,
            "origin_m": [x_m, y_m],
            "columns": self.grid.column_count(),
            "rows": self.grid.len() / self.grid.column_count().max(1),
            "layers": layers.collect::<Vec<_>>(),
        })
    }

    /// Row, first and last column of every run of free cells.
    fn free_runs(&self, layer: usize) -> Vec<[usize; 3]> {
        let columns = self.grid.column_count().max(1);
        let mut runs: Vec<[usize; 3]> = Vec::new();
        for index in (0..self.grid.len()).filter(|index| self.grid.is_free(GroundCell { layer, index: *index })) {
            let (row, column) = (index / columns, index % columns);
            match runs.last_mut() {
                Some([last_row, _, end]) if *last_row == row && *end + 1 == column => *end = column,
                _ => runs.push([row, column, column]),
            }
        }
        runs
    }
}
