//! Things that a room has although labels do not list them.

use super::weights::SilenceWeights;
use wayword_language::lexicon::{find_thing, normalise_name, room_name};

/// Things with at least this salience in the lexicon are seen from across a room.
const SEEN_FROM_AFAR: u8 = 3;

/// Whether a missing label leaves it open that a room has a thing: it can be seen from afar, where labels do not
/// reach, and rooms of this kind have it. Rooms are known by the classes of things that they list, or share a word
/// with the thing: a dining room has a dining table.
#[must_use]
pub fn is_expected(name: &str, room: &str) -> bool {
    let Some(thing) = find_thing(name).filter(|thing| thing.salience >= SEEN_FROM_AFAR) else { return false };
    let room = room_name(room).unwrap_or(room);
    let is_home = SilenceWeights::shipped().homes_of(thing.class).is_some_and(|homes| homes.contains(room));
    let name = normalise_name(name);
    is_home || (name.contains(' ') && name.split(' ').next() == room.split(' ').next())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_expected_knows_the_things_that_make_a_room() {
        assert!(is_expected("dining table", "dining room"));
        assert!(is_expected("bed", "bedroom") && is_expected("bathtub", "bathroom"));
        assert!(!is_expected("dining table", "bathroom") && !is_expected("bathtub", "office"));
        assert!(!is_expected("candle", "dining room"), "nobody sees a candle from afar");
    }

    #[test]
    fn is_expected_needs_a_thing_of_the_lexicon_that_is_seen_from_afar() {
        assert!(!is_expected("zorble", "bedroom"), "no lexicon has it");
        // Chairs make no dining room, because they are no landmark of it; a dining table does by its name.
        assert!(!is_expected("dining chair", "dining room"));
        assert!(is_expected("king bed", "guest room"), "both are other names");
    }
}
