//! Finds shortest ways over the ground: first A* over the cells, then the way is pulled taut like a string.

use super::{CELL_CM, GroundCell, GroundRouteError, HouseGround};
use wayword_core::DVec3;
use wayword_world::grid_search::{
    EIGHT_NEIGHBOUR_STEPS, find_shortest_way, free_steps_around, min_way_length, pull_taut,
};

/// A shortest way over the ground.
#[derive(Debug, Clone, PartialEq)]
pub struct HouseRoute {
    /// Corners, from start to goal, on the ground; metres.
    pub corners: Vec<DVec3>,
    /// Places along it at most 2.5 cm apart, on the ground; metres.
    pub places: Vec<DVec3>,
    /// Its length along the ground, slopes included; metres.
    pub length_m: f64,
}

impl HouseGround {
    /// The shortest way between two places of the floor (metres, each within a cell of walkable ground).
    ///
    /// Taut to within a cell: it hugs corners at the walker's radius. Up to 1 or 2 % longer than the exact geodesic.
    ///
    /// # Errors
    /// When one of the two places is not walkable, or no way leads from one to the other.
    pub fn shortest_route(&self, from: DVec3, to: DVec3) -> Result<HouseRoute, GroundRouteError> {
        let start = self.cell_at(from).ok_or(GroundRouteError::NotWalkable(from))?;
        let goal = self.cell_at(to).ok_or(GroundRouteError::NotWalkable(to))?;
        let cells = self.shortest_cell_route(start, goal).ok_or(GroundRouteError::NotJoined(from, to))?;
        let mut corners = pull_taut(&cells, |a, b| self.is_straight(a, b));
        self.pull_corners(&mut corners);
        Ok(self.route_along(&corners))
    }

    /// The shortest way from cell to cell, which still has the corners of the grid.
    fn shortest_cell_route(&self, start: GroundCell, goal: GroundCell) -> Option<Vec<GroundCell>> {
        let size = self.grid.len();
        // The search numbers the cells of all layers one after another.
        let number = |cell: GroundCell| cell.layer * size + cell.index;
        let cell = |number: usize| GroundCell { layer: number / size, index: number % size };
        let (gx, gy) = self.grid.centre_m(goal.index);
        let least_left = |at: usize| {
            let (x, y) = self.grid.centre_m(cell(at).index);
            let cells = |d: f64| (d.abs() * 100.0 / f64::from(CELL_CM)) as u64;
            min_way_length(cells(x - gx), cells(y - gy))
        };
        let steps = |at: usize| self.neighbour_cells(cell(at)).map(|(next, step)| (number(next), step));
        let way = find_shortest_way(size * self.grid.layer_count(), number(start), number(goal), least_left, steps)?;
        Some(way.into_iter().map(cell).collect())
    }

    /// The cells that can be reached from a cell, with the length of each step: those around it, and at no cost the same cell
    /// in a linked layer.
    pub(super) fn neighbour_cells(&self, cell: GroundCell) -> impl Iterator<Item = (GroundCell, u64)> + '_ {
        let walks = free_steps_around(move |step| {
            let next = GroundCell { index: self.grid.offset_index(cell.index, step)?, ..cell };
            self.grid.is_free(next).then_some(next)
        });
        let stairs = self.storeys as usize;
        let linked = self.grid.linked_floors(cell.index);
        let layers = (0..=stairs).filter(move |layer| {
            let joins = |floor: usize| linked >> floor & 1 == 1;
            (cell.layer == stairs && *layer < stairs && joins(*layer))
                || (*layer == stairs && cell.layer < stairs && joins(cell.layer))
        });
        walks.chain(layers.map(move |layer| (GroundCell { layer, ..cell }, 0)))
    }

    /// Moves corners by up to eight cells to where the way is shorter and still free, until no move helps (at most 40 rounds).
    fn pull_corners(&self, corners: &mut Vec<GroundCell>) {
        for _ in 0..40 {
            let mut changed = false;
            for at in 1..corners.len().saturating_sub(1) {
                let (before, here, after) = (corners[at - 1], corners[at], corners[at + 1]);
                let length =
                    |cell: GroundCell| self.level_distance_m(before, cell) + self.level_distance_m(cell, after);
                let reaches = [8, 4, 2, 1]
                    .into_iter()
                    .flat_map(|reach| EIGHT_NEIGHBOUR_STEPS.map(|(dx, dy)| (dx * reach, dy * reach)));
                let candidates = reaches
                    .filter_map(|step| Some(GroundCell { index: self.grid.offset_index(here.index, step)?, ..here }));
                let open = |cell: &GroundCell| {
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
            *corners = pull_taut(corners, |a, b| self.is_straight(a, b));
            if !changed {
                return;
            }
        }
    }

    /// The distance between the middles of two cells, seen from above, metres.
    fn level_distance_m(&self, a: GroundCell, b: GroundCell) -> f64 {
        let ((ax, ay), (bx, by)) = (self.grid.centre_m(a.index), self.grid.centre_m(b.index));
        ((ax - bx) * (ax - bx) + (ay - by) * (ay - by)).sqrt()
    }

    /// The route that goes straight from corner to corner.
    fn route_along(&self, corners: &[GroundCell]) -> HouseRoute {
        let mut places: Vec<DVec3> = Vec::new();
        for pair in corners.windows(2) {
            let leg = self.straight_walk(pair[0], pair[1]).unwrap_or_default();
            places.extend(leg.into_iter().skip(usize::from(!places.is_empty())));
        }
        if places.is_empty() {
            places.extend(corners.iter().map(|cell| self.middle_of_cell(*cell)));
        }
        let length_m = places.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        HouseRoute { corners: corners.iter().map(|cell| self.middle_of_cell(*cell)).collect(), places, length_m }
    }
}
