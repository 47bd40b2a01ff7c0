//! Makes the floor plan of a house: which rooms there are, where they lie, and which are joined.
//!
//! Every plan follows one scheme. A hallway runs between two strips of rooms; at one end a block of two rooms fills the
//! house's whole depth. Houses of two storeys have the same stairwell on both. At the end the whole plan is mirrored or
//! turned, so that houses do not look alike.

mod door_angles;
mod openings;
mod orientation;
mod program;
mod strip;
mod windows;

use super::{
    dice::HouseDice,
    model::{CEILING_CM, HouseRoom, HouseStairs, HouseWindow, RoomKind, STOREY_CM},
    rect::{RectCm, WallSide},
};
use program::{StairsAbove, StoreyProgram};

pub(super) use openings::floor_before_opening;

/// The rooms and the links between them, before walls and openings are made.
#[derive(Debug, Default)]
struct FloorPlan {
    rooms: Vec<PlannedRoom>,
    links: Vec<RoomLink>,
    /// The stairwell of a house with two storeys.
    well: Option<PlannedStairwell>,
}

/// A room of the plan, before it has colours and finishes.
#[derive(Debug, Clone, Copy)]
struct PlannedRoom {
    kind: RoomKind,
    floor: u32,
    outline: RectCm,
}

/// Two joined rooms; `beyond` is `None` where the link leads outside.
#[derive(Debug, Clone, Copy)]
struct RoomLink {
    room: usize,
    beyond: Option<usize>,
    how: RoomPassage,
}

/// The kind of opening that joins two rooms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RoomPassage {
    Door,
    Doorway {
        width_cm: i32,
    },
    FrontDoor,
    GarageDoor,
    /// One half of the stairwell's open side, on that storey.
    Flight {
        floor: u32,
    },
}

/// Where the stairs are, and which way they run.
#[derive(Debug, Clone, Copy)]
struct PlannedStairwell {
    room: usize,
    /// The side at which both flights begin and end.
    entry: WallSide,
    /// Whether the lower flight fills the half with the lower coordinates.
    lower_flight_low: bool,
}

/// The outer dimensions that both storeys share, centimetres.
#[derive(Debug, Clone, Copy)]
struct OuterDimensions {
    /// West to east, with the block.
    width: i32,
    /// Width of the block at the western end.
    block: i32,
    /// Depth of the southern strip of rooms.
    south: i32,
    /// Depth of the hallway.
    hall: i32,
    /// Depth of the northern strip of rooms.
    north: i32,
    /// West and east edge of the stairwell in the northern strip.
    well: Option<(i32, i32)>,
}

/// Everything of a house but its furniture.
pub(super) struct HouseLayout {
    pub(super) storeys: u32,
    pub(super) rooms: Vec<HouseRoom>,
    pub(super) openings: Vec<super::model::WallOpening>,
    pub(super) windows: Vec<HouseWindow>,
    pub(super) stairs: Option<HouseStairs>,
    /// The first number that no object has yet.
    pub(super) next_id: u32,
}

/// Makes the plan of a house.
pub(super) fn lay_out(seed: u64) -> HouseLayout {
    let mut dice = HouseDice::new(seed, &["layout"]);
    let storeys = if dice.chance(50) { 2 } else { 1 };
    let shell = draw_dimensions(&mut dice, storeys);
    let mut plan = FloorPlan::default();
    plan.add_storey(&mut dice, &shell, 0, &StoreyProgram::ground_storey(storeys));
    if storeys == 2 {
        plan.add_storey(&mut dice, &shell, 1, &StoreyProgram::upper_storey());
    }
    plan.orient_randomly(&mut dice);
    let rooms = finish_rooms(&mut dice, &plan);
    let mut ids = ObjectIdCounter(1);
    let mut openings = openings::cut_openings(&mut dice, &plan, &rooms, &mut ids);
    door_angles::set_door_angles(seed, &rooms, &mut openings);
    let windows = windows::cut_windows(&plan, &rooms, &openings, &mut ids);
    let stairs = plan.place_stairs(&rooms, &mut ids);
    HouseLayout { storeys, rooms, openings, windows, stairs, next_id: ids.next_id() }
}

/// Gives each object the next free number.
struct ObjectIdCounter(u32);

impl ObjectIdCounter {
    fn next_id(&mut self) -> u32 {
        self.0 += 1;
        self.0 - 1
    }
}

/// Draws the outer dimensions of a house.
fn draw_dimensions(dice: &mut HouseDice, storeys: u32) -> OuterDimensions {
    let block = dice.draw_stepped(430, 540, 10);
    let (south, hall, north) =
        (dice.draw_stepped(370, 430, 10), dice.draw_stepped(160, 200, 10), dice.draw_stepped(350, 410, 10));
    let width = if storeys == 2 { block + dice.draw_stepped(800, 920, 10) } else { dice.draw_stepped(1240, 1520, 10) };
    let well = (storeys == 2).then(|| {
        let from = if dice.chance(50) { block } else { block + dice.draw_stepped(300, 360, 10) };
        // The width of the stairwell between the middle lines of its walls.
        (from, from + 232)
    });
    OuterDimensions { width, block, south, hall, north, well }
}

impl FloorPlan {
    fn add_room(&mut self, kind: RoomKind, floor: u32, outline: RectCm) -> usize {
        self.rooms.push(PlannedRoom { kind, floor, outline });
        self.rooms.len() - 1
    }

    fn link_rooms(&mut self, room: usize, beyond: usize, how: RoomPassage) {
        self.links.push(RoomLink { room, beyond: Some(beyond), how });
    }

    /// Adds the rooms of a storey: hallway, block, both strips and perhaps a garage.
    fn add_storey(&mut self, dice: &mut HouseDice, shell: &OuterDimensions, floor: u32, program: &StoreyProgram) {
        let (south, hall_top) = (shell.south, shell.south + shell.hall);
        let top = hall_top + shell.north;
        let hall = self.add_room(RoomKind::Hallway, floor, RectCm::new(shell.block, south, shell.width, hall_top));
        let main = self.add_room(program.block_main, floor, RectCm::new(0, 0, shell.block, hall_top));
        let side = self.add_room(program.block_side, floor, RectCm::new(0, hall_top, shell.block, top));
        self.link_rooms(hall, main, program.into_main);
        self.link_rooms(main, side, program.into_side);
        self.add_south(dice, shell, floor, program, hall, main);
        self.add_north(dice, shell, floor, program, hall, side);
        if program.garage_chance > 0 && dice.chance(program.garage_chance) {
            let outline = RectCm::new(shell.width, 0, shell.width + dice.draw_stepped(360, 420, 10), hall_top);
            let garage = self.add_room(RoomKind::Garage, floor, outline);
            self.link_rooms(hall, garage, RoomPassage::Door);
            self.links.push(RoomLink { room: garage, beyond: None, how: RoomPassage::GarageDoor });
        }
    }

    /// Adds the strip of rooms south of the hallway.
    fn add_south(
        &mut self,
        dice: &mut HouseDice,
        shell: &OuterDimensions,
        floor: u32,
        program: &StoreyProgram,
        hall: usize,
        main: usize,
    ) {
        let strip = strip::fill_strip(dice, (shell.block, shell.width), program.south_first, program.south_more);
        let cell = |(kind, from, to)| (kind, RectCm::new(from, 0, to, shell.south));
        let cells = strip.into_iter().map(cell).collect::<Vec<_>>();
        self.add_cells(dice, floor, &cells, hall, Some(main));
    }

    /// Adds the strip of rooms north of the hallway, around the stairwell if there is one.
    fn add_north(
        &mut self,
        dice: &mut HouseDice,
        shell: &OuterDimensions,
        floor: u32,
        program: &StoreyProgram,
        hall: usize,
        side: usize,
    ) {
        let (bottom, top) = (shell.south + shell.hall, shell.south + shell.hall + shell.north);
        let cell = |(kind, from, to)| (kind, RectCm::new(from, bottom, to, top));
        let Some((well_from, well_to)) = shell.well else {
            let cells = strip::fill_strip(dice, (shell.block, shell.width), program.north_first, program.north_more);
            let cells = cells.into_iter().map(cell).collect::<Vec<_>>();
            return self.add_cells(dice, floor, &cells, hall, Some(side));
        };
        let mut after = program.north_first;
        if well_from > shell.block {
            let (first, rest) = after.split_at(after.len().min(1));
            let kind = first.first().copied().unwrap_or(RoomKind::Office);
            self.add_cells(dice, floor, &[cell((kind, shell.block, well_from))], hall, Some(side));
            after = rest;
        }
        self.add_well(dice, floor, cell((RoomKind::Staircase, well_from, well_to)).1, hall, program.upstairs);
        let cells = strip::fill_strip(dice, (well_to, shell.width), after, program.north_more);
        let cells = cells.into_iter().map(cell).collect::<Vec<_>>();
        self.add_cells(dice, floor, &cells, hall, None);
    }

    /// Adds the stairwell if it does not exist yet, and links it with the hallway of this storey.
    fn add_well(&mut self, dice: &mut HouseDice, floor: u32, outline: RectCm, hall: usize, upstairs: StairsAbove) {
        let how = RoomPassage::Flight { floor };
        match (upstairs, self.well) {
            (StairsAbove::Above, None) => {
                let room = self.add_room(RoomKind::Staircase, floor, outline);
                self.well = Some(PlannedStairwell { room, entry: WallSide::South, lower_flight_low: dice.chance(50) });
                self.link_rooms(hall, room, how);
            }
            (_, Some(well)) => self.link_rooms(hall, well.room, how),
            (StairsAbove::None, None) => {}
        }
    }

    /// Adds the rooms of a strip, from the block outwards, and joins them to the hallway and to one another.
    fn add_cells(
        &mut self,
        dice: &mut HouseDice,
        floor: u32,
        cells: &[(RoomKind, RectCm)],
        hall: usize,
        block: Option<usize>,
    ) {
        let mut before = block;
        for (kind, outline) in cells {
            let room = self.add_room(*kind, floor, *outline);
            let neighbour = before.map(|index| (index, self.rooms[index].kind));
            match program::join_room(dice, *kind, neighbour.map(|(_, kind)| kind)) {
                program::RoomJoin::Hall(how) => self.link_rooms(hall, room, how),
                program::RoomJoin::Neighbour(how) => {
                    self.link_rooms(neighbour.map_or(hall, |(index, _)| index), room, how);
                }
                program::RoomJoin::Both(hall_how, how) => {
                    self.link_rooms(hall, room, hall_how);
                    if let Some((index, _)) = neighbour {
                        self.link_rooms(index, room, how);
                    }
                }
            }
            if *kind == RoomKind::Entryway {
                self.links.push(RoomLink { room, beyond: None, how: RoomPassage::FrontDoor });
            }
            before = Some(room);
        }
    }

    fn place_stairs(&self, rooms: &[HouseRoom], ids: &mut ObjectIdCounter) -> Option<HouseStairs> {
        let well = self.well?;
        let inner = rooms[well.room].inner_area();
        let (id, railing_id) = (ids.next_id(), ids.next_id());
        let lower_flight_low = well.lower_flight_low;
        Some(HouseStairs {
            id,
            railing_id,
            room: well.room,
            well: inner,
            entry: well.entry,
            lower_flight_low,
            flight_cm: 210,
        })
    }
}

/// Gives the rooms of a plan their colours, floors and heights.
fn finish_rooms(dice: &mut HouseDice, plan: &FloorPlan) -> Vec<HouseRoom> {
    let scheme = program::FinishScheme::draw_scheme(dice);
    plan.rooms
        .iter()
        .map(|planned| {
            let (wall_colour, floor_finish, floor_colour) = scheme.for_room(dice, planned.kind);
            let height_cm = CEILING_CM + if planned.kind == RoomKind::Staircase { STOREY_CM } else { 0 };
            let PlannedRoom { kind, floor, outline } = *planned;
            HouseRoom { kind, floor, outline, height_cm, wall_colour, floor_finish, floor_colour }
        })
        .collect()
}

#[cfg(test)]
mod tests;
