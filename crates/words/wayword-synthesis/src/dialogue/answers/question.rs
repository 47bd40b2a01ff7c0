//! Finds out what a question asks for, so that its answer can be interpreted: whether a thing is there, its colour,
//! number or place, or the room.

use super::phrases::{
    QuestionThing, all_wanted, colour_at, first_colour, first_wanted, noun_phrase, place_phrases, question_thing,
};
use wayword_core::ViewThird;
use wayword_language::{
    answers::LEADS,
    lexicon::{is_room, normalise_name},
    text::split_tokens,
};

/// What a question asks for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum QuestionSubject {
    /// Whether things are there.
    Presence {
        /// One, or several with "or" or "and" between them.
        wanted: Vec<QuestionThing>,
        /// Whether they are alternatives ("a bed or a sofa"): a yes to them is not a yes to each.
        are_alternatives: bool,
    },
    /// The colour of a thing, which the question takes to be there.
    Colour {
        /// The thing, as the question names it.
        name: String,
        /// Colours that the question names.
        guesses: Vec<String>,
    },
    /// How many of a thing there are.
    Number(QuestionThing),
    /// Where a thing is, which the question takes to be there.
    Place(QuestionThing),
    /// Which room it is.
    Room,
    /// Whether it is this room.
    IsRoom(String),
    /// Anything else, with the part of the view that it asks about, if any.
    Other(Option<ViewThird>),
}

/// Reads a question: tries one kind of question after the other, the most special first.
pub(crate) fn read_question(question: &str) -> QuestionSubject {
    // "Look again and answer in one short sentence: ...": only the words after the colon matter.
    let question = question.rsplit_once(": ").map_or(question, |(_, rest)| rest);
    let tokens = split_tokens(question);
    let words: Vec<&str> = tokens.iter().map(|token| token.word.as_str()).collect();
    let skipped = words.iter().take_while(|word| LEADS.contains(word)).count();
    let words = &words[skipped..];
    room_question(words)
        .or_else(|| colour_question(question, words))
        .or_else(|| number_question(words))
        .or_else(|| place_question(words))
        .or_else(|| identity_question(words))
        .or_else(|| presence_question(words))
        .unwrap_or_else(|| QuestionSubject::Other(place_phrases(words).first().map(|phrase| phrase.place)))
}

/// Whether words contain these words in a row.
fn has_run(words: &[&str], run: &[&str]) -> bool {
    words.windows(run.len()).any(|window| window == run)
}

/// "Which room is this?", "What kind of place is it?", "Where was the picture taken?"
fn room_question(words: &[&str]) -> Option<QuestionSubject> {
    let asks = ["which", "what"].contains(words.first()?);
    let kind = |noun: &str| ["kind", "type", "sort"].iter().any(|kind| has_run(words, &[kind, "of", noun]));
    let place = ["room", "place", "space", "area"].into_iter().any(kind);
    let which = has_run(words, &["which", "room"])
        || has_run(words, &["what", "room"])
        || has_run(words, &["room", "is", "this"])
        || has_run(words, &["what", "is", "this", "room"])
        || has_run(words, &["what", "is", "the", "room"]);
    let taken = words.first() == Some(&"where") && words.iter().any(|word| matches!(*word, "taken" | "are"));
    ((asks && (place || which)) || (taken && (has_run(words, &["picture"]) || has_run(words, &["image"]))))
        .then_some(QuestionSubject::Room)
}

/// "What colour is the lamp?", "Is the sofa brown or black?".
fn colour_question(question: &str, words: &[&str]) -> Option<QuestionSubject> {
    // The form of the asker by rules, where a name may have any words, marks and spelling.
    if let Some(name) = question.strip_prefix("What colour is the ").and_then(|rest| rest.strip_suffix('?')) {
        return Some(QuestionSubject::Colour { name: name.to_owned(), guesses: Vec::new() });
    }
    let at = words.iter().position(|word| matches!(*word, "colour" | "color" | "colours" | "colors"));
    let rest = match at {
        Some(at) if at <= 4 => match words.get(at + 1)? {
            &"is" | &"are" | &"of" | &"was" => &words[at + 2..],
            _ => return None,
        },
        _ => {
            let (verb, rest) = words.split_first()?;
            let colours = (0..rest.len()).any(|at| colour_at(&rest[at..]).is_some() && ends_phrase(rest, at));
            (matches!(*verb, "is" | "are") && rest.first() == Some(&"the") && colours).then_some(rest)?
        }
    };
    let guesses =
        if at.is_some() { Vec::new() } else { (0..rest.len()).filter_map(|at| first_colour(&rest[at..=at])).collect() };
    let end = (0..rest.len()).find(|at| !guesses.is_empty() && colour_at(&rest[*at..]).is_some()).unwrap_or(rest.len());
    let wanted = first_wanted(&rest[..end])?;
    Some(QuestionSubject::Colour { name: wanted.name, guesses })
}

/// Whether the colour at a word describes the words before it, and not a noun after it.
fn ends_phrase(words: &[&str], at: usize) -> bool {
    at > 1 && words.get(at + 1).is_none_or(|next| matches!(*next, "or" | "?" | "and" | "in" | ","))
}

/// "How many chairs are there?"
fn number_question(words: &[&str]) -> Option<QuestionSubject> {
    let rest = words.strip_prefix(&["how", "many"])?;
    first_wanted(rest).map(QuestionSubject::Number)
}

/// "Where is the lamp?", "On which side is the lamp?"
fn place_question(words: &[&str]) -> Option<QuestionSubject> {
    let rest = match words {
        ["where", "is" | "are", rest @ ..] => rest,
        ["where", "in", _, _, "is" | "are", rest @ ..] => rest,
        ["on", "which" | "what", "side", "is" | "are", rest @ ..] => rest,
        _ => return None,
    };
    first_wanted(rest).map(QuestionSubject::Place)
}

/// "Is this a kitchen?", "Is that a mirror on the wall?".
fn identity_question(words: &[&str]) -> Option<QuestionSubject> {
    let rest = match words {
        ["is" | "are", "this" | "that" | "it" | "these" | "those", rest @ ..] => rest,
        ["is", "the", "room", rest @ ..] => rest,
        _ => return None,
    };
    let rest = rest.strip_prefix(&["room"]).unwrap_or(rest);
    let name = noun_phrase(rest, &mut 0)?;
    let or = rest.contains(&"or");
    match question_thing(&name, None) {
        _ if is_room(&normalise_name(&name.join(" "))) && !or => Some(QuestionSubject::IsRoom(name.join(" "))),
        _ if is_room(&normalise_name(&name.join(" "))) => Some(QuestionSubject::Room),
        _ => all_wanted(rest).filter(|_| !matches!(words[1], "it" | "the")).map(presence_of),
    }
}

/// "Is there a lamp?", "Can you see a lamp?", "Any lamps?"
fn presence_question(words: &[&str]) -> Option<QuestionSubject> {
    let rest = match words {
        ["is" | "are" | "was" | "were", "there", rest @ ..] => rest,
        ["do" | "did" | "can" | "could" | "would", "you", rest @ ..] => {
            after_verb(rest, &["see", "spot", "find", "notice", "out", "identify", "detect", "confirm", "observe"])?
        }
        ["does" | "do", rest @ ..] => after_verb(rest, &["have", "contain", "show", "include", "feature"])?,
        ["are", "you", "sure", rest @ ..] => rest,
        ["is", "it", "true", rest @ ..] => rest,
        ["any", ..] => words,
        ["is" | "are", rest @ ..] => return really_there(rest),
        _ => return None,
    };
    let skipped = rest
        .iter()
        .take_while(|word| matches!(**word, "that" | "if" | "whether" | "there" | "is" | "are" | "you" | "see"))
        .count();
    all_wanted(&rest[skipped..]).map(presence_of)
}

/// Makes the question for the presence of the things that [`all_wanted`] found.
fn presence_of((wanted, are_alternatives): (Vec<QuestionThing>, bool)) -> QuestionSubject {
    QuestionSubject::Presence { wanted, are_alternatives }
}

/// The words after one of these verbs, if it comes early.
fn after_verb<'a, 'b>(words: &'a [&'b str], verbs: &[&str]) -> Option<&'a [&'b str]> {
    let at = words.iter().take(5).position(|word| verbs.contains(word))?;
    Some(&words[at + 1..])
}

/// "Is the lamp you mentioned really there?", "Is a mirror visible in the picture?".
fn really_there(words: &[&str]) -> Option<QuestionSubject> {
    let tail = |run: &[&str]| words.strip_suffix(&["?"]).unwrap_or(words).ends_with(run);
    let visible = ["there", "present", "visible", "real"].iter().any(|end| tail(&[end]));
    let whole = ["picture", "image", "room", "photo", "scene", "view"];
    let shown = whole.iter().any(|whole| tail(&["in", "the", whole]) || tail(&["in", "this", whole]));
    (visible || shown).then(|| all_wanted(words)).flatten().map(presence_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn presence(question: &str) -> Option<(Vec<String>, bool)> {
        match read_question(question) {
            QuestionSubject::Presence { wanted, are_alternatives: or } => {
                Some((wanted.into_iter().map(|wanted| wanted.name).collect(), or))
            }
            _ => None,
        }
    }

    #[test]
    fn questions_for_one_thing_are_understood_in_all_their_forms() {
        for (question, name) in [
            ("Is there a mirror?", "mirror"),
            ("Is there really a mirror?", "mirror"),
            ("Are there any chairs in the room?", "chair"),
            ("Do you see a lamp?", "lamp"),
            ("Can you see any stairs?", "stairs"),
            ("Is the lamp you mentioned really there?", "lamp"),
            ("Does the room have a fireplace?", "fireplace"),
            ("Does this picture show any plants?", "plant"),
            ("Is a mirror visible in the picture?", "mirror"),
            ("Are you sure that there is a piano?", "piano"),
            ("And is there also a coffee table?", "coffee table"),
            ("Is there a flight of stairs leading up?", "flight of stairs"),
            ("Is there a chest of drawers?", "chest of drawers"),
            ("Is there a large red sofa on the left side?", "sofa"),
            ("Is there a shiny gizmo?", "shiny gizmo"),
            ("Is that a mirror on the wall?", "mirror"),
            ("Can you confirm that there is a television?", "television"),
            ("Is there any sign of a dog?", "dog"),
            ("Is the mirror in the picture?", "mirror"),
        ] {
            assert_eq!(presence(question), Some((vec![name.to_owned()], false)), "{question}");
        }
    }

    #[test]
    fn read_question_distinguishes_alternatives_from_pairs() {
        let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        assert_eq!(presence("Is there a bed or a sofa?"), Some((names(&["bed", "sofa"]), true)));
        assert_eq!(presence("Do you see a table and chairs?"), Some((names(&["table", "chair"]), false)));
        assert_eq!(presence("Are there any lamps, mirrors, or rugs?"), Some((names(&["lamp", "mirror", "rug"]), true)));
    }

    #[test]
    fn vague_questions_ask_for_no_thing() {
        for question in [
            "Is there anything on the table?",
            "Are there any other objects?",
            "Is there more than one chair?",
            "Is the lamp on the table?",
            "What is the sofa made of?",
            "Is there a person?",
            "?",
            "",
        ] {
            assert_eq!(presence(question), None, "{question}");
        }
    }

    #[test]
    fn read_question_distinguishes_colours_numbers_places_and_rooms() {
        let colour = |name: &str, guesses: &[&str]| QuestionSubject::Colour {
            name: name.into(),
            guesses: guesses.iter().map(|guess| (*guess).to_owned()).collect(),
        };
        assert_eq!(read_question("What colour is the sofa?"), colour("sofa", &[]));
        assert_eq!(read_question("What color are the chairs?"), colour("chair", &[]));
        assert_eq!(read_question("What is the color of the rug on the floor?"), colour("rug", &[]));
        assert_eq!(read_question("Is the sofa brown or black?"), colour("sofa", &["brown", "black"]));
        assert!(
            matches!(read_question("How many chairs are there?"), QuestionSubject::Number(wanted) if wanted.name == "chair")
        );
        assert!(matches!(read_question("Where is the lamp?"), QuestionSubject::Place(wanted) if wanted.name == "lamp"));
        for question in
            ["Which room is this?", "What kind of room is this?", "What type of room is shown in the image?"]
        {
            assert_eq!(read_question(question), QuestionSubject::Room, "{question}");
        }
        assert_eq!(read_question("Is this a kitchen?"), QuestionSubject::IsRoom("kitchen".into()));
        assert_eq!(
            read_question("What is on the left side of the room?"),
            QuestionSubject::Other(Some(ViewThird::Left))
        );
    }

    #[test]
    fn read_question_returns_the_colour_and_the_place() {
        let QuestionSubject::Presence { wanted, .. } = read_question("Is there a red chair on the right?") else {
            panic!()
        };
        assert_eq!((wanted[0].phrase.as_str(), wanted[0].colour.as_deref()), ("red chair", Some("red")));
        assert_eq!(wanted[0].place, Some(ViewThird::Right));
    }
}
