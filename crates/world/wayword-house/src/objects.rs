//! The table of a house's objects by the numbers that its pictures carry in each pixel.

use super::{
    model::{House, WallOpening},
    rect::RectCm,
};
use std::collections::BTreeMap;
use wayword_core::DVec3;

/// The object that a number in a picture means.
#[derive(Debug, Clone, PartialEq)]
pub struct NumberedObject {
    /// Its name in plain words.
    pub name: String,
    /// Word for its main colour.
    pub colour: Option<&'static str>,
    /// Lower and upper corner of its box, metres, world frame.
    pub bounds_m: (DVec3, DVec3),
    /// The room it is in.
    pub room: usize,
    /// What kind of part of the house it is.
    pub role: ObjectRole,
}

/// What kind of part of a house an object is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObjectRole {
    /// A floor, a wall or a ceiling. Every room has them, so they get no label.
    Shell,
    /// Doors, windows, stairs.
    Fixture,
    /// Things that could be carried in or out.
    Furniture,
}

impl NumberedObject {
    /// The middle of its box, metres, world frame.
    #[must_use]
    pub fn centre_m(&self) -> DVec3 {
        (self.bounds_m.0 + self.bounds_m.1) / 2.0
    }
}

/// The parts of a room's shell, in the order of their numbers.
pub(super) const SHELL_PART_NAMES: [&str; 3] = ["floor", "wall", "ceiling"];

/// The number of a part of a room's shell: above the numbers of all other objects.
pub(super) fn shell_id(house: &House, room: usize, part: usize) -> u32 {
    let furniture = house.furniture.iter().map(|piece| piece.id).max().unwrap_or(0);
    let last = furniture.max(house.openings.iter().map(|opening| opening.id).max().unwrap_or(0));
    last + 1 + (room * SHELL_PART_NAMES.len() + part) as u32
}

fn box_bounds(area: &RectCm, low_cm: i32, high_cm: i32) -> (DVec3, DVec3) {
    let corner = |x: i32, y: i32, z: i32| DVec3::new(f64::from(x), f64::from(y), f64::from(z)) / 100.0;
    (corner(area.x0, area.y0, low_cm), corner(area.x1, area.y1, high_cm))
}

fn opening_object(each: &WallOpening) -> NumberedObject {
    let colour = (each.word() != "doorway").then(|| each.colour.word());
    let area = each.span.thickened_by(super::model::HALF_WALL_CM);
    let bounds_m = box_bounds(&area, each.base_cm, each.base_cm + each.height_cm);
    NumberedObject { name: each.word().to_owned(), colour, bounds_m, room: each.room, role: ObjectRole::Fixture }
}

/// All objects by their numbers.
pub(super) fn objects_by_id(house: &House) -> BTreeMap<u32, NumberedObject> {
    let mut all = BTreeMap::new();
    for (index, room) in house.rooms.iter().enumerate() {
        for (part, name) in SHELL_PART_NAMES.iter().enumerate() {
            let bounds_m = box_bounds(&room.outline, room.base_cm(), room.base_cm() + room.height_cm);
            let shell = NumberedObject {
                name: (*name).to_owned(),
                colour: None,
                bounds_m,
                room: index,
                role: ObjectRole::Shell,
            };
            all.insert(shell_id(house, index, part), shell);
        }
    }
    all.extend(house.openings.iter().map(|each| (each.id, opening_object(each))));
    for window in &house.windows {
        let bounds_m =
            box_bounds(&window.span.thickened_by(super::model::HALF_WALL_CM), window.sill_cm, window.head_cm);
        let object = NumberedObject {
            name: "window".to_owned(),
            colour: None,
            bounds_m,
            room: window.room,
            role: ObjectRole::Fixture,
        };
        all.insert(window.id, object);
    }
    if let Some(stairs) = &house.stairs {
        let bounds_m = box_bounds(&stairs.well, 0, super::model::STOREY_CM);
        for (id, name) in [(stairs.id, "stairs"), (stairs.railing_id, "railing")] {
            let object = NumberedObject {
                name: name.to_owned(),
                colour: None,
                bounds_m,
                room: stairs.room,
                role: ObjectRole::Fixture,
            };
            all.insert(id, object);
        }
    }
    for piece in &house.furniture {
        let bounds_m = box_bounds(&piece.footprint, piece.base_cm, piece.base_cm + piece.height_cm);
        let colour = piece.kind.has_one_colour().then(|| piece.colour.word());
        let object = NumberedObject {
            name: piece.name.clone(),
            colour,
            bounds_m,
            room: piece.room,
            role: ObjectRole::Furniture,
        };
        all.insert(piece.id, object);
    }
    all
}
