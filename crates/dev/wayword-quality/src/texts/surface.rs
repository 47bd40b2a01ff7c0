//! Figures of the surface of texts: lengths, openers, bare turns, word types.

use super::{
    clauses::{is_bare_turn, split_clauses},
    names::{LexiconName, find_names, split_words},
    row::{TextFigureRow, number_row, share_row},
};
use std::collections::BTreeSet;

/// Word types, the different words, are counted over the first texts, at most this many.
const WORD_TYPE_TEXTS: usize = 500;
/// Percentiles of the number of words.
const LENGTH_PERCENTILES: [usize; 3] = [5, 50, 95];
/// How texts may begin.
const OPENER_PHRASES: [&str; 4] = ["go to", "go", "walk", "in the"];
/// Rows of the table that count texts with any of some phrases, as whole words.
const COUNTED_PHRASES: [(&str, &[&str]); 5] = [
    ("holds \"then\"", &["then"]),
    ("holds \"your left\" or \"your right\"", &["your left", "your right"]),
    ("holds \"on the left\" or \"on the right\"", &["on the left", "on the right"]),
    ("names a level or floor", LEVEL_WORDS),
    ("holds \"that is\", \"which is\" or \"that has\"", &["that is", "which is", "that has", "which has"]),
];
/// Words for a storey.
pub(super) const LEVEL_WORDS: &[&str] = &["level", "levels", "floor", "upstairs", "downstairs", "storey", "story"];

/// Whether a text has one of some phrases, as whole words.
pub(super) fn holds_phrase(words: &[String], phrases: &[&str]) -> bool {
    let text = format!(" {} ", words.join(" "));
    phrases.iter().any(|phrase| text.contains(&format!(" {phrase} ")))
}

/// The rows of the table, the most important first.
pub(super) fn surface_rows(texts: &[&str]) -> Vec<TextFigureRow> {
    let split: Vec<Vec<String>> = texts.iter().map(|text| split_words(text)).collect();
    let clauses: Vec<Vec<String>> = texts.iter().map(|text| split_clauses(text)).collect();
    let bare = |text: &Vec<String>| text.iter().map(|clause| is_bare_turn(clause)).collect::<Vec<_>>();
    let bare: Vec<Vec<bool>> = clauses.iter().map(bare).collect();
    let mut rows = vec![
        number_row("texts", texts.len() as f64),
        share_row("two bare turns in a row", bare.iter().map(|text| text.windows(2).any(|pair| pair[0] && pair[1]))),
        share_row("a bare turn first", bare.iter().map(|text| text.first() == Some(&true))),
        share_row(
            "an object before the last place",
            split.iter().map(|words| has_before_the_end(words, LexiconName::is_object)),
        ),
        share_row(
            "an object, a door or stairs before it",
            split.iter().map(|words| has_before_the_end(words, LexiconName::is_seen)),
        ),
        number_row("word types over 500 texts", count_word_types(texts) as f64),
    ];
    rows.extend(length_rows(texts, &split));
    let opener_row = |opener: &str| {
        share_row(&format!("begins with \"{opener}\""), split.iter().map(|words| begins_with(words, opener)))
    };
    rows.extend(OPENER_PHRASES.iter().map(|opener| opener_row(opener)));
    let phrase_row =
        |(name, phrases): &(&str, &[&str])| share_row(name, split.iter().map(|words| holds_phrase(words, phrases)));
    rows.extend(COUNTED_PHRASES.iter().map(phrase_row));
    rows
}

fn begins_with(words: &[String], opener: &str) -> bool {
    opener.split(' ').eq(words.iter().map(String::as_str).take(opener.split(' ').count()))
}

/// The number of different words in the first [`WORD_TYPE_TEXTS`] texts.
fn count_word_types(texts: &[&str]) -> usize {
    let lower = texts.iter().take(WORD_TYPE_TEXTS).map(|text| text.to_lowercase()).collect::<Vec<_>>().join("\n");
    let words: BTreeSet<&str> =
        lower.split(|c: char| !c.is_ascii_alphabetic()).filter(|word| !word.is_empty()).collect();
    words.len()
}

/// The rows about numbers of words and sentences. `split`: the words of each text.
fn length_rows(texts: &[&str], split: &[Vec<String>]) -> Vec<TextFigureRow> {
    let mut counts: Vec<usize> = split.iter().map(Vec::len).collect();
    counts.sort_unstable();
    let mean = |values: &[usize]| values.iter().sum::<usize>() as f64 / values.len().max(1) as f64;
    let at = |percent: usize| counts.get((counts.len().saturating_sub(1) * percent + 50) / 100).copied().unwrap_or(0);
    let mut rows = vec![number_row("words, mean", mean(&counts))];
    rows.extend(
        LENGTH_PERCENTILES.map(|percent| number_row(&format!("words, percentile {percent}"), at(percent) as f64)),
    );
    let ends = |text: &&str| text.split(['.', '!', '?']).filter(|part| part.chars().any(char::is_alphabetic)).count();
    rows.push(number_row("sentences, mean", mean(&texts.iter().map(ends).collect::<Vec<_>>())));
    rows
}

/// Whether the text has a name that `is_such` accepts in a clause before the last clause with a name.
fn has_before_the_end(words: &[String], is_such: impl Fn(&LexiconName) -> bool) -> bool {
    let names = find_names(words);
    let Some(last) = names.last() else { return false };
    let ends = |word: &String| matches!(word.as_str(), "and" | "then" | "stop" | "wait" | "turn" | "walk" | "go");
    let begins_at = words[..last.start].iter().rposition(ends).unwrap_or(0);
    names.iter().any(|name| is_such(name) && name.end <= begins_at)
}

#[cfg(test)]
mod tests {
    use super::super::row::TextFigureValue;
    use super::*;

    fn value(rows: &[TextFigureRow], name: &str) -> TextFigureValue {
        rows.iter().find(|row| row.name == name).unwrap().value
    }

    #[test]
    fn bare_turns_openers_and_types_are_counted_over_texts() {
        let rows = surface_rows(&["Go to the kitchen. Turn left, then turn right.", "Turn left and stop by the sofa."]);
        assert_eq!(value(&rows, "two bare turns in a row"), TextFigureValue::Share { count: 1, of: 2 });
        assert_eq!(value(&rows, "a bare turn first"), TextFigureValue::Share { count: 1, of: 2 });
        assert_eq!(value(&rows, "begins with \"go to\""), TextFigureValue::Share { count: 1, of: 2 });
        assert_eq!(value(&rows, "word types over 500 texts"), TextFigureValue::Number(12.0));
        assert_eq!(value(&rows, "words, mean"), TextFigureValue::Number(8.0));
        assert_eq!(value(&rows, "sentences, mean"), TextFigureValue::Number(1.5));
    }

    #[test]
    fn the_place_where_a_text_ends_does_not_count_as_one_before_it() {
        let before = |text: &str| has_before_the_end(&split_words(text), LexiconName::is_object);
        assert!(before("Walk past the sofa and stop in the kitchen."));
        assert!(before("Turn left at the lamp, then wait by the bed next to the table."));
        assert!(!before("Turn left and stop by the sofa next to the lamp."));
        assert!(!before("Go up the stairs and walk to the sofa and stop there."));
        assert!(has_before_the_end(&split_words("Go up the stairs and stop by the sofa."), LexiconName::is_seen));
    }
}
