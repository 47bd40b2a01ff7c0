//! Describes the memory of a walk for the writing prompt: rooms, doors, bends, and things that are seen from several
//! frames, one line each.

use wayword_checks::memory::{RememberedThing, RoomOpening, RoomStay, WalkBend, WalkMemory};
use wayword_core::Side;

/// Most lines for things; the later things of the walk get none.
const MAX_THING_LINES: usize = 16;
/// A thing nearer to the end than this gets a line with its distance from there, metres.
const NEAR_END_M: f64 = 3.0;

/// The lines for all rooms, doors, bends and things that are worth mentioning.
pub(super) fn remembered_lines(memory: &WalkMemory) -> Vec<String> {
    let mut lines: Vec<String> = rooms_line(&memory.stays).into_iter().collect();
    lines.extend(memory.openings.iter().filter(|opening| opening.has_door).map(door_line));
    lines.extend(memory.bends.iter().filter_map(bend_line));
    let things = memory.things.iter().filter_map(|thing| thing_line(memory, thing));
    lines.extend(things.take(MAX_THING_LINES));
    lines
}

/// "rooms, in order: hallway (Frames 0 to 2), kitchen (Frame 3)". `None` for a walk within one room.
fn rooms_line(stays: &[RoomStay]) -> Option<String> {
    let rooms = stays.iter().map(|stay| format!("{} ({})", stay.room, frame_range(stay.entered, stay.left)));
    (stays.len() > 1).then(|| format!("rooms, in order: {}", rooms.collect::<Vec<_>>().join(", ")))
}

fn door_line(opening: &RoomOpening) -> String {
    let RoomOpening { before, behind, from, to, .. } = opening;
    format!("between Frame {before} and Frame {behind} a door leads from the {from} into the {to}")
}

/// The line for a bend of several moves, which a text should describe as one turn.
fn bend_line(bend: &WalkBend) -> Option<String> {
    let way = match bend.side() {
        Side::Left => "to the left",
        Side::Right => "to the right",
        Side::Behind | Side::Ahead => return None,
    };
    let slight = if bend.is_slight() { "slight " } else { "" };
    (bend.last > bend.first)
        .then(|| format!("the turns from {} are one {slight}bend {way}", frame_range(bend.first, bend.last)))
}

/// The line for a thing that the walk passes, that is seen from several frames, or that is near the end.
fn thing_line(memory: &WalkMemory, thing: &RememberedThing) -> Option<String> {
    let end = memory.frame_count().saturating_sub(1);
    let at_end = memory.distance_m(thing, end).filter(|distance_m| *distance_m < NEAR_END_M);
    if thing.passed.is_none() && thing.glimpses.len() < 2 && at_end.is_none() {
        return None;
    }
    let colour = thing.colour.as_ref().filter(|colour| !thing.name.contains(colour.as_str()));
    let colour = colour.map_or(String::new(), |colour| format!("{colour} "));
    let mut line = format!("{colour}{}: seen from {}", thing.name, frame_range(thing.first_seen(), thing.last_seen()));
    if let Some(passed) = thing.passed {
        let side = if passed.side == Side::Left { "left" } else { "right" };
        line += &format!(", passed on the {side} at Frame {}", passed.frame);
        if let Some((place, all)) = memory.ordinal_among_alike(thing).filter(|(_, all)| *all > 1) {
            line += &format!(" (number {place} of {all} on that side)");
        }
    }
    if let Some(distance_m) = at_end {
        line += &format!(", {distance_m:.1} metres from the end");
    }
    Some(line)
}

/// "Frame 2", "Frames 2 to 4".
fn frame_range(first: usize, last: usize) -> String {
    if first == last { format!("Frame {first}") } else { format!("Frames {first} to {last}") }
}
