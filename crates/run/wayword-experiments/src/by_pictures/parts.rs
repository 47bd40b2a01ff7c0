//! Cuts a text into parts that are short enough for a model to read: a CLIP cuts off the end of a longer text.

use wayword_language::{
    reading::clause_numbers,
    text::{TextToken, split_tokens},
};

/// Cuts a text into its sentences. A sentence that is too long for the model, as `fits_model` judges, is cut between clauses into
/// pieces, each with as many clauses as the model can read. A clause that is too long by itself stays whole.
///
/// # Errors
/// When `fits_model` fails.
pub(super) fn split_into_parts<E>(text: &str, fits_model: impl Fn(&str) -> Result<bool, E>) -> Result<Vec<&str>, E> {
    let tokens = split_tokens(text);
    let mut parts = Vec::new();
    for sentence in tokens.split_inclusive(TextToken::ends_sentence) {
        let first = sentence.iter().find(|token| token.is_word());
        let Some((first, last)) = first.zip(sentence.last()) else { continue };
        let whole = &text[first.span[0]..last.span[1]];
        if fits_model(whole)? {
            parts.push(whole);
        } else {
            parts.extend(cut_between_clauses(text, sentence, &fits_model)?);
        }
    }
    Ok(parts)
}

/// Cuts a sentence into pieces, each with as many consecutive clauses as fit the model.
fn cut_between_clauses<'a, E>(
    text: &'a str,
    sentence: &[TextToken],
    fits_model: &impl Fn(&str) -> Result<bool, E>,
) -> Result<Vec<&'a str>, E> {
    let numbers = clause_numbers(sentence);
    let starts: Vec<usize> = (0..sentence.len()).filter(|at| *at == 0 || numbers[*at] != numbers[*at - 1]).collect();
    let mut pieces = Vec::new();
    let (mut from, mut to) = (0, 0);
    for end in starts.into_iter().skip(1).chain([sentence.len()]) {
        let longer = text_of_tokens(text, &sentence[from..end]);
        let is_too_long = to > from
            && match longer {
                Some(longer) => !fits_model(longer)?,
                None => false,
            };
        if is_too_long {
            pieces.extend(text_of_tokens(text, &sentence[from..to]));
            from = to;
        }
        to = end;
    }
    pieces.extend(text_of_tokens(text, &sentence[from..to]));
    Ok(pieces)
}

/// The text of some tokens from their first word to their last; `None` if there is no word.
fn text_of_tokens<'a>(text: &'a str, tokens: &[TextToken]) -> Option<&'a str> {
    let mut words = tokens.iter().filter(|token| token.is_word());
    let first = words.next()?;
    Some(&text[first.span[0]..words.next_back().unwrap_or(first).span[1]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn parts_within(text: &str, most: usize) -> Vec<&str> {
        let found: Result<_, Infallible> = split_into_parts(text, |part| Ok(part.len() <= most));
        found.unwrap_or_default()
    }

    #[test]
    fn sentences_that_can_be_read_stay_whole() {
        let text = "Go past the sofa, then turn left. Stop!  ... Wait by approx. two chairs";
        assert_eq!(
            parts_within(text, 99),
            ["Go past the sofa, then turn left.", "Stop!", "Wait by approx. two chairs"]
        );
    }

    #[test]
    fn a_long_sentence_is_cut_between_clauses_as_late_as_can_be() {
        let text = "Go past the sofa, turn left, and walk on to the door of the bathroom.";
        assert_eq!(parts_within(text, 30), ["Go past the sofa, turn left", "and walk on to the door of the bathroom"]);
        assert_eq!(parts_within(text, 1), ["Go past the sofa", "turn left", "and walk on to the door of the bathroom"]);
    }

    #[test]
    fn split_into_parts_skips_punctuation_alone() {
        assert!(parts_within("... , ! -", 99).is_empty() && parts_within("", 99).is_empty());
        assert_eq!(parts_within("(,) Stop", 2), ["Stop"]);
    }
}
