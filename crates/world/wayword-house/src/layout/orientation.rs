//! Mirrors and turns a plan, so that houses do not all look the same way.

use super::{
    super::{
        dice::Dice,
        rect::{RectCm, Wall},
    },
    Plan,
};

impl Plan {
    /// Mirrors the plan along x, mirrors it along y, and swaps the axes, each in half of the houses.
    pub(super) fn orient(&mut self, dice: &mut Dice) {
        let (mirror_x, mirror_y, swap) = (dice.chance(50), dice.chance(50), dice.chance(50));
        let x_end = self.rooms.iter().map(|room| room.outline.x1).max().unwrap_or(0);
        let y_end = self.rooms.iter().map(|room| room.outline.y1).max().unwrap_or(0);
        if mirror_x {
            self.map(|r| RectCm::new(x_end - r.x1, r.y0, x_end - r.x0, r.y1), |wall| mirrored(wall, false));
            self.swap_flights();
        }
        if mirror_y {
            self.map(|r| RectCm::new(r.x0, y_end - r.y1, r.x1, y_end - r.y0), |wall| mirrored(wall, true));
        }
        if swap {
            self.map(|r| RectCm::new(r.y0, r.x0, r.y1, r.x1), transposed);
        }
    }

    fn map(&mut self, rect: impl Fn(RectCm) -> RectCm, wall: impl Fn(Wall) -> Wall) {
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

fn mirrored(wall: Wall, north_to_south: bool) -> Wall {
    if wall.along_x() == north_to_south { wall.opposite() } else { wall }
}

fn transposed(wall: Wall) -> Wall {
    match wall {
        Wall::North => Wall::East,
        Wall::East => Wall::North,
        Wall::South => Wall::West,
        Wall::West => Wall::South,
    }
}
