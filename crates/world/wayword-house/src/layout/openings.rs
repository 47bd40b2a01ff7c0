//! Cuts a door or a doorway into the wall between any two rooms that the plan links.

use super::super::{
    colour::Colour,
    dice::Dice,
    model::{HALF_WALL_CM, Leaf, Opening, Room, RoomKind, STOREY_CM},
    rect::{RectCm, SpanCm, Wall},
};
use super::{Ids, Link, Passage, Plan, Well};

const DOOR_CM: i32 = 90;
const NARROWEST_CM: i32 = 75;
const DOOR_HEIGHT_CM: i32 = 205;
const DOORWAY_HEIGHT_CM: i32 = 220;
/// Least length of wall between an opening and the corner, centimetres: half the crossing wall, and the frame.
const CORNER_CM: i32 = 16;

pub(super) fn cut(dice: &mut Dice, plan: &Plan, rooms: &[Room], ids: &mut Ids) -> Vec<Opening> {
    let colour = dice.pick([Colour::White, Colour::White, Colour::Wooden, Colour::Brown, Colour::Grey]);
    let front = dice.pick([Colour::Red, Colour::Blue, Colour::Green, Colour::Brown, Colour::Black]);
    let mut openings = Vec::new();
    // Doorways first: they have only one good place, but doors can be moved.
    let (doors, others): (Vec<Link>, Vec<Link>) = plan.links.iter().partition(|link| link.how == Passage::Door);
    for link in others.iter().chain(&doors) {
        let Some(mut opening) = place(dice, plan, rooms, link, &openings) else {
            continue;
        };
        opening.colour = if opening.leaf == Leaf::Closed { front } else { colour };
        opening.id = ids.next();
        openings.push(opening);
    }
    openings
}

/// The opening for a link; `None` if the shared wall is too short for one. `before` are the openings placed so far.
fn place(dice: &mut Dice, plan: &Plan, rooms: &[Room], link: &Link, before: &[Opening]) -> Option<Opening> {
    let edge = edge_between(plan, link)?;
    let (span, leaf, floor) = match link.how {
        Passage::Door => {
            let (span, leaf) = door(dice, rooms, link, &edge, before)?;
            (span, leaf, rooms[link.room].floor)
        }
        Passage::Doorway { width_cm } => (doorway(dice, &edge, width_cm)?, Leaf::None, rooms[link.room].floor),
        Passage::FrontDoor => (middle(&edge, 100), Leaf::Closed, rooms[link.room].floor),
        Passage::GarageDoor => (middle(&edge, (edge.length() - 80).min(260)), Leaf::Garage, rooms[link.room].floor),
        Passage::Flight { floor } => (flight(plan.well?, &edge, floor), Leaf::None, floor),
    };
    Some(Opening {
        id: 0,
        room: link.room,
        beyond: link.beyond,
        span,
        base_cm: floor as i32 * STOREY_CM,
        height_cm: if leaf == Leaf::None { DOORWAY_HEIGHT_CM } else { DOOR_HEIGHT_CM },
        leaf,
        colour: Colour::White,
    })
}

/// The stretch of wall in which a link's opening may lie.
fn edge_between(plan: &Plan, link: &Link) -> Option<SpanCm> {
    let outline = plan.rooms[link.room].outline;
    match link.beyond {
        Some(beyond) => Some(outline.shared_edge(&plan.rooms[beyond].outline)?.1),
        // At the narrow end: front doors are usually there, and a car then fits straight through its garage door.
        None => {
            let outer =
                Wall::ALL.into_iter().map(|wall| outline.edge(wall)).filter(|edge| is_outer(plan, link.room, edge));
            outer.min_by_key(SpanCm::length)
        }
    }
}

/// Whether no other room of the same storey lies behind any part of an edge.
fn is_outer(plan: &Plan, room: usize, edge: &SpanCm) -> bool {
    let strip = edge.thickened(5);
    let same_floor = |index: usize| index != room && plan.rooms[index].floor == plan.rooms[room].floor;
    !(0..plan.rooms.len()).any(|index| same_floor(index) && plan.rooms[index].outline.overlaps(&strip))
}

fn middle(edge: &SpanCm, width: i32) -> SpanCm {
    let from = (edge.from + edge.to - width) / 2;
    SpanCm { from, to: from + width, ..*edge }
}

fn doorway(dice: &mut Dice, edge: &SpanCm, width: i32) -> Option<SpanCm> {
    let room = edge.length() - 2 * CORNER_CM;
    if room < NARROWEST_CM {
        return None;
    }
    let width = width.min(room);
    let from = edge.from + CORNER_CM + dice.stepped(0, room - width, 5);
    // A doorway that is nearly as wide as its wall is centred.
    Some(if room - width < 40 { middle(edge, width) } else { SpanCm { from, to: from + width, ..*edge } })
}

/// A door near one end of the shared wall, hinged there, so that the open leaf lies along the side wall.
fn door(dice: &mut Dice, rooms: &[Room], link: &Link, edge: &SpanCm, before: &[Opening]) -> Option<(SpanCm, Leaf)> {
    let width = DOOR_CM.min(edge.length() - 2 * CORNER_CM);
    if width < NARROWEST_CM {
        return None;
    }
    let (low, high) = (edge.from + CORNER_CM, edge.to - CORNER_CM - width);
    let into = opens_into(rooms, link)?;
    let mut places = vec![(low, true), (high, false)];
    if dice.chance(50) {
        places.reverse();
    }
    places.extend((low..=high).step_by(10).flat_map(|from| [(from, true), (from, false)]));
    let candidate = |(from, hinge_low): (i32, bool)| {
        (SpanCm { from, to: from + width, ..*edge }, Leaf::Open { into, hinge_low, angle_deg: 90 })
    };
    // Hallways are not checked: no leaf opens into them, so doors may face each other there.
    let sides =
        [Some(link.room), link.beyond].into_iter().flatten().filter(|side| rooms[*side].kind != RoomKind::Hallway);
    let sides: Vec<usize> = sides.collect();
    let is_free = |(span, _): &(SpanCm, Leaf)| {
        sides.iter().all(|side| {
            let area = swing(&rooms[*side].outline, span);
            area.is_some_and(|area| !before.iter().any(|other| meets(rooms, other, *side, &area)))
        })
    };
    places.iter().copied().map(candidate).find(is_free).or_else(|| places.first().copied().map(candidate))
}

/// Whether an existing opening of a room needs some of the floor that a new opening's leaf swings over.
fn meets(rooms: &[Room], other: &Opening, room: usize, swing_area: &RectCm) -> bool {
    let touches = other.room == room || other.beyond == Some(room);
    touches && swing(&rooms[room].outline, &other.span).is_some_and(|area| area.overlaps(swing_area))
}

/// The floor in front of an opening, as deep as it is wide but 100 cm at most.
pub(in super::super) fn swing(outline: &RectCm, span: &SpanCm) -> Option<RectCm> {
    let (dx, dy) = outline.wall_of(span)?.inward();
    let depth = HALF_WALL_CM + span.length().clamp(80, 100);
    let area = span.thickened(0);
    Some(RectCm::new(
        area.x0 + depth * dx.min(0),
        area.y0 + depth * dy.min(0),
        area.x1 + depth * dx.max(0),
        area.y1 + depth * dy.max(0),
    ))
}

/// Doors open away from hallways, and out of closets.
fn opens_into(rooms: &[Room], link: &Link) -> Option<usize> {
    let beyond = link.beyond?;
    let (here, there) = (rooms[link.room].kind, rooms[beyond].kind);
    let into_here = there == RoomKind::Hallway || (there == RoomKind::Closet && here != RoomKind::Hallway);
    Some(if into_here { link.room } else { beyond })
}

/// The half of the stairwell's side through which a storey's flight is entered.
fn flight(well: Well, edge: &SpanCm, floor: u32) -> SpanCm {
    let half = (edge.from + edge.to) / 2;
    let is_low = well.lower_flight_low == (floor == 0);
    let (from, to) = if is_low { (edge.from + HALF_WALL_CM, half - 5) } else { (half + 5, edge.to - HALF_WALL_CM) };
    SpanCm { from, to, ..*edge }
}
