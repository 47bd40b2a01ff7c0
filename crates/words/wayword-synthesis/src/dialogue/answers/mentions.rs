//! Finds the things and rooms that a free text names, and for each whether it is affirmed or denied, its place and its
//! colour.

use super::{
    phrases::{PlacePhrase, colour_said_of, place_phrases},
    polarity::AnswerSentence,
};
use std::{collections::BTreeSet, ops::Range};
use wayword_core::{ViewThird, WitnessAnswer};
use wayword_language::{
    answers::{BRINGS_IN, MATERIALS, NO_OBJECTS, NUMBERS, OTHERS, PERCEIVING, QUALITIES, TELLS_NOTHING},
    lexicon::{find_thing, means_several, names_agree, normalise_name, to_singular},
    reading::{
        EventContent, TextReading, read_instruction,
        vocabulary::{ABSTRACT, BREAKERS, COLOURS},
    },
    text::TextToken,
};

/// Something that a text names.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::dialogue) struct AnswerMention {
    /// Its name, in the singular if it has one. A denied thing keeps the words that distinguish it: "red chair".
    pub(in crate::dialogue) name: String,
    /// Whether the name can mean a thing. "Stairs" can mean a thing and a room.
    pub(in crate::dialogue) is_thing: bool,
    /// Whether the name can mean a room.
    pub(in crate::dialogue) is_room: bool,
    /// Whether the text affirms, denies or doubts it.
    pub(in crate::dialogue) witness: WitnessAnswer,
    pub(in crate::dialogue) colour: Option<String>,
    /// Its place in the view, where the text gives one.
    pub(in crate::dialogue) place: Option<ViewThird>,
    /// Whether the text speaks of more than one.
    pub(in crate::dialogue) several: bool,
    /// The word before it, articles and adjectives skipped: "to", "of" ...
    pub(in crate::dialogue) before: String,
    /// Whether the text places it behind a door or window.
    pub(in crate::dialogue) is_beyond: bool,
}

/// Longest name of a mention, bytes; a longer one is no mention.
const MAX_NAME_BYTES: usize = 60;
/// Longest text that is read, bytes. Answers are shorter; the rest of a longer one is ignored.
const MAX_TEXT_BYTES: usize = 16_384;

/// Finds the mentions of a text. `known` contains names, in normal spelling, that the lexicon may lack.
pub(in crate::dialogue) fn find_mentions(text: &str, known: &BTreeSet<String>) -> Vec<AnswerMention> {
    let text = &text[..text.floor_char_boundary(MAX_TEXT_BYTES)].replace('’', "'");
    let reading = read_instruction(text, known);
    let words: Vec<&str> = reading.tokens().iter().map(|token| token.word.as_str()).collect();
    let nouns = find_nouns(&reading, &words, known);
    let mut found = Vec::new();
    for sentence in sentence_ranges(text, reading.tokens()) {
        let within: Vec<&NounMention> =
            nouns.iter().filter(|noun| sentence.contains(&noun.at.start) && noun.at.end <= sentence.end).collect();
        if !within.is_empty() {
            add_sentence_mentions(&words[sentence.clone()], sentence.start, &within, &mut found);
        }
    }
    found
}

/// The sentences of a text as ranges of its tokens. A line break also ends one.
fn sentence_ranges(text: &str, tokens: &[TextToken]) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = 0;
    for at in 0..tokens.len() {
        let breaks = tokens.get(at + 1).is_none_or(|next| text[tokens[at].span[1]..next.span[0]].contains('\n'));
        if tokens[at].ends_sentence() || breaks {
            found.push(start..at + 1);
            start = at + 1;
        }
    }
    found
}

/// Adds the mentions of one sentence. `words` are those of the sentence, which begins at token `start` of the text; the
/// ranges of `nouns` count from the beginning of the text.
fn add_sentence_mentions(words: &[&str], start: usize, nouns: &[&NounMention], found: &mut Vec<AnswerMention>) {
    let ranges: Vec<Range<usize>> = nouns.iter().map(|noun| noun.at.start - start..noun.at.end - start).collect();
    let mut witnesses = AnswerSentence { words, nouns: &ranges }.noun_witnesses();
    let doubles = mark_alternatives(words, &ranges, &mut witnesses);
    let places = noun_places(words, &ranges);
    for (at, noun) in nouns.iter().enumerate().filter(|(at, _)| !doubles.contains(at)) {
        let (range, witness) = (&ranges[at], witnesses[at]);
        let spelling = words[range.clone()].join(" ");
        let distinctions = distinguishing_words(words, range);
        if witness == WitnessAnswer::Denied && distinctions.iter().any(|word| OTHERS.contains(word)) {
            continue;
        }
        let is_plural = means_several(&spelling);
        let name = if is_plural { to_singular(&spelling) } else { spelling };
        let denied = witness == WitnessAnswer::Denied;
        let colour = noun.colour.clone().or_else(|| colour_said_of(&words[range.end..])).filter(|_| !denied);
        found.push(AnswerMention {
            name: if denied && !distinctions.is_empty() { format!("{} {name}", distinctions.join(" ")) } else { name },
            is_thing: noun.is_thing,
            is_room: noun.is_room,
            witness,
            colour,
            place: places[at],
            several: !denied && (is_plural || is_counted(words, range.start)),
            before: word_before(words, range.start).to_owned(),
            is_beyond: is_beyond(words, range),
        });
    }
}

/// Handles "or". "A sofa or a bench" leaves open which it is, so both become unsure. "A sofa or couch" is one thing
/// with two names; the second noun's index is returned, to be skipped.
fn mark_alternatives(words: &[&str], nouns: &[Range<usize>], witnesses: &mut [WitnessAnswer]) -> Vec<usize> {
    let mut doubles = Vec::new();
    for at in 1..nouns.len() {
        let between = &words[nouns[at - 1].end..nouns[at].start];
        let is_or = between.len() <= 4
            && between.contains(&"or")
            && !between.iter().any(|word| matches!(*word, "is" | "are" | "on" | "in" | "," | "and"));
        if !is_or || witnesses[at - 1..=at].contains(&WitnessAnswer::Denied) {
            continue;
        }
        let name = |noun: &Range<usize>| words[noun.clone()].join(" ");
        if names_agree(&name(&nouns[at - 1]), &name(&nouns[at])) {
            doubles.push(at);
        } else {
            witnesses[at - 1..=at].fill(WitnessAnswer::Unsure);
        }
    }
    doubles
}

/// Whether a word may stand before a noun phrase.
fn begins_noun_phrase(word: &str) -> bool {
    TELLS_NOTHING.contains(&word) || BREAKERS.contains(&word) || PERCEIVING.contains(&word)
}

/// The words before a noun that distinguish it from others of its kind: colours, materials, uses.
fn distinguishing_words<'a>(words: &[&'a str], noun: &Range<usize>) -> Vec<&'a str> {
    let from = (0..noun.start)
        .rev()
        .take_while(|at| {
            let skipped = matches!(words[*at], "large" | "small" | "big" | "single");
            (skipped || !begins_noun_phrase(words[*at]))
                && words[*at].chars().all(char::is_alphabetic)
                && noun.start - at <= 3
        })
        .last();
    let Some(from) = from.filter(|from| *from > 0 && begins_noun_phrase(words[from - 1])) else { return Vec::new() };
    words[from..noun.start].iter().filter(|word| !TELLS_NOTHING.contains(word)).copied().collect()
}

/// Whether a noun lies behind an opening: "through the doorway a bedroom", "a kitchen beyond the open door".
fn is_beyond(words: &[&str], noun: &Range<usize>) -> bool {
    let is_opening = |word: &str| {
        matches!(
            word,
            "door" | "doors" | "doorway" | "doorways" | "opening" | "archway" | "arch" | "window" | "entrance"
        )
    };
    let through = |at: usize| {
        matches!(words[at], "through" | "beyond" | "behind" | "past")
            && words[at + 1..].iter().take(5).any(|word| is_opening(word))
    };
    let behind = words[noun.end..].iter().take(6).take_while(|word| !matches!(**word, "," | "with" | "and")).count();
    (noun.start.saturating_sub(8)..noun.start).chain(noun.end..noun.end + behind).any(through)
}

/// The last word before a noun, articles and a few adjectives skipped.
fn word_before<'a>(words: &[&'a str], noun: usize) -> &'a str {
    let skips =
        |word: &&&str| matches!(**word, "a" | "an" | "the" | "another" | "small" | "large" | "nearby" | "adjacent");
    words[..noun].iter().rev().find(|word| !skips(word)).copied().unwrap_or("")
}

/// Whether a number over one is before a noun, at most five words earlier: "three small chairs".
fn is_counted(words: &[&str], noun: usize) -> bool {
    for word in words[..noun].iter().rev().take(5) {
        let is_number = NUMBERS.contains(word) || word.parse::<u32>().is_ok_and(|number| number > 1);
        if is_number {
            return true;
        }
        if matches!(*word, "a" | "an" | "the" | "one" | "," | "and" | "on" | "in" | "with" | "to" | "is" | "are") {
            return false;
        }
    }
    false
}

/// The place in the view of each noun of a sentence. A phrase of place belongs to the noun before it, or, at the head
/// of its part of the sentence, to all nouns that follow.
fn noun_places(words: &[&str], nouns: &[Range<usize>]) -> Vec<Option<ViewThird>> {
    let mut places = vec![None; nouns.len()];
    let phrases = place_phrases(words);
    for (at, phrase) in phrases.iter().enumerate() {
        let end =
            phrases[at + 1..].iter().find(|next| is_head(words, next, nouns)).map_or(words.len(), |next| next.from);
        if is_head(words, phrase, nouns) {
            for (noun, place) in nouns.iter().zip(&mut places) {
                if noun.start >= phrase.to && noun.end <= end {
                    *place = Some(phrase.place);
                }
            }
        } else if let Some(last) = nouns.iter().rposition(|noun| noun.end <= phrase.from) {
            let between = &words[nouns[last].end..phrase.from];
            // "Two windows, both on the left".
            let is_apart =
                between.contains(&",") && !matches!(between, [",", "both" | "located" | "placed" | "situated", ..]);
            if between.len() <= 8 && !is_apart {
                places[last] = Some(phrase.place);
            }
        }
    }
    places
}

/// Whether a phrase of place precedes the nouns that it places: at the start of the sentence, or after a comma or an
/// "and", with a noun after it.
fn is_head(words: &[&str], phrase: &PlacePhrase, nouns: &[Range<usize>]) -> bool {
    let before = phrase.from.checked_sub(1).map_or("", |at| words[at]);
    let begins = !nouns.iter().any(|noun| noun.end <= phrase.from) && !matches!(before, "it" | "one" | "them" | "they");
    let is_joined = matches!(before, "," | "and" | ";" | "while" | "-");
    let has_nouns_after = nouns.iter().any(|noun| noun.start >= phrase.to);
    has_nouns_after && (is_joined || (begins && phrase.from <= 4))
}

/// A thing or room, as a range of the tokens of a text.
struct NounMention {
    /// The tokens of its name.
    at: Range<usize>,
    is_thing: bool,
    is_room: bool,
    colour: Option<String>,
}

/// The things and rooms that a text names, in order. `words` are those of its tokens; `known` contains names, in normal
/// spelling, that the lexicon may lack.
fn find_nouns(reading: &TextReading, words: &[&str], known: &BTreeSet<String>) -> Vec<NounMention> {
    let tokens = reading.tokens();
    let places = reading.events.iter().filter_map(|event| match &event.what {
        EventContent::Place(place) => Some((event.span, place)),
        _ => None,
    });
    places
        .filter_map(|(span, place)| {
            let from = tokens.partition_point(|token| token.span[0] < span[0]);
            let to = tokens.partition_point(|token| token.span[0] < span[1]);
            let name = words[from..to].join(" ");
            let in_lexicon = find_thing(&name).is_some() || place.is_room || known.contains(&normalise_name(&name));
            let is_object = if in_lexicon {
                !is_the_picture(words, from, to) && !is_manner_of_speaking(words, from, to)
            } else {
                is_brought_in(words, from, to)
            };
            (is_object && !is_depicted(words, from) && name.len() <= MAX_NAME_BYTES).then_some(NounMention {
                at: from..to,
                is_thing: place.is_thing,
                is_room: place.is_room,
                colour: place.colour.clone(),
            })
        })
        .collect()
}

/// Whether a "picture" is the view itself and not an object on a wall: "the picture shows", "in this photo", "a picture
/// of a kitchen". The noun has the words `from` to `to`, without `to`.
fn is_the_picture(words: &[&str], from: usize, to: usize) -> bool {
    let is_single = to == from + 1 && matches!(words[from], "picture" | "photo" | "photograph");
    let is_filling = |word: &str| {
        matches!(
            word,
            "fills"
                | "fill"
                | "filling"
                | "dominates"
                | "dominate"
                | "occupies"
                | "occupy"
                | "crosses"
                | "frames"
                | "of"
                | "in"
                | "across"
                | "throughout"
                | "within"
        )
    };
    if is_single && from > 1 && matches!(words[from - 1], "the" | "this") && is_filling(words[from - 2]) {
        return true;
    }
    let word = |at: usize| words.get(at).copied().unwrap_or("");
    let before = if from > 0 { word(from - 1) } else { "" };
    let is_hanging = matches!(word(to), "on" | "above" | "over" | "hanging" | "hangs" | "frame" | "frames");
    let brought_in = words[..from].iter().any(|word| matches!(*word, "there" | "see" | "has" | "with"));
    let of_all = word(to) == "of" && from <= 4 && !brought_in;
    let is_showing =
        matches!(word(to), "shows" | "depicts" | "features" | "contains" | "captures" | "showing" | "itself");
    is_single && !is_hanging && (matches!(before, "the" | "this") || of_all || is_showing)
}

/// Whether a noun is the subject of a picture: "a painting of a horse" puts no horse into the room.
fn is_depicted(words: &[&str], from: usize) -> bool {
    let picture = |word: &str| {
        matches!(
            word,
            "picture" | "pictures" | "painting" | "paintings" | "photo" | "photos" | "portrait" | "poster" | "print"
        )
    };
    let near = (from.saturating_sub(4)..from).rev().find(|at| words[*at] == "of").filter(|of| *of > 0);
    near.is_some_and(|of| picture(words[of - 1]) && !is_the_picture(words, of - 1, of))
}

/// Whether a word that can name a thing is used in another sense: "a range of colours", "in shades of blue", "the light
/// from the window", "tasteful decor".
fn is_manner_of_speaking(words: &[&str], from: usize, to: usize) -> bool {
    if to != from + 1 {
        return false;
    }
    match (words[from], words.get(to).copied().unwrap_or("")) {
        ("decor", _) => true,
        // "The wall steps forward."
        ("steps" | "step", "forward" | "back" | "backward" | "down" | "up" | "out" | "in" | "away" | "aside") => true,
        // "A light wooden floor."
        ("light", next) if MATERIALS.contains(&next) || QUALITIES.contains(&next) || COLOURS.contains(&next) => true,
        ("range" | "shade" | "shades" | "case" | "cover" | "scale" | "stage", "of") => true,
        ("light", next) => {
            matches!(
                next,
                "from" | "streaming" | "coming" | "comes" | "enters" | "shining" | "shines" | "pouring" | "that"
            )
        }
        _ => false,
    }
}

/// Whether a noun that the lexicon lacks counts as a thing: only if the text introduces it ("there is a gizmo") and it
/// is no word of description.
fn is_brought_in(words: &[&str], from: usize, to: usize) -> bool {
    let head = normalise_name(words[to - 1]);
    let start = (0..from).rev().find(|at| matches!(words[*at], "." | "!" | "?" | ";")).map_or(0, |at| at + 1);
    let indefinite = from > 0 && matches!(words[from - 1], "a" | "an");
    let stays =
        |word: &str| !NO_OBJECTS.contains(&normalise_name(word).as_str()) && !word.ends_with("ing") && word != "shows";
    let is_quality = QUALITIES.contains(&head.as_str()) || MATERIALS.contains(&head.as_str());
    indefinite
        && !is_quality
        && to - from <= 3
        && words[from..to].iter().all(|word| stays(word))
        && !ABSTRACT.contains(&head.as_str())
        && words[start..from].iter().any(|word| BRINGS_IN.contains(word))
}
