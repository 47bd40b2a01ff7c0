//! The summariser that works by rules: it lists the sightings of a dialogue in one sentence.

use super::{
    CaptionSummariser, CondensedCaption,
    answers::{denial_covers, dialogue_room, dialogue_sightings},
    faults::caption_faults,
};
use wayword_core::{Caption, DialogueExchange, ModelError, ObjectSighting, ViewThird, WitnessAnswer};
use wayword_language::{
    lexicon::{counted_name, find_thing, with_article},
    text::{capitalise_first, word_count},
};

/// Writes a caption of the things that answers affirmed, and leaves out denied and doubtful ones, so that
/// [`caption_faults`] is empty for it.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesSummariser;

impl CaptionSummariser for RulesSummariser {
    fn name(&self) -> &str {
        "rules"
    }

    fn sum_up(&self, transcript: &[DialogueExchange], answerer: &str) -> Result<Caption, ModelError> {
        let sightings = dialogue_sightings(transcript, answerer);
        let room = dialogue_room(transcript);
        let text = caption_from_sightings(room.as_deref(), &sightings);
        Ok(Caption { text, room, sightings, transcript: transcript.to_vec(), ..Caption::default() })
    }

    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<CondensedCaption, ModelError> {
        let captions: Vec<&Caption> = captions.iter().map(|(_, caption)| *caption).collect();
        Ok(CondensedCaption { text: condense_captions(&captions, fewer_words_than), by: None })
    }
}

/// The caption of the seen things in `sightings`. Names may be any words, and two adjacent names may read as a third.
/// So names that would cause a fault are left out, and as a last resort the room too.
pub(crate) fn caption_from_sightings(room: Option<&str>, sightings: &[ObjectSighting]) -> String {
    let is_denied =
        |seen: &ObjectSighting| sightings.iter().any(|other| denial_covers(other, &seen.name, seen.colour.as_deref()));
    let mut seen: Vec<&ObjectSighting> =
        sightings.iter().filter(|sighting| sighting.witness == WitnessAnswer::Seen && !is_denied(sighting)).collect();
    let text = compose_caption(room, &seen);
    if caption_faults(&text, sightings).is_empty() {
        return text;
    }
    seen.retain(|sighting| caption_faults(&compose_caption(None, &[sighting]), sightings).is_empty());
    let texts = [compose_caption(room, &seen), compose_caption(None, &seen)];
    let good = texts.into_iter().find(|text| caption_faults(text, sightings).is_empty());
    good.unwrap_or_else(|| compose_caption(None, &[]))
}

/// "A bedroom with a bed in the middle and several lamps on the left."
fn compose_caption(room: Option<&str>, seen: &[&ObjectSighting]) -> String {
    let place = |place: ViewThird| match place {
        ViewThird::Left => " on the left",
        ViewThird::Middle => " in the middle",
        ViewThird::Right => " on the right",
    };
    let item = |sighting: &&ObjectSighting| {
        let name = [sighting.colour.as_deref(), sighting.material.as_deref(), Some(sighting.name.as_str())];
        let name = name.into_iter().flatten().collect::<Vec<_>>().join(" ");
        // Any count above six gives "several".
        let name = if sighting.several { counted_name(7, &name) } else { with_article(&name) };
        format!("{name}{}", sighting.place.map_or("", place))
    };
    let items: Vec<String> = seen.iter().map(item).collect();
    let room = room.map_or("a place".to_owned(), with_article);
    capitalise_first(&if items.is_empty() {
        format!("{room}.")
    } else {
        format!("{room} with {}.", join_with_and(&items))
    })
}

/// "A", "a and b", "a, b and c".
fn join_with_and(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [only] => only.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

/// Several captions of one place as one description of under `fewer_words_than` words: the room, then the most salient
/// things (arXiv 2403.11487 condenses four captions to under 20 words).
fn condense_captions(captions: &[&Caption], fewer_words_than: usize) -> String {
    let room = captions.iter().find_map(|caption| caption.room.as_deref());
    let seen = captions
        .iter()
        .flat_map(|caption| &caption.sightings)
        .filter(|sighting| sighting.witness == WitnessAnswer::Seen);
    let mut names: Vec<&str> = Vec::new();
    for sighting in seen {
        if !names.contains(&sighting.name.as_str()) {
            names.push(&sighting.name);
        }
    }
    names.sort_by_key(|name| std::cmp::Reverse(find_thing(name).map_or(0, |thing| thing.salience)));
    let text = |count: usize| {
        let items: Vec<String> = names[..count].iter().map(|name| with_article(name)).collect();
        let room = room.map_or("a place".to_owned(), with_article);
        if items.is_empty() { room } else { format!("{room} with {}", join_with_and(&items)) }
    };
    let fits = |count: &usize| word_count(&text(*count)) < fewer_words_than;
    (0..=names.len()).rev().find(fits).map_or_else(String::new, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn exchange(question: &str, answer: &str) -> DialogueExchange {
        DialogueExchange::new(question, answer)
    }

    #[test]
    fn a_denied_thing_is_a_sighting_but_not_in_the_caption() {
        let transcript = [
            exchange(super::super::OPENING_REQUEST, "There is a bed in the middle and a mirror on the left."),
            exchange("Which room is this?", "It is a bedroom."),
            exchange("Is there a mirror?", "No, there is no mirror."),
        ];
        let caption = RulesSummariser.sum_up(&transcript, "test").unwrap();
        assert_eq!(caption.text, "A bedroom with a bed in the middle.");
        assert!(caption.sightings.iter().any(|s| s.name == "mirror" && s.witness == WitnessAnswer::Denied));
    }

    #[test]
    fn four_captions_are_condensed_to_under_twenty_words() {
        let list = "There is a bed in the middle, a side table on the left, a floor lamp on the left, a picture on the right, \
                    a window on the right, a rug in the middle and a chair on the right.";
        let transcript =
            [exchange(super::super::OPENING_REQUEST, list), exchange("Which room is this?", "It is a bedroom.")];
        let caption = RulesSummariser.sum_up(&transcript, "test").unwrap();
        let short = condense_captions(&[&caption, &caption], 20);
        assert!(word_count(&short) < 20, "{short}");
        assert!(short.starts_with("a bedroom with a bed"), "{short}");
    }

    #[test]
    fn a_denial_of_a_kind_covers_its_members_but_not_the_reverse() {
        let opening = exchange(super::super::OPENING_REQUEST, "There are two dining chairs, a table and a red sofa.");
        let text = |question: &str, answer: &str| {
            RulesSummariser.sum_up(&[opening.clone(), exchange(question, answer)], "test").unwrap().text
        };
        assert_eq!(text("Are there any chairs?", "No."), "A place with a table and a red sofa.");
        assert_eq!(
            text("Is there a coffee table?", "No."),
            "A place with several dining chairs, a table and a red sofa."
        );
        assert_eq!(text("Is there a red sofa?", "No."), "A place with several dining chairs and a table.");
        assert_eq!(
            text("Is there a green sofa?", "No."),
            "A place with several dining chairs, a table and a red sofa."
        );
    }

    fn phrase() -> impl Strategy<Value = String> {
        let things = prop::sample::select(vec![
            "bed",
            "red chair",
            "chair",
            "dining chairs",
            "couch",
            "stairs",
            "bar",
            "white board",
            "oven and stove",
            "gizmo",
            "toilet",
            "kitchen table",
            "picture",
            "light",
            "landing",
            "bath towel",
            "wall",
            "teal",
        ]);
        let forms = prop::sample::select(vec![
            "There is a {} on the left.",
            "No, there is no {}.",
            "a {} or a {}",
            "maybe a {}",
            "It is a {}.",
            "Yes",
            "No.",
            "The {} is red.",
            "The picture shows a {} with a {}",
            "I don't see any {}, {} or {}",
            "{} {} {}",
            "not a {} but a {}",
            "There is a {} in the middle, two {} on the left and some {} on the right.",
            "I am not sure.",
        ]);
        (forms, prop::collection::vec(things, 3))
            .prop_map(|(form, things)| things.iter().fold(form.to_owned(), |text, thing| text.replacen("{}", thing, 1)))
    }

    fn question() -> impl Strategy<Value = String> {
        let forms = prop::sample::select(vec![
            "Is there a {}?",
            "What colour is the {}?",
            "Are there any {}?",
            "Which room is this?",
            "Is this a {}?",
            "What is here?",
            "Is there a red {}?",
            "How many {} are there?",
            "Where is the {}?",
        ]);
        let things = prop::sample::select(vec![
            "bed",
            "chair",
            "couch",
            "staircase",
            "bar",
            "dining chair",
            "kitchen",
            "toilet",
        ]);
        (forms, things).prop_map(|(form, thing)| form.replace("{}", thing))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn no_transcript_gives_a_caption_with_faults(exchanges in prop::collection::vec((question(), phrase()), 1..7)) {
            let transcript: Vec<DialogueExchange> = exchanges.iter().map(|(question, answer)| exchange(question, answer)).collect();
            let caption = RulesSummariser.sum_up(&transcript, "test").unwrap();
            prop_assert_eq!(caption_faults(&caption.text, &caption.sightings), vec![], "{}", caption.text);
        }

        #[test]
        fn any_words_can_be_summed_up(
            exchanges in prop::collection::vec(("(\\PC|[\n?.,]){0,40}", "(\\PC|[\n?.,]){0,120}"), 0..4),
        ) {
            let transcript: Vec<DialogueExchange> = exchanges.iter().map(|(question, answer)| exchange(question, answer)).collect();
            let caption = RulesSummariser.sum_up(&transcript, "test").unwrap();
            prop_assert_eq!(caption_faults(&caption.text, &caption.sightings), vec![], "{}", caption.text);
        }
    }
}
