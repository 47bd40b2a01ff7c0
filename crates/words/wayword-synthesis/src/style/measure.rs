//! Counts in reference texts how people word a place and a task.

use super::wording::{ROOMS, Shares, Wording, verbs_of_class, verbs_of_kind};
use std::collections::{BTreeMap, BTreeSet};
use wayword_language::{
    lexicon::{kinds, room_name, thing},
    reading::{
        Reading, What, ordinal, read,
        vocabulary::{DETERMINERS, WALKING},
    },
    text::words,
};

/// A verb is taken from references that use it at least so often for one kind of thing.
const LEAST_USES: f64 = 3.0;
/// And for things of one class, in this share of their tasks.
const LEAST_SHARE: f64 = 0.01;

/// Counts of constructions, by table.
#[derive(Default)]
struct Counts(BTreeMap<String, Shares>);

impl Counts {
    fn add(&mut self, table: &str, key: &str) {
        *self.0.entry(table.to_owned()).or_default().entry(key.to_owned()).or_default() += 1.0;
    }
}

/// The wording of reference texts, as far as they are about places and tasks.
pub(super) fn measure<'a>(texts: impl Iterator<Item = (&'a str, &'a Reading)>) -> Wording {
    let (mut counts, mut number) = (Counts::default(), 0.0);
    for (text, reading) in texts {
        number += 1.0;
        count(text, reading, &mut counts);
    }
    retain_common_verbs(&mut counts);
    Wording::smoothed(counts.0, number)
}

/// A text in parts: the way or the room, and the task.
struct Parts {
    order: &'static str,
    room: String,
    task: String,
}

fn count(text: &str, reading: &Reading, counts: &mut Counts) {
    let words = words(text);
    let all = format!(" {} ", words.join(" "));
    let parts = parts(&words, reading);
    counts.add("order", parts.order);
    if parts.order == "move" {
        opener(&words, counts);
    }
    let level = storeys(&parts.room).or_else(|| storeys(&parts.task));
    let of_room = [("room by", "room by"), ("room with", "room with")];
    let known = Wording::built_in();
    for (table, share) in of_room {
        if let Some(key) = first_of(known.table(table), &parts.room) {
            counts.add(table, key);
            counts.add("share", share);
        }
    }
    if let Some(key) = level.as_ref().and_then(|level| first_of(known.table("level"), level)) {
        counts.add("level", key);
        counts.add("share", "level");
    }
    let mut told = false;
    for table in [
        "closest",
        "near",
        "above",
        "under",
        "on",
        "left",
        "right",
        "between",
        "side",
        "row first",
        "row last",
        "row",
        "middle",
        "nearest",
        "furthest",
        "highest",
        "lowest",
    ] {
        if let Some(key) = first_of(known.table(table), &storeys(&parts.task).unwrap_or_else(|| parts.task.clone())) {
            counts.add(table, key);
            counts.add("told", table);
            told = true;
        }
    }
    if told {
        counts.add("share", "object");
    }
    if told {
        let links = known.table("link").keys().filter(|link| !link.is_empty());
        let said = links.filter(|link| parts.task.contains(&format!(" {link} "))).max_by_key(|link| link.len());
        counts.add("link", said.map_or("", String::as_str));
    }
    if all.starts_with(" please ") {
        counts.add("share", "please");
    }
    verb(&words, reading, counts);
    rooms(reading, counts);
}

/// The construction of a table whose own words a text holds; of several, the one with the most words of its own.
fn first_of<'a>(table: &'a Shares, text: &str) -> Option<&'a str> {
    let holds = |key: &&String| literals(key).all(|part| text.contains(&part)) && literals(key).next().is_some();
    table.keys().filter(holds).max_by_key(|key| literals(key).map(|part| part.len()).sum::<usize>()).map(String::as_str)
}

/// The words of a construction between its slots, each run with a space before and behind.
fn literals(construction: &str) -> impl Iterator<Item = String> {
    let is_slot = |word: &str| word.starts_with('{') && !matches!(word, "{n}" | "{th}");
    let words: Vec<&str> = construction.split(' ').collect();
    let runs: Vec<String> = words
        .split(|word| is_slot(word))
        .filter(|run| !run.is_empty())
        .map(|run| format!(" {} ", run.join(" ")))
        .collect();
    runs.into_iter()
}

/// The text with the numbers of storeys as slots, where it names one.
fn storeys(text: &str) -> Option<String> {
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

/// Where the way ends and the task begins.
fn parts(words: &[String], reading: &Reading) -> Parts {
    let part = |words: &[String]| format!(" {} ", words.join(" "));
    let first = words.iter().find(|word| *word != "please").map_or("", String::as_str);
    let verb = reading.task.as_ref().map(|task| task.verb.as_str());
    if matches!(first, "in" | "on" | "at" | "inside") {
        let to = words.iter().rposition(|word| Some(word.as_str()) == verb).unwrap_or(words.len());
        return Parts { order: "in", room: part(&words[..to]), task: part(&words[to..]) };
    }
    let goes = Wording::built_in().table("opener").keys().any(|opener| opener.split(' ').next() == Some(first));
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
        return Parts { order: "move", room: part(&words[..to]), task: part(&words[to..]) };
    }
    // "Clean the mirror in the bathroom": the room begins behind the last "in the" or "from the".
    let begins = |at: &usize| {
        matches!(words[*at].as_str(), "in" | "from" | "inside" | "on" | "at")
            && words[*at + 1..]
                .iter()
                .take(4)
                .any(|word| room_name(word).is_some() || word == "room" || word == "level" || word == "floor")
    };
    let at = (1..words.len().saturating_sub(1)).find(begins).unwrap_or(words.len());
    Parts { order: "task", room: part(&words[at..]), task: part(&words[..at]) }
}

/// The words before the room.
fn opener(words: &[String], counts: &mut Counts) {
    let known = Wording::built_in().table("opener");
    let ends = |word: &&String| {
        DETERMINERS.contains(&word.as_str()) || room_name(word).is_some() || ordinal(word).is_some() || *word == "level"
    };
    let Some(end) = words.iter().take(6).position(|word| ends(&word)) else { return };
    let said = words[..end].join(" ");
    if known.contains_key(&said) {
        counts.add("opener", &said);
    }
}

/// What is done, with `{o}` for the object.
fn verb(words: &[String], reading: &Reading, counts: &mut Counts) {
    let Some(task) = &reading.task else { return };
    let Some(What::Place(place)) = task.object.map(|at| &reading.events[at].what) else { return };
    let Some(kind) = thing(&place.name) else { return };
    let Some(at) = words.iter().rposition(|word| *word == task.verb) else { return };
    let Some(end) =
        (at + 1..words.len().min(at + 5)).find(|at| DETERMINERS.contains(&words[*at].as_str()) && words[*at] != "that")
    else {
        return;
    };
    let said = &words[at..end];
    let is_plain = said.len() <= 3 && said.iter().all(|word| word.chars().all(char::is_alphabetic) && word.len() > 1);
    if !is_plain
        || WALKING.contains(&task.verb.as_str())
            && !matches!(
                task.verb.as_str(),
                "get" | "bring" | "pick" | "take" | "turn" | "pull" | "move" | "make" | "sit" | "push"
            )
    {
        return;
    }
    // "Turn the light on": the particle stands behind the object.
    let noun = place.name.rsplit(' ').next().unwrap_or_default();
    let behind = words[end..].iter().position(|word| word == noun).map(|noun| end + noun + 1);
    let particle = behind.and_then(|at| Some((words.get(at)?, words.get(at + 1))));
    let mut key = format!("{} {{o}}", said.join(" "));
    if let Some((particle @ ("on" | "off" | "out" | "up" | "down"), next)) =
        particle.map(|(word, next)| (word.as_str(), next))
    {
        let is_last = next.is_none_or(|next| matches!(next.as_str(), "in" | "and" | "from"));
        if is_last && said.len() == 1 {
            key = format!("{key} {particle}");
        }
    }
    kinds(kind.name).iter().for_each(|kind| counts.add(&verbs_of_kind(kind), &key));
    counts.add(&verbs_of_class(kind.class), &key);
}

/// Keeps the verbs that several references use, and that the reader takes for a task on the thing.
fn retain_common_verbs(counts: &mut Counts) {
    for (table, verbs) in &mut counts.0 {
        let Some(of) = table.strip_prefix(super::wording::VERBS) else { continue };
        let all: f64 = verbs.values().sum();
        let least = if of.starts_with("class ") { (all * LEAST_SHARE).max(LEAST_USES) } else { LEAST_USES };
        let object = if of.starts_with("class ") { "lamp" } else { of };
        verbs.retain(|verb, count| *count >= least && is_read(verb, object));
    }
}

/// Whether the reader takes a verb for a task, and understands all of it.
fn is_read(verb: &str, object: &str) -> bool {
    let text = format!("Go to the kitchen and {}", verb.replace("{o}", &format!("the {object}")));
    let reading = read(&text, &BTreeSet::new());
    let has_object = reading.task.as_ref().is_some_and(|task| task.object.is_some());
    has_object && reading.clauses.iter().all(|clause| clause.understood || clause.span[0] == clause.span[1])
}

/// Names of one room or thing that say no more of it than its usual name.
const CALLED: &[&[&str]] = &[
    &["hallway", "hall", "corridor"],
    &["entryway", "foyer", "lobby"],
    &["porch", "deck", "patio", "terrace"],
    &["laundry room", "laundryroom"],
    &["family room", "familyroom"],
    &["meeting room", "meetingroom", "conference room"],
    &["stairs", "staircase", "stairway"],
    &["office", "study"],
    &["bathroom", "restroom"],
    &["garage"],
    &["outdoor area", "yard", "courtyard", "patio"],
    &["gym", "workout room", "exercise room"],
    &["game room", "rec room"],
    &["sofa", "couch"],
    &["counter", "countertop", "counter top"],
    &["trash can", "trash bin", "bin", "garbage can", "trashcan"],
    &["nightstand", "night stand", "bedside table"],
    &["tv", "television"],
    &["faucet", "tap"],
    &["bookshelf", "bookcase"],
    &["refrigerator", "fridge"],
    &["bathtub", "tub", "bath tub"],
    &["washing machine", "washer"],
    &["curtain", "drape"],
    &["potted plant", "plant"],
    &["side table", "end table"],
    &["desk chair", "office chair"],
];

/// The names that mean a room or thing and no more.
fn called(name: &str) -> Option<&'static [&'static str]> {
    CALLED.iter().find(|names| names.contains(&name)).copied()
}

fn rooms(reading: &Reading, counts: &mut Counts) {
    for event in &reading.events {
        let What::Place(place) = &event.what else { continue };
        for name in called(&place.name).into_iter().flatten() {
            counts.add(&format!("{ROOMS}{name}"), &place.name);
        }
    }
}
