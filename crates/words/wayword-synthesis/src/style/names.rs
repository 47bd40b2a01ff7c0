//! Counts which of several equivalent names people use for rooms and things ("hallway", "hall", "corridor").

use super::wording::{NAME_TABLE_PREFIX, WordingCounts};
use wayword_language::{
    lexicon::normalise_name,
    reading::{EventContent, TextReading},
};

/// Groups of names with the same meaning.
const EQUIVALENT_NAMES: &[&[&str]] = &[
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

/// The group of names that a name belongs to.
fn equivalent_names(name: &str) -> Option<&'static [&'static str]> {
    EQUIVALENT_NAMES.iter().find(|names| names.iter().any(|other| normalise_name(other) == name)).copied()
}

/// Counts the name that a text uses for each of its rooms and things, in the table of every name of its group.
pub(super) fn count_names(reading: &TextReading, counts: &mut WordingCounts) {
    for event in &reading.events {
        let EventContent::Place(place) = &event.what else { continue };
        let Some(names) = equivalent_names(&place.name) else { continue };
        let used = names.iter().find(|name| normalise_name(name) == place.name).copied().unwrap_or_default();
        names.iter().for_each(|name| counts.add(&format!("{NAME_TABLE_PREFIX}{name}"), used));
    }
}
