//! Turns a structured answer about a view into a caption with sightings, by rules.

use super::read_answer::{ViewReading, ViewThing, is_everywhere};
use crate::dialogue::caption_from_sightings;
use wayword_core::{Caption, ObjectSighting, ViewThird, WayOut, WitnessAnswer};
use wayword_language::{
    lexicon::{names_agree, with_article},
    text::capitalise_first,
};

/// Most things that the text of a caption names; further ones are only among its sightings.
const MAX_NAMED_THINGS: usize = 12;

/// The caption of an answer; its sightings are attributed to `by`.
pub(super) fn caption_from_view(seen: ViewReading, by: &str) -> Caption {
    let mut sightings: Vec<ObjectSighting> = seen.things.iter().flat_map(|thing| thing_sightings(thing, by)).collect();
    for way in &seen.ways {
        if !sightings.iter().any(|other| names_agree(&other.name, &way.name) && other.place == way.place) {
            sightings
                .push(ObjectSighting { place: way.place, ..ObjectSighting::new(&way.name, WitnessAnswer::Seen, by) });
        }
    }
    let room = seen.rooms.first().filter(|_| seen.room_is_sure).cloned();
    let perhaps_rooms = if room.is_some() { Vec::new() } else { seen.rooms };
    let text = caption_text(room.as_deref(), &perhaps_rooms, &sightings, &seen.ways);
    Caption { text, room, perhaps_rooms, sightings, ways: seen.ways, is_structured: true, ..Caption::default() }
}

/// The sightings of a thing, one for each possible name. If it may have several names, none of them counts as seen.
fn thing_sightings<'a>(thing: &'a ViewThing, by: &'a str) -> impl Iterator<Item = ObjectSighting> + 'a {
    let witness = if thing.is_sure { WitnessAnswer::Seen } else { WitnessAnswer::Unsure };
    thing.reading.names.iter().map(move |name| {
        let mut colours = thing.reading.colours.iter().cloned();
        ObjectSighting {
            place: thing.place,
            colour: colours.next(),
            more_colours: colours.collect(),
            material: thing.reading.material.clone(),
            detail: thing.reading.detail.clone(),
            is_far: thing.is_far,
            stands_out: thing.stands_out,
            several: thing.reading.several,
            ..ObjectSighting::new(name, witness, by)
        }
    })
}

/// The text of a caption: things that stand out come first, distant ones last. Doubtful things are named only if there
/// is no certain one.
pub(crate) fn caption_text(
    room: Option<&str>,
    perhaps_rooms: &[String],
    sightings: &[ObjectSighting],
    ways: &[WayOut],
) -> String {
    // Walls, floors and ceilings are in every view, so words about the view name them only where they mark the place.
    let is_told = |sighting: &&ObjectSighting| sighting.stands_out || !is_everywhere(&sighting.name);
    let mut named: Vec<ObjectSighting> =
        sightings.iter().filter(|sighting| sighting.witness == WitnessAnswer::Seen).filter(is_told).cloned().collect();
    named.sort_by_key(|sighting| (!sighting.stands_out, sighting.is_far));
    named.truncate(MAX_NAMED_THINGS);
    named.extend(sightings.iter().filter(|sighting| sighting.witness == WitnessAnswer::Denied).cloned());
    let mut sentences = vec![caption_from_sightings(room, &named)];
    if room.is_none() && !perhaps_rooms.is_empty() {
        let rooms: Vec<String> = perhaps_rooms.iter().map(|room| with_article(room)).collect();
        sentences.push(format!("It is perhaps {}.", rooms.join(" or ")));
    }
    if named.is_empty() {
        let guesses: Vec<String> = sightings
            .iter()
            .filter(|sighting| sighting.witness == WitnessAnswer::Unsure)
            .take(3)
            .map(|sighting| with_article(&sighting.name))
            .collect();
        if !guesses.is_empty() {
            sentences.push(format!("Perhaps there is {}.", guesses.join(" or ")));
        }
    }
    sentences.extend(ways.iter().filter_map(way_out_sentence));
    sentences.join(" ")
}

/// "A door on the left leads to a kitchen." `None` if it is not known where the way out leads.
fn way_out_sentence(way: &WayOut) -> Option<String> {
    let room = with_article(way.leads_to.as_ref()?);
    let place = match way.place {
        Some(ViewThird::Left) => " on the left",
        Some(ViewThird::Middle) => " ahead",
        Some(ViewThird::Right) => " on the right",
        None => "",
    };
    Some(format!("{}{place} leads to {room}.", capitalise_first(&with_article(&way.name))))
}
