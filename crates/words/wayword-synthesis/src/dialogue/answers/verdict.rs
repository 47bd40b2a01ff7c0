//! Yes, no, or neither.

use super::scope::doubt_at;
use wayword_language::{
    answers::{AFTER_NOUN, MAYBE, NO, YES, YES_ALONE},
    text::words,
};

/// What an answer says to a question that wants a yes or a no.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Yes,
    No,
    Unsure,
    /// It says neither; what it names decides.
    Open,
}

/// What an answer says, by how it begins, or by the yes or no behind its first comma ("Looking again, no."). Not to be sure, in its
/// first sentence, outweighs that.
pub(super) fn verdict(answer: &str) -> Verdict {
    let answer = answer.replace('’', "'");
    let first = answer.split_inclusive(['.', '!', '?', '\n']).find(|part| part.contains(char::is_alphanumeric));
    let first = first.unwrap_or_default();
    match of_words(&words(first)) {
        Verdict::Open => {}
        verdict => return verdict,
    }
    if let Some((_, rest)) = first.split_once(',').filter(|(before, _)| words(before).len() <= 8) {
        let rest = words(rest);
        if rest.first().is_some_and(|first| matches!(first.as_str(), "yes" | "no")) {
            return of_words(&rest);
        }
    }
    let all = words(&answer);
    if is_unsure(&all.iter().map(String::as_str).collect::<Vec<_>>()) { Verdict::Unsure } else { Verdict::Open }
}

fn of_words(words: &[String]) -> Verdict {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let words = words.strip_prefix(&["well"]).unwrap_or(&words);
    let longest = |phrases: &[Vec<&'static str>]| {
        phrases.iter().filter(|phrase| words.starts_with(phrase)).map(|phrase| phrase.len()).max()
    };
    if is_unsure(words) || longest(&MAYBE).is_some() {
        return Verdict::Unsure;
    }
    let alone = |words: &&Vec<&str>, said: &[&str]| {
        said.strip_prefix(words.as_slice())
            .is_some_and(|rest| rest.first().is_none_or(|next| AFTER_NOUN.contains(next)))
    };
    let alone = YES_ALONE.iter().filter(|phrase| alone(phrase, words)).map(Vec::len).max();
    match (longest(&YES).or(alone).unwrap_or(0), longest(&NO).unwrap_or(0)) {
        (0, 0) => Verdict::Open,
        (yes, no) if yes >= no => Verdict::Yes,
        _ => Verdict::No,
    }
}

/// Whether words hold a phrase of not knowing.
pub(super) fn is_unsure(words: &[&str]) -> bool {
    (0..words.len()).any(|at| doubt_at(&words[at..]).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_say_yes_no_or_neither() {
        for (wanted, answers) in [
            (
                Verdict::Yes,
                vec!["Yes", "yes.", "Yes, there are two.", "There is one.", "No doubt.", "I think so.", "Of course"],
            ),
            (
                Verdict::No,
                vec![
                    "No",
                    "no.",
                    "NO!",
                    "No, there isn't.",
                    "None",
                    "Not that I can see.",
                    "There is no TV.",
                    "I don't think so.",
                    "There are none.",
                    "No, I don't see one.",
                    "I cannot see a lamp.",
                    "There isn’t one.",
                    "Neither.",
                    "It does not appear so.",
                ],
            ),
            (
                Verdict::Unsure,
                vec![
                    "I am not sure.",
                    "Unclear",
                    "I can't tell",
                    "It is hard to say.",
                    "Unknown.",
                    "Maybe",
                    "There might be.",
                    "No, I'm not sure",
                    "It is not clear from the picture.",
                    "I don't know",
                ],
            ),
            (
                Verdict::Open,
                vec![
                    "There is a lamp.",
                    "I can see a lamp.",
                    "There are two lamps.",
                    "",
                    "A bed.",
                    "A bed is.",
                    "On the left",
                    "🤖",
                ],
            ),
        ] {
            for answer in answers {
                assert_eq!(verdict(answer), wanted, "{answer}");
            }
        }
    }
}
