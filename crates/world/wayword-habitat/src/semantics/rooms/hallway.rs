//! Recognises hallways by their shape: narrow, long, and with doors to several rooms. Few hallways have things that show it.

use super::{super::SemanticThing, LEVEL_M, NumberedRooms, ShellPart};
use std::collections::BTreeMap;
use wayword_core::DVec3;

pub(super) const HALLWAY_NAME: &str = "hallway";

/// Greatest width of a hallway, metres.
const MAX_WIDTH_M: f64 = 2.2;
/// Least length of a hallway, metres.
const MIN_LENGTH_M: f64 = 3.0;
/// Greatest length of a hallway, metres. A longer one is hardly a single hallway, and would take long to examine.
const MAX_LENGTH_M: f64 = 40.0;
/// Least length as a multiple of the width.
const MIN_LENGTH_FACTOR: f64 = 2.0;
/// Least number of rooms to which a hallway leads.
const MIN_ADJACENT_ROOMS: usize = 3;
/// Width of a door or doorway, metres.
const DOOR_M: std::ops::RangeInclusive<f64> = 0.4..=1.8;
/// Two floors that touch along more than this are parts of one open room, metres, although each part has its own number.
const MAX_OPENING_M: f64 = 2.6;
/// Most rooms that are examined; the others are no hallways. Real scenes have fewer, and more would take long.
const MAX_EXAMINED_ROOMS: usize = 64;
/// With more triangles than this near one place, no room of the scene is a hallway. Real scenes have fewer, and more would take
/// long.
const MAX_TRIANGLES_PER_CELL: usize = 1000;
/// Distance of the places at which floors are looked up, metres: less than the thickness of a wall.
const STEP_M: f64 = 0.05;

impl NumberedRooms {
    /// The hallways among `silent`, the rooms in which no thing suggests another name.
    pub(super) fn find_hallways(&self, silent: &[u32], things: &[SemanticThing]) -> Vec<u32> {
        if self.shell.as_ref().is_none_or(|shell| shell.max_triangles_per_cell() > MAX_TRIANGLES_PER_CELL) {
            return Vec::new();
        }
        let examined = silent.iter().copied().take(MAX_EXAMINED_ROOMS);
        examined.filter(|room| self.is_hallway(*room, things)).collect()
    }

    /// Whether a room is a hallway: its floor is narrow and long, it has a ceiling, and it leads to three rooms or more, of
    /// which one is a bathroom or has stairs. The ceiling and the last condition keep balconies out.
    fn is_hallway(&self, room: u32, things: &[SemanticThing]) -> bool {
        let bounds = |part: ShellPart| {
            let of_room = things.iter().filter(|thing| thing.room == Some(room) && thing.part == Some(part));
            of_room.filter_map(|thing| thing.bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        };
        let (Some((low, high)), Some(_)) = (bounds(ShellPart::Floor), bounds(ShellPart::Ceiling)) else { return false };
        let size = high - low;
        let (width_m, length_m) = (size.x.min(size.y), size.x.max(size.y));
        let is_long = (MIN_LENGTH_M..=MAX_LENGTH_M).contains(&length_m) && length_m >= MIN_LENGTH_FACTOR * width_m;
        width_m <= MAX_WIDTH_M && is_long && size.z <= LEVEL_M && self.leads_on(room, low, high)
    }

    /// Whether a room has doors to enough other rooms, one of which is certainly indoors, and is not a part of an open room.
    fn leads_on(&self, room: u32, low: DVec3, high: DVec3) -> bool {
        let touching_m = self.touching_m(room, low, high);
        let is_door = |(_, metres): &(&u32, &f64)| DOOR_M.contains(metres);
        let doors: Vec<u32> = touching_m.iter().filter(is_door).map(|(other, _)| *other).collect();
        let has_stairs = |room: &u32| self.owners.iter().flatten().any(|owner| *owner == (*room, ShellPart::Stairs));
        let is_indoors = |room: &u32| self.names.get(room) == Some(&"bathroom") || has_stairs(room);
        doors.len() >= MIN_ADJACENT_ROOMS
            && doors.iter().any(is_indoors)
            && touching_m.values().all(|metres| *metres <= MAX_OPENING_M)
    }

    /// Along how many metres the floors of other rooms touch a room's floor. Floors are looked up on a grid that reaches a little
    /// beyond the room, and wherever two neighbouring places lie in different rooms, these touch along one step.
    fn touching_m(&self, room: u32, low: DVec3, high: DVec3) -> BTreeMap<u32, f64> {
        // Two places more on each side, so that the rooms behind the border are looked up too.
        let count = |from: f64, to: f64| ((to - from) / STEP_M) as usize + 4;
        let room_at = |column: usize, row: usize| {
            let place = DVec3::new(low.x + (column as f64 - 1.5) * STEP_M, low.y + (row as f64 - 1.5) * STEP_M, 0.0);
            // Looks down from a little above the floor to a little below it.
            self.floor_below(place.with_z(high.z + LEVEL_M / 2.0), LEVEL_M + (high.z - low.z))
                .map(|surface| surface.room)
        };
        let (columns, rows) = (count(low.x, high.x), count(low.y, high.y));
        let mut touching_m = BTreeMap::new();
        let mut count_border = |one: Option<u32>, other: Option<u32>| {
            if let (Some(one), Some(other)) = (one, other)
                && one != other
                && (one == room || other == room)
            {
                *touching_m.entry(if one == room { other } else { one }).or_insert(0.0) += STEP_M;
            }
        };
        let mut row_before: Vec<Option<u32>> = vec![None; columns];
        for row in 0..rows {
            let row_rooms: Vec<Option<u32>> = (0..columns).map(|column| room_at(column, row)).collect();
            row_rooms.windows(2).for_each(|pair| count_border(pair[0], pair[1]));
            row_rooms.iter().zip(&row_before).for_each(|(one, other)| count_border(*one, *other));
            row_before = row_rooms;
        }
        touching_m
    }
}
