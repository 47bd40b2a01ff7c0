//! The asker that works by rules: a fixed order of questions about the room, doubtful things, usual things and colours.

use super::{
    QuestionAsker,
    answers::{dialogue_room, dialogue_sightings},
};
use wayword_core::{DialogueExchange, ModelError, ObjectSighting, WitnessAnswer};
use wayword_language::lexicon::{ThingClass, find_thing, is_plural, names_agree, room_name, to_plural, with_article};

/// Asks which room it is; whether objects of the first description are really there, if that may be doubted; whether
/// there are things that a room of this kind usually has and no answer mentioned; and the colours of landmarks.
///
/// The default asks about no doubts, which suits an answerer that names only real things, as `labels` does.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesAsker {
    /// Most objects of the first description that the asker asks about again, to learn whether they are really there.
    doubts: usize,
}

/// A model's description may name hallucinated objects, so most of the nine questions check for them, and two are left
/// for colours.
const MAX_DOUBT_QUESTIONS: usize = 6;

impl RulesAsker {
    /// An asker for an answerer that may name objects that are not there.
    #[must_use]
    pub fn for_models() -> Self {
        Self { doubts: MAX_DOUBT_QUESTIONS }
    }
}

/// Most usual objects of a room that the asker asks for although no answer named them. A "no" is evidence too, but each
/// costs a question.
const MAX_PROBE_QUESTIONS: usize = 3;
/// Most landmarks of which the asker asks the colour.
const MAX_COLOUR_QUESTIONS: usize = 2;

/// Things that rooms usually have. The asker asks for those that no answer mentioned.
const USUAL_ROOM_THINGS: &[(&str, &[&str])] = &[
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
/// Things to ask for in any other room.
const USUAL_ANYWHERE: &[&str] = &["table", "chair", "stairs"];

impl QuestionAsker for RulesAsker {
    fn name(&self) -> &str {
        "rules"
    }

    fn next_question(&self, transcript: &[DialogueExchange]) -> Result<Option<String>, ModelError> {
        let asked = |question: &str| transcript.iter().any(|exchange| exchange.question == question);
        let room_question = super::FIXED_QUERIES[1];
        if !asked(room_question) {
            return Ok(Some(room_question.to_owned()));
        }
        if let Some(doubt) = doubt_questions(transcript).into_iter().take(self.doubts).find(|question| !asked(question))
        {
            return Ok(Some(doubt));
        }
        let sightings = dialogue_sightings(transcript, "");
        let probe = probe_questions(transcript, &sightings).into_iter().find(|question| !asked(question));
        let is_probe = |question: &str| question.starts_with("Is there ") && !question.starts_with("Is there really ");
        let probed = transcript.iter().filter(|exchange| is_probe(&exchange.question)).count();
        Ok(probe
            .filter(|_| probed < MAX_PROBE_QUESTIONS)
            .or_else(|| colour_questions(&sightings).into_iter().find(|question| !asked(question))))
    }
}

/// Questions whether the things of the first description are really there, the most salient first. Walls, doors and
/// small things get none.
fn doubt_questions(transcript: &[DialogueExchange]) -> Vec<String> {
    let opening = transcript.get(..1).unwrap_or_default();
    let named = dialogue_sightings(opening, "");
    let salience = |sighting: &ObjectSighting| {
        let judged =
            find_thing(&sighting.name).filter(|thing| !matches!(thing.class, ThingClass::Fabric | ThingClass::Door));
        judged.map_or(0, |thing| thing.salience)
    };
    let mut named: Vec<&ObjectSighting> = named.iter().filter(|sighting| salience(sighting) > 0).collect();
    named.sort_by_key(|sighting| std::cmp::Reverse(salience(sighting)));
    let mut questions: Vec<String> = Vec::new();
    for sighting in named {
        let question = if sighting.several || is_plural(&sighting.name) {
            format!("Are there really any {}?", to_plural(&sighting.name))
        } else {
            format!("Is there really {}?", with_article(&sighting.name))
        };
        if !questions.contains(&question) {
            questions.push(question);
        }
    }
    questions
}

/// Questions for the things that a room of this kind usually has and no sighting names.
fn probe_questions(transcript: &[DialogueExchange], sightings: &[ObjectSighting]) -> Vec<String> {
    let room = dialogue_room(transcript).unwrap_or_default();
    let room = room_name(&room).unwrap_or_default();
    let usual = USUAL_ROOM_THINGS.iter().find(|(name, _)| *name == room).map_or(USUAL_ANYWHERE, |(_, things)| things);
    let unnamed = usual.iter().filter(|name| !sightings.iter().any(|sighting| names_agree(&sighting.name, name)));
    unnamed.map(|name| format!("Is there {}?", with_article(name))).collect()
}

/// Questions for the colours of seen things that make good landmarks.
fn colour_questions(sightings: &[ObjectSighting]) -> Vec<String> {
    let seen = sightings
        .iter()
        .filter(|sighting| sighting.witness == WitnessAnswer::Seen && !sighting.several && sighting.colour.is_none());
    let landmarks = seen.filter(|sighting| find_thing(&sighting.name).is_some_and(|thing| thing.salience >= 2));
    landmarks.take(MAX_COLOUR_QUESTIONS).map(|sighting| format!("What colour is the {}?", sighting.name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exchange(question: &str, answer: &str) -> DialogueExchange {
        DialogueExchange::new(question, answer)
    }

    #[test]
    fn asker_probes_for_usual_things_that_no_answer_named() {
        let mut transcript = vec![
            exchange(super::super::OPENING_REQUEST, "There is a bed in the middle and a lamp on the left."),
            exchange("Which room is this?", "It is a bedroom."),
        ];
        assert_eq!(RulesAsker::default().next_question(&transcript).unwrap().unwrap(), "Is there a wardrobe?");
        transcript.push(exchange("Is there a wardrobe?", "No, there is no wardrobe."));
        assert_eq!(RulesAsker::default().next_question(&transcript).unwrap().unwrap(), "Is there a nightstand?");
    }

    #[test]
    fn it_comes_to_an_end() {
        let mut transcript = vec![exchange(super::super::OPENING_REQUEST, "There is a bed in the middle.")];
        while let Some(question) = RulesAsker::default().next_question(&transcript).unwrap() {
            transcript.push(exchange(&question, "I am not sure."));
            assert!(transcript.len() < 12, "{transcript:#?}");
        }
    }

    #[test]
    fn asker_doubts_named_things_by_salience() {
        let mut transcript = vec![
            exchange(super::super::OPENING_REQUEST, "A bedroom with two lamps, a bed, a white wall and a mirror."),
            exchange("Which room is this?", "It is a bedroom."),
        ];
        let mut asked = Vec::new();
        while let Some(question) = RulesAsker::for_models().next_question(&transcript).unwrap() {
            transcript.push(exchange(&question, "No."));
            asked.push(question);
        }
        assert_eq!(
            asked,
            [
                "Is there really a bed?",
                "Are there really any lamps?",
                "Is there really a mirror?",
                "Is there a wardrobe?",
                "Is there a nightstand?"
            ]
        );
    }

    #[test]
    fn asker_doubts_at_most_the_set_number_of_things() {
        let opening = "There is a bed, a mirror, a lamp, a rug, a desk, a sofa, a piano, a stove and a tree.";
        let mut transcript = vec![exchange(super::super::OPENING_REQUEST, opening)];
        while let Some(question) = RulesAsker::for_models().next_question(&transcript).unwrap() {
            transcript.push(exchange(&question, "Yes."));
            assert!(transcript.len() < 20);
        }
        let doubted = transcript.iter().filter(|exchange| exchange.question.contains("really")).count();
        assert_eq!(doubted, MAX_DOUBT_QUESTIONS);
    }
}
