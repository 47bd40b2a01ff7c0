//! Checks whether the rooms of a text are consistent: a room is left only after it was entered, and rooms come in the order in which the
//! path passes them.

use super::{
    names::{find_names, split_words},
    row::{TextFigureRow, share_row},
};
use std::collections::BTreeMap;
use wayword_core::{SceneId, ViewpointSurvey};
use wayword_formats::Episode;
use wayword_language::lexicon::same_room;

/// The words for entering, leaving or passing a room are at most this many words before its name.
const PHRASE_REACH_WORDS: usize = 4;
/// Phrases before a room that the walker leaves.
const LEAVING_PHRASES: [&str; 7] = ["out of", "exit", "leave", "leaving", "exiting", "leaves", "exits"];
/// Phrases before a room that the walker enters or crosses.
const ENTERING_PHRASES: [&str; 10] =
    ["into", "enter", "entering", "to", "toward", "towards", "in", "inside", "through", "reach"];
/// Phrases for a room that the way passes but does not enter.
const ASIDE_PHRASES: [&str; 5] = ["past", "next to", "near", "by", "beside"];

/// A room that a text enters or leaves.
#[derive(Debug, Clone, PartialEq)]
struct TextRoomPassage {
    /// The name of the room, as the lexicon spells it.
    room: String,
    /// Whether the text leaves it.
    is_left: bool,
}

/// The rooms that a text enters, crosses and leaves, in its order.
fn room_passages(text: &str) -> Vec<TextRoomPassage> {
    let words = split_words(text);
    let mut found = Vec::new();
    for name in find_names(&words).into_iter().filter(|name| name.is_room && !name.is_thing) {
        let before = format!(" {} ", words[name.start.saturating_sub(PHRASE_REACH_WORDS)..name.start].join(" "));
        // The phrase nearest to the name counts.
        let last = |phrases: &[&str]| phrases.iter().filter_map(|phrase| before.rfind(&format!(" {phrase} "))).max();
        let (left, entered, aside) = (last(&LEAVING_PHRASES), last(&ENTERING_PHRASES), last(&ASIDE_PHRASES));
        if left.max(entered) > aside && left.max(entered).is_some() {
            found.push(TextRoomPassage { room: name.name, is_left: left > entered });
        }
    }
    found
}

/// The last room that a text goes to.
pub(super) fn last_room(text: &str) -> Option<String> {
    room_passages(text).into_iter().rfind(|passage| !passage.is_left).map(|passage| passage.room)
}

/// Whether a text leaves a room that it did not enter before and that is not the room of the start. Where the room of the start is not
/// known, the first room of the text is taken for it.
fn leaves_unentered(passages: &[TextRoomPassage], start: Option<&str>) -> bool {
    passages.iter().enumerate().any(|(at, passage)| {
        let was_entered = passages[..at].iter().any(|before| same_room(&before.room, &passage.room));
        let is_start = start.map_or(at == 0, |start| same_room(start, &passage.room));
        passage.is_left && !was_entered && !is_start
    })
}

/// Whether the rooms of a text come in another order on the path. Rooms that the path does not pass are skipped.
fn is_out_of_order(passages: &[TextRoomPassage], passed: &[&str]) -> bool {
    let mut from = 0;
    for passage in passages {
        let is_it = |room: &&str| same_room(room, &passage.room);
        if !passed.iter().any(is_it) {
            continue;
        }
        match passed[from..].iter().position(is_it) {
            Some(ahead) => from += ahead,
            None => return true,
        }
    }
    false
}

/// The rooms along an episode's path, where they are known.
fn rooms_on_path<'s>(episode: &Episode, surveys: &'s BTreeMap<SceneId, ViewpointSurvey>) -> Vec<&'s str> {
    let Some(survey) = surveys.get(&episode.scene) else { return Vec::new() };
    let room = |id| survey.viewpoints()[survey.viewpoint_index(id)?].known.room.as_deref();
    let mut rooms: Vec<&str> = episode.viewpoints.iter().map(|id| room(id).unwrap_or_default()).collect();
    rooms.dedup();
    rooms
}

/// The rows of the table about rooms. The order is judged only for paths with a survey of their scene.
pub(super) fn room_rows(episodes: &[Episode], surveys: &BTreeMap<SceneId, ViewpointSurvey>) -> Vec<TextFigureRow> {
    let (mut left, mut order) = (Vec::new(), Vec::new());
    for episode in episodes {
        let passed = rooms_on_path(episode, surveys);
        let start = passed.first().copied().filter(|room| !room.is_empty());
        for text in &episode.instructions {
            let passages = room_passages(text);
            left.push(leaves_unentered(&passages, start));
            if !passed.is_empty() {
                order.push(is_out_of_order(&passages, &passed));
            }
        }
    }
    vec![
        share_row("a room left that was not entered", left.into_iter()),
        share_row("rooms in another order than the path's", order.into_iter()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_is_left_only_after_it_was_entered_or_started_in() {
        let leaves = |text: &str, start| leaves_unentered(&room_passages(text), start);
        assert!(!leaves("Walk out of the bedroom and into the hallway. Exit the hallway.", None));
        assert!(leaves("Go into the hallway, then exit the kitchen.", None));
        assert!(leaves("Exit the kitchen.", Some("bedroom")));
        assert!(!leaves("Exit the kitchen.", Some("kitchen")));
        assert!(!leaves("Go past the kitchen and stop.", Some("bedroom")));
    }

    #[test]
    fn rooms_come_in_the_order_of_the_path() {
        let wrong = |text: &str| is_out_of_order(&room_passages(text), &["bedroom", "hallway", "kitchen"]);
        assert!(!wrong("Leave the bedroom, go through the hallway and stop in the kitchen."));
        assert!(wrong("Go into the kitchen, then into the bedroom."));
        assert!(!wrong("Go into the garage, then into the hallway."));
    }
}
