//! The asker that works by rules.

use super::{Asker, sightings};
use crate::lexicon::{agree, room_name, thing};
use wayword_core::{Exchange, ModelError, Sighting, Witness};

/// Asks which room it is, looks for what such a room usually has and nobody named, and asks for colours of landmarks.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesAsker;

/// Most objects whose presence is asked about: a "no" is evidence too, but each costs a question.
const PROBES: usize = 3;
/// Most landmarks whose colour is asked for.
const COLOURS: usize = 2;

/// What rooms usually have; asked for where nobody named it.
const USUAL: &[(&str, &[&str])] = &[
    ("bedroom", &["bed", "wardrobe", "nightstand", "mirror"]),
    ("bathroom", &["sink", "mirror", "bathtub", "toilet"]),
    ("toilet", &["toilet", "sink", "mirror"]),
    ("kitchen", &["stove", "refrigerator", "sink", "kitchen island"]),
    ("dining room", &["dining table", "chandelier", "chair"]),
    ("living room", &["sofa", "fireplace", "coffee table", "tv"]),
    ("family room", &["sofa", "tv", "fireplace"]),
    ("office", &["desk", "bookshelf", "monitor"]),
    ("hallway", &["stairs", "picture", "mirror"]),
    ("entryway", &["stairs", "mirror", "bench"]),
    ("laundry room", &["washing machine", "dryer", "sink"]),
    ("gym", &["treadmill", "mirror", "tv"]),
];
/// What is asked for where the room is none of these.
const USUAL_ANYWHERE: &[&str] = &["table", "chair", "stairs"];

impl Asker for RulesAsker {
    fn name(&self) -> &str {
        "rules"
    }

    fn next_question(&self, transcript: &[Exchange]) -> Result<Option<String>, ModelError> {
        let asked = |question: &str| transcript.iter().any(|exchange| exchange.question == question);
        let room_question = super::FIXED_QUERIES[1];
        if !asked(room_question) {
            return Ok(Some(room_question.to_owned()));
        }
        let told = sightings(transcript, "");
        let probe = probes(transcript, &told).into_iter().find(|question| !asked(question));
        let probed = transcript.iter().filter(|exchange| exchange.question.starts_with("Is there ")).count();
        Ok(probe.filter(|_| probed < PROBES).or_else(|| colours(&told).into_iter().find(|question| !asked(question))))
    }
}

fn probes(transcript: &[Exchange], told: &[Sighting]) -> Vec<String> {
    let room = super::answers::room(transcript).unwrap_or_default();
    let room = room_name(&room).unwrap_or_default();
    let usual = USUAL.iter().find(|(name, _)| *name == room).map_or(USUAL_ANYWHERE, |(_, things)| things);
    let unnamed = usual.iter().filter(|name| !told.iter().any(|sighting| agree(&sighting.name, name)));
    unnamed.map(|name| format!("Is there {}?", super::answers::with_article(name))).collect()
}

fn colours(told: &[Sighting]) -> Vec<String> {
    let seen = told
        .iter()
        .filter(|sighting| sighting.witness == Witness::Seen && !sighting.several && sighting.colour.is_none());
    let landmarks = seen.filter(|sighting| thing(&sighting.name).is_some_and(|thing| thing.salience >= 2));
    landmarks.take(COLOURS).map(|sighting| format!("What colour is the {}?", sighting.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exchange(question: &str, answer: &str) -> Exchange {
        Exchange::new(question, answer)
    }

    #[test]
    fn it_looks_for_what_the_room_usually_has_and_nobody_named() {
        let mut transcript = vec![
            exchange(super::super::OPENING, "There is a bed in the middle and a lamp on the left."),
            exchange("Which room is this?", "It is a bedroom."),
        ];
        assert_eq!(RulesAsker.next_question(&transcript).unwrap().unwrap(), "Is there a wardrobe?");
        transcript.push(exchange("Is there a wardrobe?", "No, there is no wardrobe."));
        assert_eq!(RulesAsker.next_question(&transcript).unwrap().unwrap(), "Is there a nightstand?");
    }

    #[test]
    fn it_comes_to_an_end() {
        let mut transcript = vec![exchange(super::super::OPENING, "There is a bed in the middle.")];
        while let Some(question) = RulesAsker.next_question(&transcript).unwrap() {
            transcript.push(exchange(&question, "I am not sure."));
            assert!(transcript.len() < 12, "{transcript:#?}");
        }
    }
}
