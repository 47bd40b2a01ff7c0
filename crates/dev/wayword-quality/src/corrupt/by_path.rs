//! Corruptions that depend only on the path and its labels, not on what the checks recognised in the text.

use super::ABSENT_OBJECTS;
use rand::{Rng, seq::IndexedRandom};
use wayword_checks::Evidence;
use wayword_core::{InstructionStyle, Path};
use wayword_language::lexicon::names_agree;

/// A path has no stairs if its highest and its lowest eye differ by less than this, metres.
const FLAT_M: f64 = 0.4;
/// A thing is surely on one side if the angle from straight ahead to it is within this range, degrees.
const SURE_OF_SIDE_DEG: std::ops::Range<f64> = 30.0..150.0;

/// Rooms that replace others. Each has parts of the names of rooms that people could mistake for it.
const ROOMS_WITH_ALIKE_NAMES: [(&str, &[&str]); 7] = [
    ("kitchen", &["kitchen", "dining", "bar"]),
    ("bathroom", &["bath", "toilet", "spa"]),
    ("bedroom", &["bed"]),
    ("garage", &["garage", "utility", "tool", "workshop"]),
    ("gym", &["gym", "workout", "exercise", "rec", "game", "play"]),
    ("laundry room", &["laundry", "utility"]),
    ("classroom", &["class", "meeting", "conference", "office"]),
];

/// Adds a command to take stairs to a path that has none.
pub(super) fn add_stairs(text: &str, path: &Path, style: &InstructionStyle, rng: &mut impl Rng) -> Option<String> {
    let heights = path.frames.iter().map(|frame| frame.pose.position.z);
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)));
    let commands = ["Go up the stairs", "Go downstairs", "Climb the stairs", "Walk down the stairs", "Go upstairs"];
    let command = commands.choose(rng).filter(|_| high - low < FLAT_M)?;
    let mut letters = text.chars();
    let rest = letters.next()?.to_lowercase().chain(letters).collect::<String>();
    within_length_limit(format!("{command}, then {rest}"), style)
}

/// Adds a phrase at the end of the text with a storey on which the path does not end.
pub(super) fn add_wrong_floor(text: &str, path: &Path, style: &InstructionStyle, rng: &mut impl Rng) -> Option<String> {
    let last = path.frames.last()?.level?;
    let others: Vec<u32> = (1..=4).filter(|level| *level != last).collect();
    let names_floor = ["floor", "level", "stairs"].iter().any(|word| text.contains(word));
    let level = others.choose(rng).filter(|_| !names_floor)?;
    append_words(text, &format!("on level {level}"), style)
}

/// Replaces a room of the path by one in which no frame is.
pub(super) fn replace_room(
    text: &str,
    evidence: &Evidence,
    style: &InstructionStyle,
    rng: &mut impl Rng,
) -> Option<String> {
    let rooms: Vec<&String> = evidence.frames.iter().flat_map(|frame| &frame.rooms).collect();
    let all_known = evidence.frames.iter().all(|frame| !frame.rooms.is_empty());
    let named: Vec<&&String> = rooms.iter().filter(|room| find_word(text, room).is_some()).collect();
    let name = named.choose(rng).filter(|_| all_known)?;
    let absent: Vec<&str> = ROOMS_WITH_ALIKE_NAMES
        .iter()
        .filter(|(_, alike)| !alike.iter().any(|part| rooms.iter().any(|room| room.contains(part))))
        .map(|(room, _)| *room)
        .collect();
    let from = find_word(text, name)?;
    // A room that the text only names as a neighbour need not be on the path.
    let before: Vec<&str> = text[..from].split_whitespace().rev().take(4).collect();
    let is_near =
        ["next", "near", "by", "beside", "off", "with", "of", "from", "to"].iter().any(|word| before.contains(word));
    let other = absent.choose(rng).filter(|_| !is_near)?;
    within_length_limit(format!("{}{other}{}", &text[..from], &text[from + name.len()..]), style)
}

/// Puts a thing on the wrong side. It must be on the same side in every frame that shows it.
pub(super) fn put_on_wrong_side(
    text: &str,
    evidence: &Evidence,
    style: &InstructionStyle,
    rng: &mut impl Rng,
) -> Option<String> {
    let things =
        || evidence.frames.iter().enumerate().flat_map(|(at, frame)| frame.things.iter().map(move |thing| (at, thing)));
    let wrong_side = |name: &str| {
        let turns = things().filter(|(_, thing)| names_agree(&thing.name, name)).flat_map(|(at, thing)| {
            let leaving_rad = evidence.moves.get(at).map_or(0.0, |step| step.turn_rad);
            let deg = thing.turn_rad.map_or(0.0, f64::to_degrees);
            [deg, (deg - leaving_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0]
        });
        let turns: Vec<f64> = turns.collect();
        let all_on = |sign: f64| turns.iter().all(|deg| SURE_OF_SIDE_DEG.contains(&(deg * sign)));
        if all_on(1.0) { Some("left") } else { all_on(-1.0).then_some("right") }
    };
    let mut named: Vec<(usize, &str)> = things()
        .filter_map(|(_, thing)| {
            find_word(text, &thing.name).map(|from| (from + thing.name.len(), thing.name.as_str()))
        })
        .filter(|(end, _)| text[*end..].is_empty() || text[*end..].starts_with(['.', ',']))
        .collect();
    named.dedup();
    let (end, name) = *named.choose(rng)?;
    let wrong = wrong_side(name)?;
    within_length_limit(format!("{} on your {wrong}{}", &text[..end], &text[end..]), style)
}

/// Adds a task on an object that no frame shows, in a style that asks for no task.
pub(super) fn unasked_task(
    text: &str,
    evidence: &Evidence,
    style: &InstructionStyle,
    rng: &mut impl Rng,
) -> Option<String> {
    let absent: Vec<&str> =
        ABSENT_OBJECTS.into_iter().filter(|name| evidence.frames_with_thing(name).is_empty()).collect();
    let object = absent.choose(rng).filter(|_| !style.constraints.ends_in_task)?;
    append_words(text, &format!("and clean the {object}"), style)
}

/// The text with words added before its last full stop.
fn append_words(text: &str, words: &str, style: &InstructionStyle) -> Option<String> {
    let bare = text.trim_end_matches('.');
    within_length_limit(format!("{bare} {words}{}", &text[bare.len()..]), style)
}

/// The text, or `None` if the style's limit on length would reject it anyway.
fn within_length_limit(text: String, style: &InstructionStyle) -> Option<String> {
    let words = text.split_whitespace().count();
    style.constraints.fewer_words_than.is_none_or(|limit| words < limit).then_some(text)
}

/// The byte position at which a text has a name as whole words.
fn find_word(text: &str, name: &str) -> Option<usize> {
    let is_end = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
    text.match_indices(name).map(|(at, _)| at).find(|at| {
        !name.is_empty() && is_end(text[..*at].chars().next_back()) && is_end(text[at + name.len()..].chars().next())
    })
}
