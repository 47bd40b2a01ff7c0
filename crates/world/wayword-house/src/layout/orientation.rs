//! Mirrors and turns a plan, so that houses do not all look the same way.

use super::{
    super::{
        dice::HouseDice,
        rect::{RectCm, WallSide},
    },
    FloorPlan,
};

impl FloorPlan {
    /// Mirrors the plan along x, mirrors it along y, and swaps the axes, each in half of the houses.
    pub(super) fn orient_randomly(&mut self, dice: &mut HouseDice) {
        let (mirror_x, mirror_y, swap) = (dice.chance(50), dice.chance(50), dice.chance(50));
        let x_end = self.rooms.iter().map(|room| room.outline.x1).max().unwrap_or(0);
        let y_end = self.rooms.iter().map(|room| room.outline.y1).max().unwrap_or(0);
        if mirror_x {
            self.transform_plan(
                |r| RectCm::new(x_end - r.x1, r.y0, x_end - r.x0, r.y1),
                |wall| mirror_wall(wall, false),
            );
            self.swap_flights();
        }
        if mirror_y {
            self.transform_plan(
                |r| RectCm::new(r.x0, y_end - r.y1, r.x1, y_end - r.y0),
                |wall| mirror_wall(wall, true),
            );
        }
        if swap {
            self.transform_plan(|r| RectCm::new(r.y0, r.x0, r.y1, r.x1), transpose_wall);
        }
    }

    fn transform_plan(&mut self, rect: impl Fn(RectCm) -> RectCm, wall: impl Fn(WallSide) -> WallSide) {
        for room in &mut self.rooms {
            room.outline = rect(room.outline);
        }
        if let Some(well) = &mut self.well {
            well.entry = wall(well.entry);
        }
    }

    fn swap_flights(&mut self) {
        if let Some(well) = &mut self.well {
            well.lower_flight_low = !well.lower_flight_low;
        }
    }
}

fn mirror_wall(wall: WallSide, north_to_south: bool) -> WallSide {
    if wall.along_x() == north_to_south { wall.opposite() } else { wall }
}

fn transpose_wall(wall: WallSide) -> WallSide {
    match wall {
        WallSide::North => WallSide::East,
        WallSide::East => WallSide::North,
        WallSide::South => WallSide::West,
        WallSide::West => WallSide::South,
    }
}
