//! Furnishes a house: puts the usual furniture into each kind of room, then closets and radiators, then pictures on the
//! bare walls.
//!
//! The order matters, because each piece takes space from the later ones. Every kind of room has its own file.

mod bathroom;
mod bedroom;
mod built_in;
mod dining;
mod finish;
mod kitchen;
mod living;
mod office;
mod placing;
mod reachable_floor;
mod service;
mod stairwell;
mod wall_hangings;
mod walls;

use super::{
    catalogue::FurnitureKind,
    colour::Colour,
    dice::HouseDice,
    layout::HouseLayout,
    model::{FurniturePiece, RoomKind},
};
use placing::RoomFurnisher;

/// Colours that all rooms of a house share.
#[derive(Debug, Clone, Copy)]
pub(super) struct HousePalette {
    pub(super) wood: Colour,
    pub(super) kitchen: Colour,
    pub(super) curtain: Colour,
}

/// All furniture of a house. Each room has its own random numbers, so that the choices in one room do not change the
/// next.
pub(super) fn furnish_house(seed: u64, layout: &HouseLayout) -> Vec<FurniturePiece> {
    let mut dice = HouseDice::new(seed, &["taste"]);
    let taste = HousePalette {
        wood: finish::draw_house_finish(&mut dice),
        kitchen: finish::draw_kitchen_finish(&mut dice),
        curtain: dice.pick([Colour::Beige, Colour::Grey, Colour::Blue, Colour::White]),
    };
    let mut pieces = Vec::new();
    for index in 0..layout.rooms.len() {
        let mut room = RoomFurnisher::new(seed, layout, index, taste);
        furnish_room(&mut room, layout.rooms[index].kind);
        built_in::add_built_ins(&mut room, layout.rooms[index].kind);
        match layout.stairs.as_ref().filter(|stairs| stairs.room == index) {
            Some(stairs) => stairwell::furnish_stairwell(&mut room, stairs),
            None => room.dress_walls(),
        }
        pieces.extend(room.into_pieces());
    }
    for (id, piece) in (layout.next_id..).zip(&mut pieces) {
        piece.id = id;
    }
    pieces
}

fn furnish_room(room: &mut RoomFurnisher<'_>, kind: RoomKind) {
    match kind {
        RoomKind::LivingRoom => living::furnish_living_room(room),
        RoomKind::Kitchen => kitchen::furnish_kitchen(room),
        RoomKind::DiningRoom => dining::furnish_dining_room(room),
        RoomKind::Bedroom => bedroom::furnish_bedroom(room),
        RoomKind::Bathroom => bathroom::furnish_bathroom(room),
        RoomKind::Office => office::furnish_office(room),
        RoomKind::Hallway => service::furnish_hallway(room),
        RoomKind::LaundryRoom => service::furnish_laundry(room),
        RoomKind::Entryway => service::furnish_entryway(room),
        RoomKind::Closet => service::furnish_closet(room),
        RoomKind::Garage => service::furnish_garage(room),
        RoomKind::Staircase => {}
    }
    if !matches!(kind, RoomKind::DiningRoom | RoomKind::Staircase) {
        room.hang_from_ceiling(FurnitureKind::CeilingLight);
    }
}

#[cfg(test)]
mod tests;
