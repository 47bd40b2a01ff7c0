//! The walkable ground of a house: a grid of cells over each storey and over the stairs.
//!
//! There is one layer of cells for each storey and one for the stairwell, because two flights can lie above each other's
//! floor. The stairwell's layer reaches a little way onto the floors of the storeys, and there the layers are linked. So
//! every place has one height in its layer, and a straight walk is a walk over cells.

mod export;
mod geodesic;
mod grid;
mod walk;

use super::{
    model::{HALF_WALL_CM, House, HouseStairs, STOREY_CM, WallOpening},
    rect::RectCm,
};
pub use geodesic::HouseRoute;
pub(super) use grid::GroundCell;
use grid::{GroundGrid, GroundLayer};
use wayword_core::DVec3;

/// Radius of the walker, centimetres.
pub const RADIUS_CM: i32 = 20;
/// Side of a cell, centimetres.
pub(super) const CELL_CM: i32 = 5;
/// How far the stairwell's layer reaches out onto the floors, centimetres.
const APRON_CM: i32 = 40;
/// A walker fits under objects that begin at this height above the floor, centimetres.
const HEADROOM_CM: i32 = 175;

/// The walkable ground of a house.
#[derive(Debug, Clone)]
pub struct HouseGround {
    grid: GroundGrid,
    stairs: Option<HouseStairs>,
    storeys: u32,
}

/// Why there is no way between two places.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum GroundRouteError {
    /// A place that is not walkable.
    #[error("{0} is not on walkable ground: choose a place at least {RADIUS_CM} cm from walls and furniture")]
    NotWalkable(DVec3),
    /// Two places in parts that do not touch.
    #[error("no way leads from {0} to {1}")]
    NotJoined(DVec3, DVec3),
}

impl HouseGround {
    /// The ground of a house, for a walker of [`RADIUS_CM`].
    #[must_use]
    pub fn for_house(house: &House) -> Self {
        let mut layers: Vec<GroundLayer> = (0..house.storeys).map(|floor| floor_layer(house, floor)).collect();
        layers.extend(house.stairs.as_ref().map(|stairs| stairs_layer(house, stairs)));
        let mut ground =
            Self { grid: GroundGrid::new(house, &layers), stairs: house.stairs.clone(), storeys: house.storeys };
        ground.link_layers();
        ground.keep_largest_part();
        ground
    }

    /// Keeps only the largest connected part of the ground. The rest are pockets behind furniture that cannot be reached.
    fn keep_largest_part(&mut self) {
        let size = self.grid.len();
        let number = |cell: GroundCell| cell.layer * size + cell.index;
        let mut part = vec![0_usize; size * self.grid.layer_count()];
        let mut sizes = vec![0_usize];
        for start in self.free_cells().collect::<Vec<_>>() {
            if part[number(start)] != 0 {
                continue;
            }
            let name = sizes.len();
            sizes.push(0);
            let mut open = vec![start];
            part[number(start)] = name;
            while let Some(cell) = open.pop() {
                sizes[name] += 1;
                for (next, _) in self.neighbour_cells(cell) {
                    if part[number(next)] == 0 {
                        part[number(next)] = name;
                        open.push(next);
                    }
                }
            }
        }
        let largest = (1..sizes.len()).max_by_key(|name| sizes[*name]).unwrap_or(0);
        for cell in self.free_cells().collect::<Vec<_>>() {
            if part[number(cell)] != largest {
                self.grid.block_cell(cell);
            }
        }
    }

    /// Links the stairwell's layer with a storey's wherever both have a cell at the same height.
    fn link_layers(&mut self) {
        let stairs = self.storeys as usize;
        if self.stairs.is_none() {
            return;
        }
        for index in 0..self.grid.len() {
            for floor in 0..stairs {
                let (lower, upper) = (GroundCell { layer: floor, index }, GroundCell { layer: stairs, index });
                if self.grid.is_free(lower) && self.grid.is_free(upper) {
                    let rise_m = self.height_m(lower) - self.height_m(upper);
                    self.grid.set_linked(index, floor, rise_m.abs() < 0.02);
                }
            }
        }
    }

    /// Height of the ground in a cell, metres.
    fn height_m(&self, cell: GroundCell) -> f64 {
        let (x_m, y_m) = self.grid.centre_m(cell.index);
        self.height_at_m(cell.layer, x_m, y_m)
    }

    fn height_at_m(&self, layer: usize, x_m: f64, y_m: f64) -> f64 {
        match &self.stairs {
            Some(stairs) if layer == self.storeys as usize => stairs.height_at(x_m, y_m),
            _ => layer as f64 * f64::from(STOREY_CM) / 100.0,
        }
    }

    /// The free cell at a point of the floor; `None` if a walker cannot stand there. `place.z` is the floor's height.
    pub(super) fn cell_at(&self, place: DVec3) -> Option<GroundCell> {
        let index = self.grid.index_at(place.x, place.y)?;
        let cells = (0..self.grid.layer_count())
            .map(|layer| GroundCell { layer, index })
            .filter(|cell| self.grid.is_free(*cell));
        let off_m = |cell: &GroundCell| (self.height_m(*cell) - place.z).abs();
        cells.filter(|cell| off_m(cell) < 0.3).min_by(|a, b| off_m(a).total_cmp(&off_m(b)))
    }

    /// Whether a walker can stand at a point of the floor, metres.
    #[must_use]
    pub fn is_walkable(&self, place: DVec3) -> bool {
        self.cell_at(place).is_some()
    }

    /// The middle of a cell on the ground, metres.
    pub(super) fn middle_of_cell(&self, cell: GroundCell) -> DVec3 {
        let (x_m, y_m) = self.grid.centre_m(cell.index);
        DVec3::new(x_m, y_m, self.height_at_m(cell.layer, x_m, y_m))
    }

    /// All cells on which a walker can stand, layer by layer.
    pub(super) fn free_cells(&self) -> impl Iterator<Item = GroundCell> + '_ {
        let all = (0..self.grid.layer_count())
            .flat_map(|layer| (0..self.grid.len()).map(move |index| GroundCell { layer, index }));
        all.filter(|cell| self.grid.is_free(*cell))
    }

    /// How far each free cell is from the nearest obstacle, in cells along the grid; by layer and index.
    pub(super) fn all_clearances(&self) -> Vec<Vec<u32>> {
        (0..self.grid.layer_count()).map(|layer| self.grid.layer_clearances(layer)).collect()
    }

    /// The storey of a cell, counted from 1, the lowest; on stairs, that of the nearer floor.
    pub(super) fn storey_of_cell(&self, cell: GroundCell) -> u32 {
        let half_m = f64::from(STOREY_CM) / 200.0;
        1 + u32::from(self.height_m(cell) > half_m)
    }
}

/// The layer of a storey: its rooms and passages, without the floor that furniture and open doors take.
fn floor_layer(house: &House, floor: u32) -> GroundLayer {
    let base = floor as i32 * STOREY_CM;
    let is_well = |index: usize| house.stairs.as_ref().is_some_and(|stairs| stairs.room == index);
    let rooms = house.rooms.iter().enumerate().filter(|(index, room)| room.floor == floor && !is_well(*index));
    let mut open: Vec<RectCm> = rooms.map(|(_, room)| room.inner_area().inset(RADIUS_CM)).collect();
    let here = |opening: &&WallOpening| opening.base_cm == base && opening.is_passable();
    let leads_up = |opening: &WallOpening| is_well(opening.room) || opening.beyond.is_some_and(is_well);
    for opening in house.openings.iter().filter(here) {
        match &house.stairs {
            Some(stairs) if leads_up(opening) => open.push(apron_floor(stairs, floor == 0)),
            _ => open.push(passage_floor(opening)),
        }
    }
    let in_way = |piece: &&super::model::FurniturePiece| {
        house.rooms[piece.room].floor == floor
            && !piece.kind.is_flat()
            && !piece.kind.is_slim_on_wall()
            && piece.base_cm < base + HEADROOM_CM
    };
    let furniture = house.furniture.iter().filter(in_way).map(|piece| piece.footprint);
    let leaves = house.openings.iter().filter(here).flat_map(|opening| opening.open_leaf(&house.rooms));
    GroundLayer { open, blocked: furniture.chain(leaves).map(|area| area.inset(-RADIUS_CM)).collect() }
}

/// The floor in and around an opening on which one can stand.
fn passage_floor(opening: &WallOpening) -> RectCm {
    let mut span = opening.span;
    (span.from, span.to) = (span.from + RADIUS_CM, span.to - RADIUS_CM);
    span.thickened_by(HALF_WALL_CM + RADIUS_CM)
}

/// The floor in front of a flight, inside and outside the well's wall.
fn apron_floor(stairs: &HouseStairs, lower: bool) -> RectCm {
    let (from, to) = stairs.flight_across(lower);
    stairs.rect_across(from + RADIUS_CM, to - RADIUS_CM, [-APRON_CM, 0])
}

/// Both flights, the landing, and the floor in front of the flights.
fn stairs_layer(house: &House, stairs: &HouseStairs) -> GroundLayer {
    let end = stairs.depth_cm() - RADIUS_CM;
    let flight = |lower: bool| {
        let (from, to) = stairs.flight_across(lower);
        stairs.rect_across(from + RADIUS_CM, to - RADIUS_CM, [-APRON_CM, end])
    };
    let landing = stairs.rect_across(RADIUS_CM, stairs.width_cm() - RADIUS_CM, [stairs.flight_cm + RADIUS_CM, end]);
    let furniture = house
        .furniture
        .iter()
        .filter(|piece| piece.room == stairs.room && !piece.kind.is_slim_on_wall() && piece.base_cm < STOREY_CM);
    let blocked = furniture.map(|piece| piece.footprint.inset(-RADIUS_CM)).collect();
    GroundLayer { open: vec![flight(true), flight(false), landing], blocked }
}

#[cfg(test)]
mod tests;
