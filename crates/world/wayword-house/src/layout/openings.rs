//! Cuts a door or a doorway into the wall between any two rooms that the plan links.

use super::super::{
    colour::Colour,
    dice::HouseDice,
    model::{DoorLeaf, HALF_WALL_CM, HouseRoom, RoomKind, STOREY_CM, WallOpening},
    rect::{RectCm, SpanCm, WallSide},
};
use super::{FloorPlan, ObjectIdCounter, PlannedStairwell, RoomLink, RoomPassage};

/// Usual width of a door, centimetres.
const DOOR_CM: i32 = 90;
/// Least width of a door or doorway, centimetres; a shorter stretch of wall gets none.
const MIN_OPENING_CM: i32 = 75;
/// Clear height of an opening with a leaf, centimetres.
const DOOR_HEIGHT_CM: i32 = 205;
/// Clear height of an opening without a leaf, centimetres.
const DOORWAY_HEIGHT_CM: i32 = 220;
/// Least length of wall between an opening and the corner, centimetres: half the crossing wall, and the frame.
const MIN_CORNER_WALL_CM: i32 = 16;

/// The openings for all links of a plan. Doors get their places after all other openings.
pub(super) fn cut_openings(
    dice: &mut HouseDice,
    plan: &FloorPlan,
    rooms: &[HouseRoom],
    ids: &mut ObjectIdCounter,
) -> Vec<WallOpening> {
    let colour = dice.pick([Colour::White, Colour::White, Colour::Wooden, Colour::Brown, Colour::Grey]);
    let front = dice.pick([Colour::Red, Colour::Blue, Colour::Green, Colour::Brown, Colour::Black]);
    let mut openings = Vec::new();
    // Doorways first: they have only one good place, but doors can be moved.
    let (doors, others): (Vec<RoomLink>, Vec<RoomLink>) =
        plan.links.iter().partition(|link| link.how == RoomPassage::Door);
    for link in others.iter().chain(&doors) {
        let Some(mut opening) = place_opening(dice, plan, rooms, link, &openings) else {
            continue;
        };
        opening.colour = if opening.leaf == DoorLeaf::Closed { front } else { colour };
        opening.id = ids.next_id();
        openings.push(opening);
    }
    openings
}

/// The opening for a link; `None` if the shared wall is too short for one. `before` are the openings placed so far.
fn place_opening(
    dice: &mut HouseDice,
    plan: &FloorPlan,
    rooms: &[HouseRoom],
    link: &RoomLink,
    before: &[WallOpening],
) -> Option<WallOpening> {
    let edge = edge_between(plan, link)?;
    let (span, leaf, floor) = match link.how {
        RoomPassage::Door => {
            let (span, leaf) = place_door(dice, rooms, link, &edge, before)?;
            (span, leaf, rooms[link.room].floor)
        }
        RoomPassage::Doorway { width_cm } => {
            (place_doorway(dice, &edge, width_cm)?, DoorLeaf::None, rooms[link.room].floor)
        }
        RoomPassage::FrontDoor => (centred_span(&edge, 100), DoorLeaf::Closed, rooms[link.room].floor),
        RoomPassage::GarageDoor => {
            (centred_span(&edge, (edge.length() - 80).min(260)), DoorLeaf::Garage, rooms[link.room].floor)
        }
        RoomPassage::Flight { floor } => (flight_span(plan.well?, &edge, floor), DoorLeaf::None, floor),
    };
    Some(WallOpening {
        id: 0,
        room: link.room,
        beyond: link.beyond,
        span,
        base_cm: floor as i32 * STOREY_CM,
        height_cm: if leaf == DoorLeaf::None { DOORWAY_HEIGHT_CM } else { DOOR_HEIGHT_CM },
        leaf,
        colour: Colour::White,
    })
}

/// The stretch of wall in which a link's opening may lie.
fn edge_between(plan: &FloorPlan, link: &RoomLink) -> Option<SpanCm> {
    let outline = plan.rooms[link.room].outline;
    match link.beyond {
        Some(beyond) => Some(outline.shared_edge(&plan.rooms[beyond].outline)?.1),
        // At the narrow end: front doors are usually there, and a car then fits straight through its garage door.
        None => {
            let outer = WallSide::ALL
                .into_iter()
                .map(|wall| outline.edge_at(wall))
                .filter(|edge| is_outer(plan, link.room, edge));
            outer.min_by_key(SpanCm::length)
        }
    }
}

/// Whether no other room of the same storey lies behind any part of an edge.
fn is_outer(plan: &FloorPlan, room: usize, edge: &SpanCm) -> bool {
    let strip = edge.thickened_by(5);
    let same_floor = |index: usize| index != room && plan.rooms[index].floor == plan.rooms[room].floor;
    !(0..plan.rooms.len()).any(|index| same_floor(index) && plan.rooms[index].outline.overlaps(&strip))
}

fn centred_span(edge: &SpanCm, width: i32) -> SpanCm {
    let from = (edge.from + edge.to - width) / 2;
    SpanCm { from, to: from + width, ..*edge }
}

fn place_doorway(dice: &mut HouseDice, edge: &SpanCm, width: i32) -> Option<SpanCm> {
    let room = edge.length() - 2 * MIN_CORNER_WALL_CM;
    if room < MIN_OPENING_CM {
        return None;
    }
    let width = width.min(room);
    let from = edge.from + MIN_CORNER_WALL_CM + dice.draw_stepped(0, room - width, 5);
    // A doorway that is nearly as wide as its wall is centred.
    Some(if room - width < 40 { centred_span(edge, width) } else { SpanCm { from, to: from + width, ..*edge } })
}

/// A door near one end of the shared wall, hinged there, so that the open leaf lies along the side wall.
fn place_door(
    dice: &mut HouseDice,
    rooms: &[HouseRoom],
    link: &RoomLink,
    edge: &SpanCm,
    before: &[WallOpening],
) -> Option<(SpanCm, DoorLeaf)> {
    let width = DOOR_CM.min(edge.length() - 2 * MIN_CORNER_WALL_CM);
    if width < MIN_OPENING_CM {
        return None;
    }
    let (low, high) = (edge.from + MIN_CORNER_WALL_CM, edge.to - MIN_CORNER_WALL_CM - width);
    let into = opens_into(rooms, link)?;
    let mut places = vec![(low, true), (high, false)];
    if dice.chance(50) {
        places.reverse();
    }
    places.extend((low..=high).step_by(10).flat_map(|from| [(from, true), (from, false)]));
    let candidate = |(from, hinge_low): (i32, bool)| {
        (SpanCm { from, to: from + width, ..*edge }, DoorLeaf::Open { into, hinge_low, angle_deg: 90 })
    };
    // Hallways are not checked: no leaf opens into them, so doors may face each other there.
    let sides =
        [Some(link.room), link.beyond].into_iter().flatten().filter(|side| rooms[*side].kind != RoomKind::Hallway);
    let sides: Vec<usize> = sides.collect();
    let is_free = |(span, _): &(SpanCm, DoorLeaf)| {
        sides.iter().all(|side| {
            let area = floor_before_opening(&rooms[*side].outline, span);
            area.is_some_and(|area| !before.iter().any(|other| needs_same_floor(rooms, other, *side, &area)))
        })
    };
    places.iter().copied().map(candidate).find(is_free).or_else(|| places.first().copied().map(candidate))
}

/// Whether an existing opening of a room needs some of the floor that a new opening's leaf swings over.
fn needs_same_floor(rooms: &[HouseRoom], other: &WallOpening, room: usize, swing_area: &RectCm) -> bool {
    let touches = other.room == room || other.beyond == Some(room);
    touches && floor_before_opening(&rooms[room].outline, &other.span).is_some_and(|area| area.overlaps(swing_area))
}

/// The floor in front of an opening, as deep as it is wide but 100 cm at most.
pub(in super::super) fn floor_before_opening(outline: &RectCm, span: &SpanCm) -> Option<RectCm> {
    let (dx, dy) = outline.wall_of(span)?.inward();
    let depth = HALF_WALL_CM + span.length().clamp(80, 100);
    let area = span.thickened_by(0);
    Some(RectCm::new(
        area.x0 + depth * dx.min(0),
        area.y0 + depth * dy.min(0),
        area.x1 + depth * dx.max(0),
        area.y1 + depth * dy.max(0),
    ))
}

/// Doors open away from hallways, and out of closets.
fn opens_into(rooms: &[HouseRoom], link: &RoomLink) -> Option<usize> {
    let beyond = link.beyond?;
    let (here, there) = (rooms[link.room].kind, rooms[beyond].kind);
    let into_here = there == RoomKind::Hallway || (there == RoomKind::Closet && here != RoomKind::Hallway);
    Some(if into_here { link.room } else { beyond })
}

/// The half of the stairwell's side through which a storey's flight is entered.
fn flight_span(well: PlannedStairwell, edge: &SpanCm, floor: u32) -> SpanCm {
    let half = (edge.from + edge.to) / 2;
    let is_low = well.lower_flight_low == (floor == 0);
    let (from, to) = if is_low { (edge.from + HALF_WALL_CM, half - 5) } else { (half + 5, edge.to - HALF_WALL_CM) };
    SpanCm { from, to, ..*edge }
}
