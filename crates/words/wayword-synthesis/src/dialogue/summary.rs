//! The summariser that works by rules.

use super::{
    Summariser,
    answers::{counted, is_denied, room, sightings, with_article},
};
use crate::lexicon::thing;
use wayword_core::{Caption, Exchange, ModelError, Sighting, Where, Witness};

/// Writes a caption from what was said to be there, and leaves out what was denied or not known.
#[derive(Debug, Clone, Copy, Default)]
pub struct RulesSummariser;

impl Summariser for RulesSummariser {
    fn name(&self) -> &str {
        "rules"
    }

    fn sum_up(&self, transcript: &[Exchange], answerer: &str) -> Result<Caption, ModelError> {
        let told = sightings(transcript, answerer);
        let room = room(transcript);
        let seen: Vec<&Sighting> = told
            .iter()
            .filter(|sighting| sighting.witness == Witness::Seen && !is_denied(&sighting.name, &told))
            .collect();
        let text = caption(room.as_deref(), &seen);
        Ok(Caption { text, room, sightings: told, transcript: transcript.to_vec(), by: None })
    }

    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<String, ModelError> {
        let captions: Vec<&Caption> = captions.iter().map(|(_, caption)| *caption).collect();
        Ok(condense(&captions, fewer_words_than))
    }
}

fn caption(room: Option<&str>, seen: &[&Sighting]) -> String {
    let place = |place: Where| match place {
        Where::Left => " on the left",
        Where::Middle => " in the middle",
        Where::Right => " on the right",
    };
    let item = |sighting: &&Sighting| {
        let name =
            sighting.colour.as_ref().map_or(sighting.name.clone(), |colour| format!("{colour} {}", sighting.name));
        let name = if sighting.several { counted(7, &name) } else { with_article(&name) };
        format!("{name}{}", sighting.place.map_or("", place))
    };
    let items: Vec<String> = seen.iter().map(item).collect();
    let room = room.map_or("a place".to_owned(), with_article);
    let text = if items.is_empty() { format!("{room}.") } else { format!("{room} with {}.", enumerate(&items)) };
    let mut letters = text.chars();
    letters.next().map_or(text.clone(), |first| first.to_uppercase().chain(letters).collect())
}

fn enumerate(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [only] => only.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

/// Several captions of one place as one description of under `fewer_words_than` words: the room, then the landmarks that
/// stand out most (arXiv 2403.11487 condenses four captions to under 20 words).
fn condense(captions: &[&Caption], fewer_words_than: usize) -> String {
    let room = captions.iter().find_map(|caption| caption.room.as_deref());
    let seen =
        captions.iter().flat_map(|caption| &caption.sightings).filter(|sighting| sighting.witness == Witness::Seen);
    let mut names: Vec<&str> = Vec::new();
    for sighting in seen {
        if !names.contains(&sighting.name.as_str()) {
            names.push(&sighting.name);
        }
    }
    names.sort_by_key(|name| std::cmp::Reverse(thing(name).map_or(0, |thing| thing.salience)));
    let text = |count: usize| {
        let items: Vec<String> = names[..count].iter().map(|name| with_article(name)).collect();
        let room = room.map_or("a place".to_owned(), with_article);
        if items.is_empty() { room } else { format!("{room} with {}", enumerate(&items)) }
    };
    let fits = |count: &usize| crate::text::word_count(&text(*count)) < fewer_words_than;
    (0..=names.len()).rev().find(fits).map_or_else(String::new, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exchange(question: &str, answer: &str) -> Exchange {
        Exchange::new(question, answer)
    }

    #[test]
    fn what_was_denied_is_not_in_the_caption_but_is_kept() {
        let transcript = [
            exchange(super::super::OPENING, "There is a bed in the middle and a mirror on the left."),
            exchange("Which room is this?", "It is a bedroom."),
            exchange("Is there a mirror?", "No, there is no mirror."),
        ];
        let caption = RulesSummariser.sum_up(&transcript, "test").unwrap();
        assert_eq!(caption.text, "A bedroom with a bed in the middle.");
        assert!(caption.sightings.iter().any(|s| s.name == "mirror" && s.witness == Witness::Denied));
    }

    #[test]
    fn four_captions_are_condensed_to_under_twenty_words() {
        let list = "There is a bed in the middle, a side table on the left, a floor lamp on the left, a picture on the right, \
                    a window on the right, a rug in the middle and a chair on the right.";
        let transcript = [exchange(super::super::OPENING, list), exchange("Which room is this?", "It is a bedroom.")];
        let caption = RulesSummariser.sum_up(&transcript, "test").unwrap();
        let short = condense(&[&caption, &caption], 20);
        assert!(crate::text::word_count(&short) < 20, "{short}");
        assert!(short.starts_with("a bedroom with a bed"), "{short}");
    }
}
