//! Makes a caption with sightings of a structured answer, by rules.

use super::read::{Seen, Thing};
use crate::dialogue::caption_of;
use wayword_core::{Caption, Sighting, WayOut, Where, Witness};
use wayword_language::{
    lexicon::{agree, with_article},
    text::capital,
};

/// Most things that the text of a caption names.
const MOST_IN_TEXT: usize = 12;

/// The caption of an answer; its sightings are attributed to `by`.
pub(super) fn caption(seen: Seen, by: &str) -> Caption {
    let mut sightings: Vec<Sighting> = seen.things.iter().flat_map(|thing| of_thing(thing, by)).collect();
    for way in &seen.ways {
        if !sightings.iter().any(|other| agree(&other.name, &way.name) && other.place == way.place) {
            sightings.push(Sighting { place: way.place, ..Sighting::new(&way.name, Witness::Seen, by) });
        }
    }
    let room = seen.rooms.first().filter(|_| seen.room_is_sure).cloned();
    let perhaps_rooms = if room.is_some() { Vec::new() } else { seen.rooms };
    let text = text(room.as_deref(), &perhaps_rooms, &sightings, &seen.ways);
    Caption { text, room, perhaps_rooms, sightings, ways: seen.ways, is_structured: true, ..Caption::default() }
}

/// The sightings of a thing, one for each possible name. If it may have several names, none of them counts as seen.
fn of_thing<'a>(thing: &'a Thing, by: &'a str) -> impl Iterator<Item = Sighting> + 'a {
    let witness = if thing.is_sure { Witness::Seen } else { Witness::Unsure };
    thing.told.names.iter().map(move |name| {
        let mut colours = thing.told.colours.iter().cloned();
        Sighting {
            place: thing.place,
            colour: colours.next(),
            more_colours: colours.collect(),
            material: thing.told.material.clone(),
            is_far: thing.is_far,
            stands_out: thing.stands_out,
            several: thing.told.several,
            ..Sighting::new(name, witness, by)
        }
    })
}

/// The text of a caption: things that stand out come first, distant ones last. Doubtful things are named only if there
/// is no certain one.
pub(crate) fn text(room: Option<&str>, perhaps_rooms: &[String], sightings: &[Sighting], ways: &[WayOut]) -> String {
    let mut named: Vec<Sighting> =
        sightings.iter().filter(|sighting| sighting.witness == Witness::Seen).cloned().collect();
    named.sort_by_key(|sighting| (!sighting.stands_out, sighting.is_far));
    named.truncate(MOST_IN_TEXT);
    named.extend(sightings.iter().filter(|sighting| sighting.witness == Witness::Denied).cloned());
    let mut sentences = vec![caption_of(room, &named)];
    if room.is_none() && !perhaps_rooms.is_empty() {
        let rooms: Vec<String> = perhaps_rooms.iter().map(|room| with_article(room)).collect();
        sentences.push(format!("It is perhaps {}.", rooms.join(" or ")));
    }
    if named.is_empty() {
        let guesses: Vec<String> = sightings
            .iter()
            .filter(|sighting| sighting.witness == Witness::Unsure)
            .take(3)
            .map(|sighting| with_article(&sighting.name))
            .collect();
        if !guesses.is_empty() {
            sentences.push(format!("Perhaps there is {}.", guesses.join(" or ")));
        }
    }
    sentences.extend(ways.iter().filter_map(way));
    sentences.join(" ")
}

fn way(way: &WayOut) -> Option<String> {
    let room = with_article(way.leads_to.as_ref()?);
    let place = match way.place {
        Some(Where::Left) => " on the left",
        Some(Where::Middle) => " ahead",
        Some(Where::Right) => " on the right",
        None => "",
    };
    Some(format!("{}{place} leads to {room}.", capital(&with_article(&way.name))))
}
