//! Rooms that have numbers but no names, as in HM3D: finds where each of them is, and the name that its things suggest.
//!
//! Every object carries the number of its room, and so do floors, stairs and ceilings. So the floor under an eye shows
//! which room the eye is in. The dataset gives no names. They follow from the labels in a room by the rules in
//! `rooms.txt`; a room about which the rules are not sure gets no name.

mod hallway;
mod rules;

pub(super) use rules::shell_part;

use super::SemanticThing;
use crate::triangle_columns::TriangleColumns;
use glam::Vec3;
use rules::{RoomVerdict, room_verdict};
use std::collections::BTreeMap;
use wayword_core::{DVec3, Heading};

/// Greatest distance at which the floor under an eye is searched, metres.
const UNDER_M: f64 = 3.0;
/// Greatest distance at which the ceiling over an eye is searched, metres.
const OVER_M: f64 = 4.0;
/// Distances around an eye at which the floor is searched where its mesh has a hole, metres.
const AROUND_M: [f64; 3] = [0.15, 0.3, 0.45];
/// An eye nearer than this to another room, ahead or behind, is in the opening between them, metres.
const THRESHOLD_M: f64 = 0.25;
/// An eye nearer than this to another room at its side is in the opening of a wall and sees the jamb, metres: a walker
/// keeps a larger distance from a wall itself.
const ASIDE_M: f64 = 0.15;
/// Distance of the room ahead that an eye in an opening sees, metres.
const AHEAD_M: f64 = 0.5;
/// Distance of two places at which the floor is looked up, metres: less than the thickness of a wall, under which there
/// is no floor.
const STEP_M: f64 = 0.05;
/// A floor that is higher or lower than this next to a place is another storey's, metres.
const LEVEL_M: f64 = 0.4;

/// A part of the shell of a room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ShellPart {
    Floor,
    Stairs,
    Ceiling,
}

/// The rooms of a scene.
#[derive(Debug, Default)]
pub(super) struct NumberedRooms {
    /// The floors, stairs and ceilings. `None` if there are none.
    shell: Option<TriangleColumns>,
    /// The room of each thing that is a part of the shell.
    owners: Vec<Option<(u32, ShellPart)>>,
    names: BTreeMap<u32, &'static str>,
}

/// A surface of a room at some place.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RoomSurface {
    room: u32,
    part: ShellPart,
    height_m: f64,
}

impl NumberedRooms {
    /// The rooms of these things. `shell` has the triangles of floors, stairs and ceilings, each with the index of its thing.
    pub(super) fn from_things(things: &[SemanticThing], shell: Vec<([Vec3; 3], u32)>) -> Self {
        let mut things_in_room: BTreeMap<u32, Vec<&str>> = BTreeMap::new();
        // A thing without triangles has no place, so it is in no room.
        for thing in things.iter().filter(|thing| thing.bounds.is_some()) {
            if let Some(room) = thing.room {
                let ceiling = (thing.part == Some(ShellPart::Ceiling)).then_some("ceiling");
                things_in_room.entry(room).or_default().extend(thing.name.as_deref().or(ceiling));
            }
        }
        let verdicts = things_in_room.into_iter().map(|(room, names)| (room, room_verdict(names.into_iter())));
        let (mut names, mut silent) = (BTreeMap::new(), Vec::new());
        for (room, verdict) in verdicts {
            match verdict {
                RoomVerdict::Named(name) => drop(names.insert(room, name)),
                RoomVerdict::Silent => silent.push(room),
                RoomVerdict::Doubtful => {}
            }
        }
        let owners = things.iter().map(|thing| thing.room.zip(thing.part)).collect();
        let shell = (!shell.is_empty()).then(|| TriangleColumns::with_tags(shell.into_iter()));
        let mut rooms = Self { shell, owners, names };
        let halls = rooms.find_hallways(&silent, things);
        rooms.names.extend(halls.into_iter().map(|room| (room, hallway::HALLWAY_NAME)));
        rooms
    }

    /// The name of the room that an eye sees: the room it is in, or in an opening the room ahead. An eye that looks along the
    /// wall of an opening is between two rooms and sees neither.
    pub(super) fn room_in_view(&self, eye: DVec3, heading: Heading) -> Option<&'static str> {
        let Some(here) = self.floor_below(eye, UNDER_M) else { return self.surface_name(self.surface_near(eye)?) };
        let (sin, cos) = libm::sincos(heading.rad());
        let (ahead, aside) = (DVec3::new(sin, cos, 0.0), DVec3::new(cos, -sin, 0.0));
        let is_edge = |way: DVec3, far_m: f64| self.floor_along(here, eye, way, far_m).any(|at| at.room != here.room);
        if is_edge(ahead, THRESHOLD_M) || is_edge(-ahead, THRESHOLD_M) {
            return self.surface_name(self.floor_along(here, eye, ahead, AHEAD_M).last().unwrap_or(here));
        }
        let is_between = is_edge(aside, ASIDE_M) || is_edge(-aside, ASIDE_M);
        (!is_between).then(|| self.surface_name(here)).flatten()
    }

    /// The name of a surface's room. Stairs in a room without a name are called stairs.
    fn surface_name(&self, surface: RoomSurface) -> Option<&'static str> {
        let stairs = (surface.part == ShellPart::Stairs).then_some("stairs");
        self.names.get(&surface.room).copied().or(stairs)
    }

    /// The floor from place to place in a direction, up to the first gap or ledge.
    fn floor_along(&self, from: RoomSurface, eye: DVec3, way: DVec3, far_m: f64) -> impl Iterator<Item = RoomSurface> {
        let mut height_m = from.height_m;
        let steps = (1..).map(|step| f64::from(step) * STEP_M).take_while(move |at_m| *at_m <= far_m + 1e-9);
        steps.map_while(move |at_m| {
            let place = eye + way * at_m;
            let next = self.floor_below(DVec3::new(place.x, place.y, height_m + LEVEL_M), 2.0 * LEVEL_M)?;
            height_m = next.height_m;
            Some(next)
        })
    }

    /// The room of an eye under which the mesh has a hole: that of the nearest floor, or else of the ceiling.
    fn surface_near(&self, eye: DVec3) -> Option<RoomSurface> {
        let beside = AROUND_M.into_iter().flat_map(|far_m| {
            let turns = (0..8).map(|turn| libm::sincos(f64::from(turn) * std::f64::consts::FRAC_PI_4));
            turns.map(move |(sin, cos)| eye + DVec3::new(sin, cos, 0.0) * far_m)
        });
        beside.filter_map(|place| self.floor_below(place, UNDER_M)).next().or_else(|| self.ceiling_over(eye))
    }

    /// The highest floor or stair under a place.
    fn floor_below(&self, place: DVec3, far_m: f64) -> Option<RoomSurface> {
        let floors = self.surfaces_at(place).filter(|surface| surface.part != ShellPart::Ceiling);
        let under = floors.filter(|surface| (place.z - far_m..=place.z).contains(&surface.height_m));
        under.max_by(|a, b| a.height_m.total_cmp(&b.height_m))
    }

    /// The lowest ceiling over a place.
    fn ceiling_over(&self, place: DVec3) -> Option<RoomSurface> {
        let ceilings = self.surfaces_at(place).filter(|surface| surface.part == ShellPart::Ceiling);
        let over = ceilings.filter(|surface| (place.z..=place.z + OVER_M).contains(&surface.height_m));
        over.min_by(|a, b| a.height_m.total_cmp(&b.height_m))
    }

    /// The surfaces of rooms that a vertical line through a place meets, in no order.
    fn surfaces_at(&self, place: DVec3) -> impl Iterator<Item = RoomSurface> {
        let met = self.shell.iter().flat_map(move |shell| shell.tags_at(place));
        met.filter_map(|(height_m, thing)| {
            let (room, part) = (*self.owners.get(thing as usize)?)?;
            Some(RoomSurface { room, part, height_m })
        })
    }
}

#[cfg(test)]
mod tests;
