//! Counts how the reference texts of a style word a place and a task.
//!
//! The counts are by table and construction of `builtin/place.toml`: of "Go to the bathroom on level 2 and clean the
//! mirror" they are table "opener", "go to", and table "level", "the {r} on level {n}".

use super::{
    names, verbs,
    wording::{PlaceWording, WordingCounts, WordingShares},
};
use wayword_language::{
    lexicon::room_name,
    reading::{
        TextReading, ordinal_word,
        vocabulary::{DETERMINERS, WALKING},
    },
};

/// Measures the wording of reference texts for places and tasks.
pub(super) fn measure_wording(readings: &[TextReading]) -> PlaceWording {
    let mut counts = WordingCounts::default();
    for reading in readings {
        count_text(reading, &mut counts);
    }
    verbs::retain_common_verbs(&mut counts);
    PlaceWording::from_counts(counts.0, readings.len() as f64)
}

/// A text split into the part with the way or the room and the part with the task.
struct PlaceTextParts {
    /// Which part is first, as table "order" calls it: "move" (go to the room and do the task), "task" (do the task in
    /// the room), or "in" (in the room, do the task).
    order: &'static str,
    /// The words of the way or the room, with a space before and after.
    room: String,
    /// The words of the task, with a space before and after.
    task: String,
}

/// Counts the constructions of one text.
fn count_text(reading: &TextReading, counts: &mut WordingCounts) {
    let words = reading.to_plain_words();
    let all = format!(" {} ", words.join(" "));
    let parts = split_text(&words, reading);
    counts.add("order", parts.order);
    if parts.order == "move" {
        count_opener(&words, counts);
    }
    let level = storey_slots(&parts.room).or_else(|| storey_slots(&parts.task));
    let of_room = [("room by", "room by"), ("room with", "room with")];
    let known = PlaceWording::built_in();
    for (table, share) in of_room {
        if let Some(key) = find_construction(known.table(table), &parts.room) {
            counts.add(table, key);
            counts.add("share", share);
        }
    }
    if let Some(key) = level.as_ref().and_then(|level| find_construction(known.table("level"), level)) {
        counts.add("level", key);
        counts.add("share", "level");
    }
    count_object(&parts.task, counts);
    if let Some(key) = find_construction(known.table("wall"), &parts.task) {
        counts.add("wall", key);
        counts.add("share", "wall");
    }
    if all.starts_with(" please ") {
        counts.add("share", "please");
    }
    verbs::count_verb(&words, reading, counts);
    names::count_names(reading, counts);
}

/// The tables with constructions for the properties that a text can mention of an object.
const OBJECT_TABLES: [&str; 15] = [
    "closest",
    "near",
    "above",
    "under",
    "on",
    "beside",
    "between",
    "side",
    "row first",
    "row",
    "middle",
    "nearest",
    "furthest",
    "highest",
    "lowest",
];

/// Counts the properties of its object that a task mentions.
fn count_object(task: &str, counts: &mut WordingCounts) {
    let known = PlaceWording::built_in();
    let task = storey_slots(task).unwrap_or_else(|| task.to_owned());
    // "The top of the table" and "to the left of the sofa" do not place the object in a row.
    let parts_of = ["left", "right", "left side", "right side", "top", "bottom", "middle"];
    let whole = parts_of.iter().fold(task.clone(), |text, part| text.replace(&format!(" {part} of "), " "));
    let to_the_left = task.replace(" right ", " left ");
    let mut has_property = false;
    for table in OBJECT_TABLES {
        let text = match table {
            "side" | "middle" | "highest" | "lowest" => &whole,
            "beside" => &to_the_left,
            _ => &task,
        };
        if let Some(key) = find_construction(known.table(table), text) {
            counts.add(table, key);
            counts.add("told", table);
            has_property = true;
        }
    }
    if has_property {
        counts.add("share", "object");
        let links = known.table("link").keys().filter(|link| !link.is_empty());
        let said = links.filter(|link| task.contains(&format!(" {link} "))).max_by_key(|link| link.len());
        counts.add("link", said.map_or("", String::as_str));
    }
}

/// The construction of a table that a text contains with all its fixed words; of several, the one with the longest
/// fixed words.
fn find_construction<'a>(table: &'a WordingShares, text: &str) -> Option<&'a str> {
    let holds =
        |key: &&String| literal_runs(key).all(|part| text.contains(&part)) && literal_runs(key).next().is_some();
    table
        .keys()
        .filter(holds)
        .max_by_key(|key| literal_runs(key).map(|part| part.len()).sum::<usize>())
        .map(String::as_str)
}

/// The fixed words of a construction between its slots, each run with a space before and after.
fn literal_runs(construction: &str) -> impl Iterator<Item = String> {
    let is_slot = |word: &str| word.starts_with('{') && !matches!(word, "{n}" | "{th}");
    let words: Vec<&str> = construction.split(' ').collect();
    let runs: Vec<String> = words
        .split(|word| is_slot(word))
        .filter(|run| !run.is_empty())
        .map(|run| format!(" {} ", run.join(" ")))
        .collect();
    runs.into_iter()
}

/// The text with slots for the numbers of storeys; `None` if it names none.
fn storey_slots(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_storey = |word: Option<&&str>| word.is_some_and(|word| matches!(*word, "level" | "floor"));
    let mut found = text.contains(" upstairs ") || text.contains(" downstairs ");
    let slot = |at: usize| {
        let word = words[at];
        let is_number = word.parse::<u32>().is_ok() || matches!(word, "one" | "two" | "three" | "four");
        let is_ordinal = matches!(word, "first" | "second" | "third" | "fourth" | "1st" | "2nd" | "3rd");
        match at.checked_sub(1).and_then(|before| words.get(before)) {
            before if is_number && is_storey(before) => "{n}",
            _ if is_ordinal && is_storey(words.get(at + 1)) => "{th}",
            _ => word,
        }
    };
    let slots: Vec<&str> = (0..words.len()).map(slot).collect();
    found |= slots.iter().any(|word| word.starts_with('{'));
    found.then(|| format!(" {} ", slots.join(" ")))
}

/// Splits a text where the way ends and the task begins, or the other way round.
fn split_text(words: &[String], reading: &TextReading) -> PlaceTextParts {
    let part = |words: &[String]| format!(" {} ", words.join(" "));
    let first = words.iter().find(|word| *word != "please").map_or("", String::as_str);
    let verb = reading.task.as_ref().map(|task| task.verb.as_str());
    if matches!(first, "in" | "on" | "at" | "inside") {
        let to = words.iter().rposition(|word| Some(word.as_str()) == verb).unwrap_or(words.len());
        return PlaceTextParts { order: "in", room: part(&words[..to]), task: part(&words[to..]) };
    }
    let goes = PlaceWording::built_in().table("opener").keys().any(|opener| opener.split(' ').next() == Some(first));
    let walks = goes && !matches!(first, "get" | "move" | "make" | "find")
        || WALKING.contains(&first)
            && !matches!(
                first,
                "get" | "bring" | "pick" | "take" | "turn" | "pull" | "move" | "make" | "cut" | "pop" | "drop"
            );
    if walks
        || verb.is_some_and(|verb| verb != first) && words.iter().any(|word| word == "and") && WALKING.contains(&first)
    {
        let to = words.iter().rposition(|word| Some(word.as_str()) == verb).unwrap_or(words.len());
        return PlaceTextParts { order: "move", room: part(&words[..to]), task: part(&words[to..]) };
    }
    // "Clean the mirror in the bathroom": the room begins at the first "in", "from" or "on" that a room's name follows.
    let begins = |at: &usize| {
        matches!(words[*at].as_str(), "in" | "from" | "inside" | "on" | "at")
            && words[*at + 1..]
                .iter()
                .take(4)
                .any(|word| room_name(word).is_some() || word == "room" || word == "level" || word == "floor")
    };
    let at = (1..words.len().saturating_sub(1)).find(begins).unwrap_or(words.len());
    PlaceTextParts { order: "task", room: part(&words[at..]), task: part(&words[..at]) }
}

/// Counts the words before the room ("go to", "proceed to").
fn count_opener(words: &[String], counts: &mut WordingCounts) {
    let known = PlaceWording::built_in().table("opener");
    let ends = |word: &&String| {
        DETERMINERS.contains(&word.as_str())
            || room_name(word).is_some()
            || ordinal_word(word).is_some()
            || *word == "level"
    };
    let Some(end) = words.iter().take(6).position(|word| ends(&word)) else { return };
    let opener = words[..end].join(" ");
    if known.contains_key(&opener) {
        counts.add("opener", &opener);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style::StyleProfile;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use std::collections::BTreeSet;
    use wayword_language::reading::{EventContent, read_instruction};

    #[test]
    fn measure_wording_counts_the_constructions_of_references() {
        let rooms = ["pantry", "nursery", "chapel", "cellar", "attic"];
        let texts: Vec<String> = (0..200)
            .map(|at| {
                format!(
                    "Proceed to the {} on level {} and shake out the rug beside the sofa",
                    rooms[at % 5],
                    at % 3 + 1
                )
            })
            .collect();
        let wording = StyleProfile::from_references(&texts).wording;
        assert!(wording.table("opener")["proceed to"] > 0.9, "{:?}", wording.table("opener"));
        assert!(wording.share_of_texts("level") > 0.9 && wording.share_of_texts("room with") < 0.1);
        assert!(wording.table("near")["beside the {x}"] > 0.9, "{:?}", wording.table("near"));
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let verbs: BTreeSet<&str> = (0..50).map(|_| wording.draw_verb("rug", 1.0, &mut rng)).collect();
        assert!(verbs.contains("shake out {o}"), "{verbs:?}");
    }

    #[test]
    fn the_reader_understands_every_construction() {
        let built_in = PlaceWording::built_in();
        let understood = |text: &str, object: &str| {
            let reading = read_instruction(text, &BTreeSet::new());
            let at = reading.task.as_ref().and_then(|task| task.object);
            let is_object = at.is_some_and(
                |at| matches!(&reading.events[at].what, EventContent::Place(place) if place.name.ends_with(object)),
            );
            is_object && reading.clauses.iter().all(|clause| clause.understood || clause.span[0] == clause.span[1])
        };
        let fill =
            |way: &str| way.replace("{x}", "sofa").replace("{y}", "sink").replace("{th}", "second").replace("{n}", "2");
        for table in OBJECT_TABLES {
            for way in built_in.table(table).keys().map(|way| fill(way)) {
                let object = if way.contains("{o}") { way.replace("{o}", "lamp") } else { format!("the lamp {way}") };
                let text = format!("Go to the kitchen and clean {object}");
                assert!(understood(&text, "lamp"), "{text}");
            }
        }
        for (table, shares) in ["opener", "level", "room by", "room with"].map(|table| (table, built_in.table(table))) {
            for way in shares.keys().map(|way| fill(way)) {
                let text = match table {
                    "opener" => format!("{way} the kitchen and clean the lamp"),
                    "level" => format!("Go to {} and clean the lamp", way.replace("{r}", "kitchen")),
                    _ => format!("Go to the kitchen {way} and clean the lamp"),
                };
                assert!(understood(&text, "lamp"), "{text}");
            }
        }
    }

    #[test]
    fn no_share_of_the_built_in_wording_is_missing() {
        let built_in = PlaceWording::built_in();
        for table in
            OBJECT_TABLES.iter().chain(&["order", "opener", "level", "room by", "room with", "told", "link", "wall"])
        {
            assert!(!built_in.table(table).is_empty(), "{table}");
        }
        assert!(OBJECT_TABLES.iter().all(|table| built_in.table("told").contains_key(*table)));
    }
}
