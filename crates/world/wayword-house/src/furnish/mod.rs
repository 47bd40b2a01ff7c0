//! Furnishes a house: puts the usual furniture into each kind of room, then closets and radiators, then pictures on the
//! bare walls.
//!
//! The order matters, because each piece takes space from the later ones. Every kind of room has its own file.

mod bathroom;
mod bedroom;
mod built_in;
mod dining;
mod dress;
mod finish;
mod kitchen;
mod living;
mod office;
mod placing;
mod reach;
mod service;
mod stairwell;
mod walls;

use super::{
    catalogue::FurnitureKind,
    colour::Colour,
    dice::Dice,
    layout::Layout,
    model::{Furniture, RoomKind},
};
use placing::Furnisher;

/// Colours that all rooms of a house share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Taste {
    pub(super) wood: Colour,
    pub(super) kitchen: Colour,
    pub(super) curtain: Colour,
}

/// All furniture of a house. Each room has its own random numbers, so that the choices in one room do not change the
/// next.
pub(super) fn furnish(seed: u64, layout: &Layout) -> Vec<Furniture> {
    let mut dice = Dice::new(seed, &["taste"]);
    let taste = Taste {
        wood: finish::of_house(&mut dice),
        kitchen: finish::of_kitchen(&mut dice),
        curtain: dice.pick([Colour::Beige, Colour::Grey, Colour::Blue, Colour::White]),
    };
    let mut pieces = Vec::new();
    for index in 0..layout.rooms.len() {
        let mut room = Furnisher::new(seed, layout, index, taste);
        furnish_room(&mut room, layout.rooms[index].kind);
        built_in::furnish(&mut room, layout.rooms[index].kind);
        match layout.stairs.as_ref().filter(|stairs| stairs.room == index) {
            Some(stairs) => stairwell::furnish(&mut room, stairs),
            None => room.dress_walls(),
        }
        pieces.extend(room.into_pieces());
    }
    for (id, piece) in (layout.next_id..).zip(&mut pieces) {
        piece.id = id;
    }
    pieces
}

fn furnish_room(room: &mut Furnisher<'_>, kind: RoomKind) {
    match kind {
        RoomKind::LivingRoom => living::furnish(room),
        RoomKind::Kitchen => kitchen::furnish(room),
        RoomKind::DiningRoom => dining::furnish(room),
        RoomKind::Bedroom => bedroom::furnish(room),
        RoomKind::Bathroom => bathroom::furnish(room),
        RoomKind::Office => office::furnish(room),
        RoomKind::Hallway => service::hallway(room),
        RoomKind::LaundryRoom => service::laundry(room),
        RoomKind::Entryway => service::entryway(room),
        RoomKind::Closet => service::closet(room),
        RoomKind::Garage => service::garage(room),
        RoomKind::Staircase => {}
    }
    if !matches!(kind, RoomKind::DiningRoom | RoomKind::Staircase) {
        room.on_ceiling(FurnitureKind::CeilingLight);
    }
}

#[cfg(test)]
mod tests;
