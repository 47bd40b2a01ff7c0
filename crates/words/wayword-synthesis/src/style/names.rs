//! What people call rooms and things: names that say no more than the usual one.

use super::{measure::Counts, wording::ROOMS};
use wayword_language::{
    lexicon::normal,
    reading::{Reading, What},
};

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
    CALLED.iter().find(|names| names.iter().any(|other| normal(other) == name)).copied()
}

pub(super) fn names(reading: &Reading, counts: &mut Counts) {
    for event in &reading.events {
        let What::Place(place) = &event.what else { continue };
        let Some(names) = called(&place.name) else { continue };
        let said = names.iter().find(|name| normal(name) == place.name).copied().unwrap_or_default();
        names.iter().for_each(|name| counts.add(&format!("{ROOMS}{name}"), said));
    }
}
