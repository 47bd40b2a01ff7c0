//! The data model of a house: rooms, openings, windows, stairs and furniture. Everything else is computed from it.

use super::{
    catalogue::FurnitureKind,
    colour::Colour,
    rect::{RectCm, SpanCm, WallSide},
};
use serde::{Deserialize, Serialize};

/// From one floor to the next, centimetres.
pub const STOREY_CM: i32 = 300;
/// From floor to ceiling, centimetres.
pub const CEILING_CM: i32 = 270;
/// Half the thickness of every wall, centimetres: rooms are this much smaller than their outline on each side.
pub const HALF_WALL_CM: i32 = 6;

/// Thickness of a door's leaf, centimetres.
pub const LEAF_CM: i32 = 4;

/// A home: rooms joined by openings, and the furniture in them. World frame; the ground floor lies at z = 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct House {
    /// The seed it was made from.
    pub seed: u64,
    /// How many storeys it has: one or two.
    pub storeys: u32,
    /// All rooms, those of the ground floor first.
    pub rooms: Vec<HouseRoom>,
    /// Doors and doorways.
    pub openings: Vec<WallOpening>,
    /// Windows.
    pub windows: Vec<HouseWindow>,
    /// The stairs, in houses with two storeys.
    pub stairs: Option<HouseStairs>,
    /// All furniture, also what lies on floors or hangs on walls.
    pub furniture: Vec<FurniturePiece>,
}

/// What a room is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "each is the room of that name")]
pub enum RoomKind {
    LivingRoom,
    Kitchen,
    DiningRoom,
    Bedroom,
    Bathroom,
    Office,
    Hallway,
    LaundryRoom,
    Entryway,
    Closet,
    Garage,
    Staircase,
}

/// A room: a rectangle of floor with walls around it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HouseRoom {
    /// What it is for.
    pub kind: RoomKind,
    /// The storey on which it lies, 0 at the ground; a staircase belongs to the lower storey.
    pub floor: u32,
    /// Middle lines of its walls.
    pub outline: RectCm,
    /// From its floor to its ceiling, centimetres.
    pub height_cm: i32,
    /// Colour of the walls.
    pub wall_colour: Colour,
    /// What its floor is made of.
    pub floor_finish: FloorFinish,
    /// Colour of its floor.
    pub floor_colour: Colour,
}

/// What a floor is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FloorFinish {
    /// Wooden boards.
    Planks,
    /// Square tiles.
    Tiles,
    /// Wall-to-wall carpet.
    Carpet,
    /// Bare concrete.
    Concrete,
}

/// A hole in a wall through which one walks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WallOpening {
    /// Its number among all objects of the house.
    pub id: u32,
    /// The room it belongs to.
    pub room: usize,
    /// The room beyond; `None` for the front door and the garage door.
    pub beyond: Option<usize>,
    /// Where it lies on the shared middle line of the walls.
    pub span: SpanCm,
    /// Height of its sill above z = 0, centimetres.
    pub base_cm: i32,
    /// Clear height, centimetres.
    pub height_cm: i32,
    /// What closes it.
    pub leaf: DoorLeaf,
    /// Colour of the leaf.
    pub colour: Colour,
}

/// What closes an opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DoorLeaf {
    /// No leaf: a doorway.
    None,
    /// A door that is open into a room, hinged at the span's lower or upper end.
    Open {
        /// Index of the room it opens into.
        into: usize,
        /// Whether it hangs at the lower end.
        hinge_low: bool,
        /// Angle between the leaf and its wall, degrees: 0 would be closed.
        angle_deg: i32,
    },
    /// A closed house door.
    Closed,
    /// A closed garage door.
    Garage,
}

/// A window in an outer wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HouseWindow {
    /// Its number among all objects of the house.
    pub id: u32,
    /// The room it lights.
    pub room: usize,
    /// Where it lies on the wall's middle line.
    pub span: SpanCm,
    /// The lower edge above z = 0, centimetres.
    pub sill_cm: i32,
    /// The upper edge above z = 0, centimetres.
    pub head_cm: i32,
}

/// Two flights with a landing between them: up along one half, back along the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HouseStairs {
    /// Its number among all objects of the house.
    pub id: u32,
    /// Number of its handrail.
    pub railing_id: u32,
    /// The room of kind staircase.
    pub room: usize,
    /// Inner edges of its walls.
    pub well: RectCm,
    /// The side of the well at which both flights begin and end.
    pub entry: WallSide,
    /// Whether the lower flight fills the half with the lower coordinates.
    pub lower_flight_low: bool,
    /// Depth of one flight from the entry to the landing, centimetres.
    pub flight_cm: i32,
}

/// A piece of furniture or decoration: on the floor, on a wall, on the ceiling or on another piece.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FurniturePiece {
    /// Its number among all objects of the house.
    pub id: u32,
    /// What it is.
    pub kind: FurnitureKind,
    /// Its name in plain words.
    pub name: String,
    /// Its main colour.
    pub colour: Colour,
    /// What it is mainly made of.
    pub material: String,
    /// The room it is in.
    pub room: usize,
    /// Its footprint.
    pub footprint: RectCm,
    /// Its lower edge above z = 0, centimetres.
    pub base_cm: i32,
    /// Its height, centimetres.
    pub height_cm: i32,
    /// Quarter turns counter-clockwise; at 0 its front looks south.
    pub quarter_turns: u8,
    /// Seed of the variations in its look.
    pub variant: u32,
}

impl RoomKind {
    /// Its name in plain words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::LivingRoom => "living room",
            Self::Kitchen => "kitchen",
            Self::DiningRoom => "dining room",
            Self::Bedroom => "bedroom",
            Self::Bathroom => "bathroom",
            Self::Office => "office",
            Self::Hallway => "hallway",
            Self::LaundryRoom => "laundry room",
            Self::Entryway => "entryway",
            Self::Closet => "closet",
            Self::Garage => "garage",
            Self::Staircase => "staircase",
        }
    }
}

impl HouseRoom {
    /// Its floor's height, centimetres.
    #[must_use]
    pub fn base_cm(&self) -> i32 {
        self.floor as i32 * STOREY_CM
    }

    /// The area between its walls.
    #[must_use]
    pub fn inner_area(&self) -> RectCm {
        self.outline.inset(HALF_WALL_CM)
    }
}

impl WallOpening {
    /// Whether one can walk through.
    #[must_use]
    pub fn is_passable(&self) -> bool {
        matches!(self.leaf, DoorLeaf::None | DoorLeaf::Open { .. })
    }

    /// Its name in plain words.
    #[must_use]
    pub fn word(&self) -> &'static str {
        match self.leaf {
            DoorLeaf::None => "doorway",
            DoorLeaf::Open { .. } => "door",
            DoorLeaf::Closed => "front door",
            DoorLeaf::Garage => "garage door",
        }
    }
}

impl House {
    /// The room in which a point lies, given the height of the floor under it (metres). A staircase counts on both
    /// storeys.
    #[must_use]
    pub fn room_at(&self, x_m: f64, y_m: f64, floor_z_m: f64) -> Option<&HouseRoom> {
        let holds = |room: &&HouseRoom| {
            let above_cm = floor_z_m * 100.0 - f64::from(room.base_cm());
            room.outline.holds_m(x_m, y_m) && (-20.0..f64::from(room.height_cm - 20)).contains(&above_cm)
        };
        self.rooms.iter().find(holds)
    }
}
