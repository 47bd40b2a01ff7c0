//! Finds the closing task: "and water the plant on the windowsill" at the end of an instruction.

use super::{ClosingTask, EventContent, TextEvent, tokens::TokenSlice, vocabulary as v};
use crate::lexicon::{is_room, is_thing, normal_word};

/// The task that ends a text: the last clause with a verb, if that verb is not one of walking.
pub(super) fn closing_task(tokens: TokenSlice<'_>, events: &[TextEvent]) -> Option<ClosingTask> {
    let behind_adverbs = behind_adverbs(tokens);
    let mut starts = (0..tokens.len())
        .rev()
        .filter(|at| *at == 0 || !tokens.is_word(at - 1) || matches!(tokens.word_at(at - 1), "and" | "then"));
    let at = starts.find_map(|at| verb_at(tokens, behind_adverbs[at]))?;
    let verb = tokens.word_at(at).to_owned();
    if is_walking(tokens, at) {
        return None;
    }
    let object = events.iter().position(|event| {
        event.span[0] > tokens.span_of(at, at)[0] && matches!(&event.what, EventContent::Place(place) if place.is_thing)
    });
    Some(ClosingTask { verb, object })
}

/// For each token, the first one from there on that is not an adverb, because a verb follows the adverbs of its clause.
pub(super) fn behind_adverbs(tokens: TokenSlice<'_>) -> Vec<usize> {
    tokens.ends_of_runs(|word| v::ADVERBS.contains(&word))
}

/// The token of a clause's verb, given the first token after its adverbs; `None` where the clause has no verb.
pub(super) fn verb_at(tokens: TokenSlice<'_>, at: usize) -> Option<usize> {
    let word = |at: usize| tokens.word_at(at);
    let first = tokens.get(at).filter(|token| token.is_word())?.word.as_str();
    if v::WALKING.contains(&first) {
        return Some(at);
    }
    let takes_object = v::DETERMINERS.contains(&word(at + 1))
        || matches!(word(at + 1), "me" | "off" | "up" | "on" | "down" | "out" | "all" | "any" | "some");
    let name = normal_word(first);
    let is_name = v::ADJECTIVES.contains(&first) || is_thing(&name) || is_room(&name);
    let no_verb = v::FUNCTION.contains(&first)
        || (is_name && !takes_object)
        || (first.ends_with("ing") && first.len() > 5)
        || first.ends_with('s') && is_name;
    (!no_verb).then_some(at)
}

/// Whether a word that can name a thing is a verb here: "switch on the lamp", "vacuum the rug", "fan the fire".
pub(super) fn is_task_verb(tokens: TokenSlice<'_>, at: usize) -> bool {
    let (word, next, before) = (tokens.word_at(at), tokens.word_at(at + 1), tokens.word_before(at));
    let begins = at == 0 || !tokens.is_word(at - 1);
    let joined = v::ADVERBS.contains(&before) || matches!(before, "and" | "or");
    let object = matches!(next, "the" | "a" | "an" | "your" | "my" | "our" | "all" | "any" | "some" | "me" | "both");
    // "Past the sofa and chair on the left": only some verbs have one of these words behind them.
    let particle = matches!(
        (word, next),
        ("switch" | "light" | "shower", "on" | "off") | ("box" | "board" | "light" | "cover" | "hook", "up")
    );
    word != "room" && !word.ends_with('s') && (begins || joined) && (object || particle) && !is_walking(tokens, at)
}

/// Whether a verb is one of walking here: "take a left" is, "take the towel" is not.
fn is_walking(tokens: TokenSlice<'_>, at: usize) -> bool {
    let word = |at: usize| tokens.word_at(at);
    let turns = || {
        (at + 1..at + 5).map(word).any(|word| matches!(word, "left" | "right" | "stairs" | "door" | "steps" | "few"))
    };
    match word(at) {
        "take" => turns(),
        "turn" => {
            !(at + 1..at + 9)
                .map(word)
                .take_while(|word| *word != "." && *word != "and")
                .any(|word| matches!(word, "on" | "off" | "over" | "down" | "up"))
                || matches!(word(at + 1), "left" | "right" | "around")
        }
        "cut" | "get" | "pop" | "drop" | "carry" | "make" | "back" | "round" | "run" => {
            !(v::DETERMINERS.contains(&word(at + 1)) || matches!(word(at + 1), "me" | "on" | "off" | "all")) || turns()
        }
        "move" => !(v::DETERMINERS.contains(&word(at + 1)) || word(at + 1) == "all"),
        // "Find the lamp" is a task, "you find yourself in a hall" is not.
        "find" => word(at + 1) == "your" || word(at + 1) == "yourself",
        verb => v::WALKING.contains(&verb),
    }
}

#[cfg(test)]
mod tests {
    use crate::reading::{EventContent, read_instruction};
    use std::collections::BTreeSet;

    fn places(text: &str) -> Vec<String> {
        let events = read_instruction(text, &BTreeSet::new()).events.into_iter();
        let name = |what: EventContent| if let EventContent::Place(place) = what { Some(place.name) } else { None };
        events.filter_map(|event| name(event.what)).collect()
    }

    #[test]
    fn a_verb_that_can_name_a_thing_is_no_place() {
        for (text, wanted) in [
            ("Switch on the lamp", &["lamp"][..]),
            ("Go to the kitchen and switch off the light", &["kitchen", "light"]),
            ("Vacuum the rug", &["rug"]),
            ("Go to the kitchen and vacuum the rug", &["kitchen", "rug"]),
            ("Fan the plant", &["plant"]),
            ("Please water the plant", &["plant"]),
            ("Mop the kitchen floor", &["floor"]),
        ] {
            assert_eq!(places(text), wanted, "{text}");
        }
    }

    #[test]
    fn things_that_look_like_verbs_stay_places() {
        for (text, wanted) in [
            ("Press the switch on the wall", &["switch", "wall"][..]),
            ("Pass the sofa and chair on the left", &["sofa", "chair"]),
            ("Clean the vacuum", &["vacuum"]),
            ("Turn off the fan", &["fan"]),
            ("Walk to the bed, lamp on your left", &["bed", "lamp"]),
        ] {
            assert_eq!(places(text), wanted, "{text}");
        }
    }
}
