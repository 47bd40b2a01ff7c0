//! Names rooms by the things in them, with the rules of `rooms.txt`.
//!
//! A rule has things that decide for its room, and things that only suggest it. For example, a bed decides for a bedroom. A room gets
//! a name only if exactly one rule decides, and nothing in it suggests another room.

use super::ShellPart;
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::LazyLock,
};

const ROOM_RULES_TEXT: &str = include_str!("rooms.txt");

static ROOM_RULES: LazyLock<RoomRules> = LazyLock::new(|| RoomRules::parse(ROOM_RULES_TEXT));

/// What the things in a room suggest about its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RoomVerdict {
    /// It has this name.
    Named(&'static str),
    /// They suggest different rooms, or no room clearly enough.
    Doubtful,
    /// They suggest no name.
    Silent,
}

/// The part of a room's shell that has this plain name.
pub(in super::super) fn shell_part(plain: &str) -> Option<ShellPart> {
    ROOM_RULES.parts.get(plain).copied()
}

/// The verdict on a room that has things with these plain names.
pub(super) fn room_verdict<'a>(names: impl Iterator<Item = &'a str>) -> RoomVerdict {
    ROOM_RULES.judge_names(&names.collect())
}

/// The contents of `rooms.txt`.
#[derive(Debug, Default)]
struct RoomRules {
    /// The parts of a room's shell, by the names of the things that are one.
    parts: BTreeMap<&'static str, ShellPart>,
    /// The word that the rules use instead of each of its synonyms.
    same: BTreeMap<&'static str, &'static str>,
    rooms: Vec<RoomRule>,
    /// Lines that could not be parsed; a test checks that there are none.
    odd: Vec<&'static str>,
}

/// The rule for one kind of room.
#[derive(Debug)]
struct RoomRule {
    room: &'static str,
    /// Each group decides if all its things are in the room.
    decides: Vec<Vec<&'static str>>,
    /// Things that only suggest the room.
    suggests: Vec<&'static str>,
    /// Other rooms: things that suggest them may lie in this room too.
    also: Vec<&'static str>,
}

/// The entries of a comma-separated list.
fn list_entries(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split(',').map(str::trim).filter(|entry| !entry.is_empty())
}

impl RoomRules {
    /// Parses the text of `rooms.txt`, of which the head explains the lines.
    fn parse(list: &'static str) -> Self {
        let mut rules = Self::default();
        for line in list.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
            let mut add_parts =
                |part: ShellPart, names| rules.parts.extend(list_entries(names).map(|name| (name, part)));
            match line.split_once(':') {
                Some(("floors", names)) => add_parts(ShellPart::Floor, names),
                Some(("stairs", names)) => add_parts(ShellPart::Stairs, names),
                Some(("ceilings", names)) => add_parts(ShellPart::Ceiling, names),
                Some(("same", names)) => {
                    let first = list_entries(names).next().unwrap_or_default();
                    rules.same.extend(list_entries(names).skip(1).map(|name| (name, first)));
                }
                Some(("room", columns)) => match columns.split('|').collect::<Vec<_>>()[..] {
                    [room, decides, suggests, also] => rules.rooms.push(RoomRule {
                        room: room.trim(),
                        decides: list_entries(decides).map(|all| all.split('+').map(str::trim).collect()).collect(),
                        suggests: list_entries(suggests).collect(),
                        also: list_entries(also).collect(),
                    }),
                    _ => rules.odd.push(line),
                },
                _ => rules.odd.push(line),
            }
        }
        rules
    }

    /// The verdict on a room with things of these names.
    fn judge_names(&self, names: &BTreeSet<&str>) -> RoomVerdict {
        let names: BTreeSet<&str> = names.iter().map(|name| self.same.get(name).copied().unwrap_or(name)).collect();
        let is_decided =
            |rule: &&RoomRule| rule.decides.iter().any(|all| all.iter().all(|thing| names.contains(thing)));
        let suggests = |rule: &&RoomRule| is_decided(rule) || rule.suggests.iter().any(|thing| names.contains(thing));
        let suggested: Vec<&RoomRule> = self.rooms.iter().filter(suggests).collect();
        if suggested.is_empty() {
            return RoomVerdict::Silent;
        }
        let is_free =
            |rule: &&RoomRule| suggested.iter().all(|other| other.room == rule.room || rule.also.contains(&other.room));
        let mut decided = suggested.iter().copied().filter(is_decided).filter(is_free);
        match (decided.next(), decided.next()) {
            (Some(rule), None) => RoomVerdict::Named(rule.room),
            _ => RoomVerdict::Doubtful,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_world::{object_names::plain_name, region_letters};

    /// The verdict on things as the annotators write them, separated by commas.
    fn verdict_on(things: &str) -> RoomVerdict {
        let plain: Vec<String> = things.split(',').filter_map(plain_name).collect();
        room_verdict(plain.iter().map(String::as_str))
    }

    #[test]
    fn every_line_is_understood_and_names_a_room_that_other_scenes_have_too() {
        assert_eq!(ROOM_RULES.odd, [""; 0]);
        let known: BTreeSet<&str> = ('a'..='z').chain('A'..='Z').filter_map(region_letters::room_for_letter).collect();
        for rule in &ROOM_RULES.rooms {
            assert!(known.contains(rule.room), "{}", rule.room);
            for other in &rule.also {
                assert!(ROOM_RULES.rooms.iter().any(|rule| rule.room == *other), "{other} has no line");
            }
            // The reader replaces synonyms, so a rule that names one would never match.
            for thing in rule.decides.iter().flatten().chain(&rule.suggests) {
                assert!(!ROOM_RULES.same.contains_key(thing), "{thing} is another name of {}", ROOM_RULES.same[thing]);
            }
        }
    }

    #[test]
    fn things_in_a_room_decide_its_name() {
        for (things, room) in [
            ("bed, nightstand, tv", "bedroom"),
            ("king bed, desk, desk chair, couch, tv", "bedroom"),
            ("toilet seat, sink, mirror", "bathroom"),
            ("bath tub, washing machine", "bathroom"),
            ("shower cabin", "bathroom"),
            ("oven and stove, dining table", "kitchen"),
            ("kitchen cabinet, refrigerator, sink", "kitchen"),
            ("stove, sink", "kitchen"),
            ("dining table, dining chair, ceiling", "dining room"),
            ("couch, coffee table, ceiling", "living room"),
            ("sofa, flatscreen tv, plant", "living room"),
            ("desk, office chair, bookshelf", "office"),
            ("computer desk, computer monitor", "office"),
            ("washer-dryer, clothes rack", "laundry room"),
            ("treadmill, mirror, ceiling", "gym"),
            ("billiard table, couch, tv", "game room"),
            ("car, bicycle, ceiling", "garage"),
            ("front door, shoe rack", "entryway"),
            ("clothes rack, cardboard boxes", "closet"),
        ] {
            assert_eq!(verdict_on(things), RoomVerdict::Named(room), "{things}");
        }
    }

    #[test]
    fn things_of_two_rooms_leave_the_verdict_doubtful() {
        for things in [
            "bed, stove",
            "bed, dining table",
            "bed, toilet",
            "sofa, tv, dining table",
            "sofa, tv, kitchen counter",
            "sofa, tv, desk, office chair",
            "toilet, refrigerator",
            "treadmill, sofa, tv",
            "clothes rack, toilet, bed",
        ] {
            assert_eq!(verdict_on(things), RoomVerdict::Doubtful, "{things}");
        }
    }

    #[test]
    fn things_of_any_room_leave_the_verdict_silent() {
        for things in ["", "chair, picture, lamp", "sink, mirror", "desk", "toilet paper, bed sheet", "unknown, wall"] {
            assert_eq!(verdict_on(things), RoomVerdict::Silent, "{things}");
        }
        // These speak for a room, but not alone.
        for things in ["refrigerator", "couch, coffee table", "kitchen cabinet, sink", "door mat"] {
            assert_eq!(verdict_on(things), RoomVerdict::Doubtful, "{things}");
        }
    }
}
