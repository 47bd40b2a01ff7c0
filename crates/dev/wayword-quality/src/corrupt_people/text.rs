//! Splits a text into words, clauses and sentences. This generator has rules of its own, because it must not share the reader's.

/// Marks at which a clause ends.
const CLAUSE_ENDS: [char; 6] = ['.', ',', ';', '!', '?', '\n'];
/// Marks at which a sentence ends.
const SENTENCE_ENDS: [char; 4] = ['.', '!', '?', '\n'];
/// Words with which a clause begins.
const CLAUSE_STARTS: [&str; 2] = ["then", "and"];

/// A word of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PlainWord {
    /// Byte range in the text.
    pub(super) span: [usize; 2],
    /// The word in lower case.
    pub(super) low: String,
    /// Whether only spaces separate it from the word before it. A mark between them breaks a phrase.
    pub(super) is_joined: bool,
}

/// The words of a text: letters and digits, with hyphens and apostrophes inside.
pub(super) fn split_words(text: &str) -> Vec<PlainWord> {
    let is_inside = |c: char| c.is_alphanumeric() || matches!(c, '\'' | '\u{2019}' | '-');
    let mut words: Vec<PlainWord> = Vec::new();
    let mut at = 0;
    for part in text.split(|c| !is_inside(c)) {
        let bare = part.trim_matches(|c: char| !c.is_alphanumeric());
        if let Some(lead) = part.find(bare).filter(|_| !bare.is_empty()) {
            let span = [at + lead, at + lead + bare.len()];
            let before = words.last().and_then(|word| text.get(word.span[1]..span[0]));
            let is_joined = before.is_some_and(|gap| gap.chars().all(|c| c == ' '));
            words.push(PlainWord { span, low: bare.to_lowercase(), is_joined });
        }
        at += part.len() + text[at + part.len()..].chars().next().map_or(0, char::len_utf8);
    }
    words
}

/// The clauses of a text, as byte ranges that cover it. They are cut after marks and before "then" and "and".
pub(crate) fn split_clauses(text: &str) -> Vec<[usize; 2]> {
    let starts = split_words(text).into_iter().filter(|word| CLAUSE_STARTS.contains(&word.low.as_str()));
    let mut cuts: Vec<usize> = ends_after_marks(text, &CLAUSE_ENDS).chain(starts.map(|word| word.span[0])).collect();
    cuts.sort_unstable();
    let mut clauses = Vec::new();
    let mut from = 0;
    for to in cuts.into_iter().chain([text.len()]) {
        // A part without a word of its own (", and then") belongs to the next one.
        let has_own_word = split_words(&text[from..to]).iter().any(|word| !CLAUSE_STARTS.contains(&word.low.as_str()));
        if has_own_word {
            clauses.push([from, to]);
            from = to;
        }
    }
    match clauses.last_mut() {
        Some(last) => last[1] = text.len(),
        None => clauses.push([0, text.len()]),
    }
    clauses
}

/// The byte range of all clauses that overlap `span`, with one more clause on each side.
pub(crate) fn clauses_around(text: &str, span: [usize; 2]) -> [usize; 2] {
    let clauses = split_clauses(text);
    let meets = |clause: &[usize; 2]| span[0] < clause[1] && clause[0] < span[1].max(span[0] + 1);
    let first = clauses.iter().position(meets).unwrap_or(0);
    let last = clauses.iter().rposition(meets).unwrap_or(first);
    let last = (last + 1).min(clauses.len() - 1);
    [clauses[first.saturating_sub(1)][0], clauses[last][1]]
}

/// The sentences of a text that have a word, as byte ranges without the spaces around them.
pub(super) fn split_sentences(text: &str) -> Vec<[usize; 2]> {
    let mut from = 0;
    let mut sentences = Vec::new();
    for to in ends_after_marks(text, &SENTENCE_ENDS).chain([text.len()]) {
        let part = &text[from..to];
        let start = from + part.len() - part.trim_start().len();
        if !split_words(part).is_empty() {
            sentences.push([start, start + part.trim().len()]);
        }
        from = to;
    }
    sentences
}

/// The byte positions after marks, except those within numbers (2.5).
fn ends_after_marks<'t>(text: &'t str, marks: &'t [char]) -> impl Iterator<Item = usize> + 't {
    let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
    text.match_indices(marks).filter_map(move |(at, mark)| {
        let end = at + mark.len();
        let is_number = is_digit(text[..at].chars().next_back()) && is_digit(text[end..].chars().next());
        (!is_number).then_some(end)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told<'t>(text: &'t str, spans: &[[usize; 2]]) -> Vec<&'t str> {
        spans.iter().map(|span| &text[span[0]..span[1]]).collect()
    }

    #[test]
    fn words_are_in_lower_case_and_keep_their_byte_ranges() {
        let text = "Go to Bob's  left-hand \u{e4}rmchair, -2.";
        let lows: Vec<(String, bool)> = split_words(text).into_iter().map(|word| (word.low, word.is_joined)).collect();
        let expected =
            [("go", false), ("to", true), ("bob's", true), ("left-hand", true), ("\u{e4}rmchair", true), ("2", false)];
        assert_eq!(lows, expected.map(|(low, joined)| (low.to_owned(), joined)));
        assert!(split_words(text).iter().all(|word| text[word.span[0]..word.span[1]].to_lowercase() == word.low));
        assert!(split_words(" .,- ").is_empty());
    }

    #[test]
    fn clauses_are_cut_at_marks_and_at_then_and_and() {
        let text = "Walk 2.5 m, and then turn left. Go up the stairs and stop";
        assert_eq!(
            told(text, &split_clauses(text)),
            ["Walk 2.5 m,", " and then turn left.", " Go up the stairs ", "and stop"]
        );
        assert_eq!(told("", &split_clauses("")), [""]);
        assert_eq!(told(" . ", &split_clauses(" . ")), [" . "]);
    }

    #[test]
    fn around_adds_one_clause_on_each_side() {
        let text = "One. Two. Three. Four. Five";
        let near = |words: &str| {
            let from = text.find(words).unwrap();
            let [from, to] = clauses_around(text, [from, from + words.len()]);
            &text[from..to]
        };
        assert_eq!(near("Three"), " Two. Three. Four.");
        assert_eq!(near("One"), "One. Two.");
        assert_eq!(near("Five"), " Four. Five");
        assert_eq!(near("Two. Three"), "One. Two. Three. Four.");
    }

    #[test]
    fn sentences_end_at_full_stops_and_lines() {
        let text = " Walk on, then left. Stop!\nWait.. ";
        assert_eq!(told(text, &split_sentences(text)), ["Walk on, then left.", "Stop!", "Wait."]);
    }
}
