//! Puts the sentences of a text in another order; if there is only one sentence, its clauses.

use super::casing::{capitalise_first, uncapitalise_first};
use crate::directions::clause_texts;
use rand::Rng;
use wayword_core::seeded_rng;
use wayword_language::text::split_words;

/// The text with each of its sentences in another place, or each of its clauses if it has one sentence. `None` if the words stay
/// the same.
pub(super) fn swap_sentences(text: &str, seed: u64, item: &str) -> Option<String> {
    let sentences = split_sentences(text);
    let clauses = if sentences.len() > 1 { Vec::new() } else { clause_texts(text) };
    let order = draw_order(sentences.len().max(clauses.len()), seed, item)?;
    let new = if clauses.is_empty() {
        reorder_sentences(&sentences, &order)
    } else {
        reorder_clauses(text, &clauses, &order)
    };
    (split_words(&new) != split_words(text)).then_some(new)
}

/// A random order in which every element changes its place (Sattolo 1986); `None` for fewer than two.
fn draw_order(count: usize, seed: u64, item: &str) -> Option<Vec<usize>> {
    if count < 2 {
        return None;
    }
    let mut rng = seeded_rng(seed, &["swap", "sentences", item]);
    let mut order: Vec<usize> = (0..count).collect();
    for at in (1..count).rev() {
        order.swap(at, rng.random_range(0..at));
    }
    Some(order)
}

/// The sentences in another order, each with a capital letter and a closing mark.
fn reorder_sentences(sentences: &[&str], order: &[usize]) -> String {
    let whole = |at: &usize| {
        let sentence = capitalise_first(sentences[*at]);
        let ends = sentence.ends_with(['.', '!', '?']);
        if ends { sentence } else { format!("{}.", sentence.trim_end_matches([',', ';', ':'])) }
    };
    order.iter().map(whole).collect::<Vec<_>>().join(" ")
}

/// The clauses in another order as one sentence ("a, b and c"), with the closing mark of the text.
fn reorder_clauses(text: &str, clauses: &[&str], order: &[usize]) -> String {
    let is_capitalised = capitalise_first(clauses[0]) == clauses[0];
    let clause = |at: &usize| if *at == 0 { uncapitalise_first(clauses[0]) } else { clauses[*at].to_owned() };
    let clauses: Vec<String> = order.iter().map(clause).collect();
    let (last, before) = clauses.split_last().map_or(("", &[][..]), |(last, before)| (last.as_str(), before));
    let joined = format!("{} and {last}", before.join(", "));
    let end = text.trim_end().chars().next_back().filter(|end| matches!(end, '.' | '!' | '?'));
    let joined = if is_capitalised { capitalise_first(&joined) } else { joined };
    joined + &end.map_or_else(String::new, String::from)
}

/// The sentences of a text that have words, each with its closing mark. The dot of a number such as "2.5" ends no sentence.
fn split_sentences(text: &str) -> Vec<&str> {
    let mut sentences = Vec::new();
    let mut from = 0;
    for (at, _) in text.match_indices(['.', '!', '?']) {
        let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
        let is_in_number = is_digit(text[..at].chars().next_back()) && is_digit(text[at + 1..].chars().next());
        if !is_in_number && text[from..at].contains(char::is_alphanumeric) {
            sentences.push(text[from..=at].trim());
            from = at + 1;
        }
    }
    if text[from..].contains(char::is_alphanumeric) {
        sentences.push(text[from..].trim());
    }
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn sentences_change_places() {
        let of = |text: &str| swap_sentences(text, 1, "item");
        assert_eq!(of("Leave the den. wait by the sofa").as_deref(), Some("Wait by the sofa. Leave the den."));
        assert_eq!(of("Walk 2.5 metres! Stop.").as_deref(), Some("Stop. Walk 2.5 metres!"));
        for text in ["Go.  Go.", "Dust the lamp", "Dust the lamp.", "", "..."] {
            assert_eq!(of(text), None, "{text}");
        }
    }

    #[test]
    fn clauses_change_places_where_there_is_one_sentence() {
        let of = |text: &str| swap_sentences(text, 1, "item");
        assert_eq!(of("Go to the den and wipe the sink").as_deref(), Some("Wipe the sink and go to the den"));
        assert_eq!(of("TV room ahead, turn left.").as_deref(), Some("Turn left and TV room ahead."));
        let three = of("Leave the den, turn left, then wait by the sofa.").unwrap();
        assert!(
            ["Turn left, wait by the sofa and leave the den.", "Wait by the sofa, leave the den and turn left."]
                .contains(&three.as_str()),
            "{three}"
        );
    }

    proptest! {
        #[test]
        fn no_sentence_stays_where_it_was(count in 2..9usize, seed in 0..99u64) {
            let mut order = draw_order(count, seed, "item").unwrap();
            prop_assert!(order.iter().enumerate().all(|(at, from)| at != *from));
            order.sort_unstable();
            prop_assert_eq!(order, (0..count).collect::<Vec<_>>());
        }

        #[test]
        fn any_text_is_swapped_or_left(text in "((go|den|and|then|ß|İ|2|[,.!?'’-])  ?){0,20}|\\PC{0,60}", seed in 0..9u64) {
            prop_assert_ne!(swap_sentences(&text, seed, "item"), Some(text));
        }
    }
}
