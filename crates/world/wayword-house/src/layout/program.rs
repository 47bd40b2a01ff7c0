//! The rules of the floor plan: which rooms a storey has, how they are joined, and which colours and floors they get.

use super::{
    super::{
        colour::Colour,
        dice::HouseDice,
        model::{FloorFinish, RoomKind},
    },
    RoomPassage,
};
use RoomKind as R;

/// The rooms of a storey.
pub(super) struct StoreyProgram {
    /// The larger room of the block at the hallway's end.
    pub(super) block_main: RoomKind,
    /// The smaller room next to it.
    pub(super) block_side: RoomKind,
    /// The passage between hallway and block.
    pub(super) into_main: RoomPassage,
    /// The passage between the block's two rooms.
    pub(super) into_side: RoomPassage,
    /// Rooms of the strips, from the block outwards: first these in order, then some of the `more` ones that fit.
    pub(super) south_first: &'static [RoomKind],
    pub(super) south_more: &'static [RoomKind],
    pub(super) north_first: &'static [RoomKind],
    pub(super) north_more: &'static [RoomKind],
    /// In how many houses of a hundred there is a garage.
    pub(super) garage_chance: i32,
    /// Whether stairs begin here.
    pub(super) upstairs: StairsAbove,
}

/// Whether stairs lead up from a storey.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StairsAbove {
    /// The stairwell begins on this storey.
    Above,
    /// This storey adds no stairwell.
    None,
}

impl StoreyProgram {
    pub(super) fn ground_storey(storeys: u32) -> Self {
        let two = storeys == 2;
        Self {
            block_main: R::LivingRoom,
            block_side: R::Kitchen,
            into_main: RoomPassage::Doorway { width_cm: 100 },
            into_side: RoomPassage::Doorway { width_cm: 180 },
            south_first: if two { &[R::Entryway] } else { &[R::Entryway, R::Bedroom] },
            south_more: if two {
                &[R::Office, R::Closet, R::LaundryRoom, R::Bedroom]
            } else {
                &[R::Closet, R::Office, R::Bedroom]
            },
            north_first: if two { &[R::DiningRoom, R::Bathroom] } else { &[R::DiningRoom, R::Bathroom, R::Bedroom] },
            north_more: if two { &[R::LaundryRoom, R::Office] } else { &[R::LaundryRoom, R::Bathroom, R::Office] },
            garage_chance: 30,
            upstairs: if two { StairsAbove::Above } else { StairsAbove::None },
        }
    }

    pub(super) fn upper_storey() -> Self {
        Self {
            block_main: R::Bedroom,
            block_side: R::Bathroom,
            into_main: RoomPassage::Door,
            into_side: RoomPassage::Door,
            south_first: &[R::Bedroom],
            south_more: &[R::Bedroom, R::Closet, R::Office],
            north_first: &[R::Office, R::Bathroom],
            north_more: &[R::Bedroom, R::LaundryRoom, R::Closet],
            garage_chance: 0,
            upstairs: StairsAbove::None,
        }
    }
}

/// Smallest and largest usual width of a room in a strip, centimetres.
pub(super) fn usual_widths(kind: RoomKind) -> (i32, i32) {
    match kind {
        R::Bathroom => (190, 270),
        R::LaundryRoom => (180, 230),
        R::Closet => (140, 180),
        R::Entryway => (190, 250),
        R::Office => (260, 350),
        R::Bedroom => (310, 430),
        R::DiningRoom => (300, 400),
        _ => (300, 450),
    }
}

/// What a room of a strip is joined to.
pub(super) enum RoomJoin {
    /// To the hallway alone.
    Hall(RoomPassage),
    /// To the neighbour towards the block alone.
    Neighbour(RoomPassage),
    /// To the hallway, by the first passage, and to the neighbour, by the second.
    Both(RoomPassage, RoomPassage),
}

/// How a room of a strip is joined, given what lies between it and the block.
pub(super) fn join_room(dice: &mut HouseDice, kind: RoomKind, neighbour: Option<RoomKind>) -> RoomJoin {
    match (kind, neighbour) {
        (R::DiningRoom, Some(R::Kitchen)) => {
            RoomJoin::Both(RoomPassage::Doorway { width_cm: 110 }, RoomPassage::Doorway { width_cm: 140 })
        }
        (R::Entryway, Some(R::LivingRoom)) => {
            RoomJoin::Both(RoomPassage::Doorway { width_cm: 110 }, RoomPassage::Doorway { width_cm: 130 })
        }
        (R::Entryway | R::DiningRoom, _) => RoomJoin::Hall(RoomPassage::Doorway { width_cm: 110 }),
        (R::Closet, Some(R::Bedroom)) if dice.chance(60) => RoomJoin::Neighbour(RoomPassage::Door),
        (R::Bathroom, Some(R::Bedroom)) if dice.chance(30) => RoomJoin::Both(RoomPassage::Door, RoomPassage::Door),
        _ => RoomJoin::Hall(RoomPassage::Door),
    }
}

/// The colours and finishes of one house.
pub(super) struct FinishScheme {
    walls: Colour,
    hall: Colour,
    kitchen: Colour,
    planks: Colour,
    tiles: Colour,
    carpet: Colour,
    carpeted_bedrooms: bool,
}

impl FinishScheme {
    pub(super) fn draw_scheme(dice: &mut HouseDice) -> Self {
        Self {
            walls: dice.pick([Colour::White, Colour::Cream, Colour::Beige, Colour::LightGreen]),
            hall: dice.pick([Colour::White, Colour::Cream, Colour::Beige]),
            kitchen: dice.pick([Colour::White, Colour::Cream, Colour::LightBlue, Colour::LightGreen]),
            planks: dice.pick([Colour::LightBrown, Colour::Brown, Colour::Beige, Colour::Grey]),
            tiles: dice.pick([Colour::White, Colour::Grey, Colour::Beige]),
            carpet: dice.pick([Colour::Beige, Colour::Grey, Colour::Cream]),
            carpeted_bedrooms: dice.chance(50),
        }
    }

    /// The wall colour, the floor finish and the floor colour of a room.
    pub(super) fn for_room(&self, dice: &mut HouseDice, kind: RoomKind) -> (Colour, FloorFinish, Colour) {
        let planks = (FloorFinish::Planks, self.planks);
        let ((finish, colour), walls) = match kind {
            R::Bathroom | R::LaundryRoom => {
                ((FloorFinish::Tiles, self.tiles), dice.pick([Colour::White, Colour::LightBlue, Colour::LightGreen]))
            }
            R::Kitchen | R::Entryway => {
                let walls = if kind == R::Kitchen { self.kitchen } else { self.hall };
                (if dice.chance(60) { (FloorFinish::Tiles, self.tiles) } else { planks }, walls)
            }
            R::Hallway | R::Staircase => (planks, self.hall),
            R::Garage => ((FloorFinish::Concrete, Colour::Grey), Colour::White),
            R::Bedroom => {
                let walls = dice.pick([
                    self.walls,
                    Colour::LightBlue,
                    Colour::Cream,
                    Colour::Pink,
                    Colour::Beige,
                    Colour::LightGreen,
                ]);
                (if self.carpeted_bedrooms { (FloorFinish::Carpet, self.carpet) } else { planks }, walls)
            }
            R::Office | R::DiningRoom => {
                (planks, dice.pick([self.walls, Colour::Beige, Colour::Cream, Colour::LightGreen]))
            }
            _ => (planks, self.walls),
        };
        (walls, finish, colour)
    }
}
