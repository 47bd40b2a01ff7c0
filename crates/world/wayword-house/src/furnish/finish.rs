//! Chooses the finish of wooden furniture: one for the house, another in some of its rooms, and a different one for a few
//! pieces.

use super::super::{catalogue::FurnitureKind as K, colour::Colour, dice::HouseDice, model::RoomKind};

/// Finishes of wood, as people name them.
const WOOD_FINISHES: [Colour; 10] = [
    Colour::White,
    Colour::Wooden,
    Colour::Brown,
    Colour::Black,
    Colour::Grey,
    Colour::Red,
    Colour::Blue,
    Colour::Green,
    Colour::Wooden,
    Colour::Cream,
];
/// Finishes of kitchen fronts.
const KITCHEN_FRONT_FINISHES: [Colour; 8] = [
    Colour::White,
    Colour::Grey,
    Colour::Blue,
    Colour::Green,
    Colour::Wooden,
    Colour::Cream,
    Colour::Black,
    Colour::White,
];

/// The finishes of the furniture in one room.
#[derive(Debug)]
pub(super) struct RoomFinishes {
    /// The finish of most pieces.
    pub(super) main: Colour,
    /// The finish of the few pieces that differ.
    accent: Colour,
    dice: HouseDice,
}

/// The finish that most rooms of a house share.
pub(super) fn draw_house_finish(dice: &mut HouseDice) -> Colour {
    dice.pick(WOOD_FINISHES)
}

/// The finish of a house's kitchen fronts.
pub(super) fn draw_kitchen_finish(dice: &mut HouseDice) -> Colour {
    dice.pick(KITCHEN_FRONT_FINISHES)
}

impl RoomFinishes {
    /// The finishes of a room. They have their own random numbers, so that they change no other choice.
    pub(super) fn for_room(seed: u64, index: usize, kind: RoomKind, house: Colour) -> Self {
        let mut dice = HouseDice::new(seed, &["finish", &index.to_string()]);
        // The rooms where guests are match; bedrooms and offices are furnished one by one.
        let own_finish_percent =
            if matches!(kind, RoomKind::Bedroom | RoomKind::Office | RoomKind::Entryway) { 60 } else { 30 };
        let main = if dice.chance(own_finish_percent) { dice.pick(WOOD_FINISHES) } else { house };
        let accent = dice.pick(WOOD_FINISHES);
        Self { main, accent, dice }
    }

    /// The finish of the next wooden piece: mostly the room's own, now and then another one.
    pub(super) fn draw_finish(&mut self, kind: K) -> Colour {
        let can_be_glass = matches!(kind, K::CoffeeTable | K::SideTable | K::ConsoleTable | K::DiningTable);
        if can_be_glass && self.dice.chance(45) {
            Colour::Glass
        } else if self.dice.chance(30) {
            self.accent
        } else {
            self.main
        }
    }
}
