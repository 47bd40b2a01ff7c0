//! The names of rooms: which ones mean the same room, and which rooms people confuse.

use super::normalise_name;
use crate::data;
use std::{collections::BTreeMap, sync::LazyLock};

const ROOM_LIST: &str = include_str!("../languages/en/rooms.txt");

/// The rooms of `languages/en/rooms.txt`. Names on one line mean the same room.
struct RoomLexicon {
    /// The line of each name, by its normal spelling.
    line_of: BTreeMap<String, usize>,
    /// The first name of each line.
    names: Vec<&'static str>,
    /// For each line, the lines of rooms that people confuse with it.
    taken_for: Vec<Vec<usize>>,
}

static ROOMS: LazyLock<RoomLexicon> = LazyLock::new(|| {
    let (mut line_of, mut names, mut confused) = (BTreeMap::new(), Vec::new(), Vec::new());
    for (number, line) in data::content_lines(ROOM_LIST).enumerate() {
        let [same, others] = data::row_columns(line);
        for name in data::split_names(same) {
            line_of.entry(normalise_name(name)).or_insert(number);
        }
        names.push(data::split_names(same).next().unwrap_or_default());
        confused.push(others);
    }
    let lines_of =
        |others| data::split_names(others).filter_map(|name| line_of.get(&normalise_name(name)).copied()).collect();
    let taken_for = confused.into_iter().map(lines_of).collect();
    RoomLexicon { line_of, names, taken_for }
});

/// The line of the list that has a name.
fn room_line(name: &str) -> Option<usize> {
    ROOMS.line_of.get(&normalise_name(name)).copied()
}

/// The usual name of a room; `None` where `name` is not a room's.
#[must_use]
pub fn room_name(name: &str) -> Option<&'static str> {
    room_line(name).map(|line| ROOMS.names[line])
}

/// Whether a phrase in normal spelling names a room.
#[must_use]
pub fn is_room(normal_name: &str) -> bool {
    ROOMS.line_of.contains_key(normal_name)
}

/// Whether two names may mean the same room: they are on one line of the list, or of rooms that people confuse.
#[must_use]
pub fn same_room(a: &str, b: &str) -> bool {
    match (room_line(a), room_line(b)) {
        (Some(a), Some(b)) => a == b || ROOMS.taken_for[a].contains(&b) || ROOMS.taken_for[b].contains(&a),
        _ => normalise_name(a) == normalise_name(b),
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
        assert_eq!(room_name("locker room"), Some("locker room"), "it is no locker");
    }

    #[test]
    fn every_confusion_names_a_room_of_the_list() {
        for line in data::content_lines(ROOM_LIST) {
            let [_, others] = data::row_columns(line);
            for name in data::split_names(others) {
                assert!(room_name(name).is_some(), "{name} is no room of rooms.txt");
            }
        }
    }
}
