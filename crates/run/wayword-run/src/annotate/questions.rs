//! Questions about single frames with their answers, made of what a witness answered about the picture.

use serde_json::{Value, json};
use wayword_core::{Caption, ObjectSighting, ViewThird, WitnessAnswer};
use wayword_language::lexicon::find_thing;

/// A question about a picture, and its answer in one of LeRobot's forms.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PictureQuestion {
    pub(super) question: String,
    pub(super) answer: Value,
}

/// The question that a caption answers best: the room where it is new, or else the colour or the place of the thing that stands out most
/// among those that are sure.
pub(super) fn question_for(
    caption: &Caption,
    new_room: Option<&str>,
    is_sure: &dyn Fn(&ObjectSighting) -> bool,
) -> Option<PictureQuestion> {
    if let Some(room) = new_room {
        return Some(PictureQuestion {
            question: "Which room is this?".to_owned(),
            answer: attribute("room", "kind", room),
        });
    }
    let seen = caption.sightings.iter().filter(|sighting| sighting.witness == WitnessAnswer::Seen && !sighting.several);
    // Of two things with one name it would not be known which is meant.
    let names: Vec<&str> = caption.sightings.iter().map(|sighting| sighting.name.as_str()).collect();
    let is_alone = |sighting: &&ObjectSighting| names.iter().filter(|name| **name == sighting.name).count() == 1;
    let salience = |sighting: &&ObjectSighting| {
        (sighting.stands_out, find_thing(&sighting.name).map_or(0, |thing| thing.salience))
    };
    let best = seen
        .filter(is_alone)
        .filter(|sighting| is_sure(sighting) && (sighting.colour.is_some() || sighting.place.is_some()))
        .max_by_key(salience)?;
    let name = &best.name;
    if let Some(colour) = &best.colour {
        let question = format!("What colour is the {name}?");
        return Some(PictureQuestion { question, answer: attribute(name, "colour", colour) });
    }
    let place = match best.place? {
        ViewThird::Left => "left",
        ViewThird::Middle => "middle",
        ViewThird::Right => "right",
    };
    let question = format!("Where in the picture is the {name}: left, middle or right?");
    Some(PictureQuestion { question, answer: attribute(name, "position", place) })
}

fn attribute(label: &str, attribute: &str, value: &str) -> Value {
    json!({"attribute": attribute, "label": label, "value": value})
}

#[cfg(test)]
mod tests {
    use super::*;

    fn caption(room: Option<&str>, names: &[&str]) -> Caption {
        let sighting = |name: &&str| ObjectSighting {
            colour: Some("red".to_owned()),
            ..ObjectSighting::new(*name, WitnessAnswer::Seen, "server/eye")
        };
        Caption { room: room.map(str::to_owned), sightings: names.iter().map(sighting).collect(), ..Caption::default() }
    }

    fn asked(caption: &Caption, new_room: Option<&str>) -> Option<String> {
        question_for(caption, new_room, &|sighting| sighting.name != "ghost")
            .map(|asked| format!("{} {}", asked.question, asked.answer["value"]))
    }

    #[test]
    fn a_new_room_is_asked_for_first() {
        let caption = caption(Some("kitchen"), &["sofa"]);
        assert_eq!(asked(&caption, Some("kitchen")).unwrap(), "Which room is this? \"kitchen\"");
        assert_eq!(asked(&caption, None).unwrap(), "What colour is the sofa? \"red\"");
    }

    #[test]
    fn a_thing_that_may_be_one_of_two_is_not_asked_about() {
        assert_eq!(asked(&caption(None, &["chair", "chair"]), None), None);
        assert_eq!(asked(&caption(None, &["ghost"]), None), None);
        let mut several = caption(None, &["chair"]);
        several.sightings[0].several = true;
        assert_eq!(asked(&several, None), None);
    }
}
