//! Rooms and their names.

use super::normal;
use std::{collections::BTreeMap, sync::LazyLock};

struct Rooms {
    /// Normal name to the line it stands on.
    line_of: BTreeMap<String, usize>,
    /// First name of each line.
    names: Vec<&'static str>,
    /// Lines that people do not keep apart from each line.
    taken_for: Vec<Vec<usize>>,
}

static ROOMS: LazyLock<Rooms> = LazyLock::new(|| {
    let lines = include_str!("rooms.txt").lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty());
    let (mut line_of, mut names, mut confused) = (BTreeMap::new(), Vec::new(), Vec::new());
    for (number, line) in lines.enumerate() {
        let (same, others) = line.split_once('|').unwrap_or((line, ""));
        for name in same.split(',').map(str::trim) {
            line_of.entry(normal(name)).or_insert(number);
        }
        names.push(same.split(',').next().unwrap_or(same).trim());
        confused.push(others);
    }
    let lines_of = |others: &str| others.split(',').filter_map(|name| line_of.get(&normal(name)).copied()).collect();
    let taken_for = confused.into_iter().map(lines_of).collect();
    Rooms { line_of, names, taken_for }
});

fn line(name: &str) -> Option<usize> {
    ROOMS.line_of.get(&normal(name)).copied()
}

/// The usual name of a room, where `name` is one.
#[must_use]
pub fn room_name(name: &str) -> Option<&'static str> {
    line(name).map(|line| ROOMS.names[line])
}

/// Whether a phrase in normal spelling names a room.
pub(crate) fn is_room(normal_name: &str) -> bool {
    ROOMS.line_of.contains_key(normal_name)
}

/// Whether two names may mean the same room: the same line, or rooms that people do not keep apart.
#[must_use]
pub fn same_room(a: &str, b: &str) -> bool {
    match (line(a), line(b)) {
        (Some(a), Some(b)) => a == b || ROOMS.taken_for[a].contains(&b) || ROOMS.taken_for[b].contains(&a),
        _ => normal(a) == normal(b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_one_room_agree_and_of_others_do_not() {
        assert!(same_room("foyer", "entryway"));
        assert!(same_room("Living Room", "family room"));
        assert!(same_room("familyroom", "Family Room") && same_room("meetingroom", "conference room"));
        assert!(!same_room("kitchen", "bedroom"));
        assert!(same_room("observatory", "Observatories"));
        assert_eq!(room_name("corridor"), Some("hallway"));
        assert_eq!(room_name("sofa"), None);
    }

    #[test]
    fn every_confusion_names_a_room_of_the_list() {
        for line in include_str!("rooms.txt").lines().filter(|line| !line.starts_with('#')) {
            let others = line.split_once('|').map_or("", |(_, others)| others);
            for name in others.split(',').map(str::trim).filter(|name| !name.is_empty()) {
                assert!(room_name(name).is_some(), "{name} is no room of rooms.txt");
            }
        }
    }
}
