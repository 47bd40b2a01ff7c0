//! A text cut into pieces that can be exchanged, moved, left out and repeated, so that what remains is English again.

use super::{
    word_lists::CLAUSE_VERBS,
    words::{FaultWord, list_words, replace_span},
};
use std::ops::Range;

/// Words that only join two pieces.
const JOINING_WORDS: [&str; 2] = ["and", "then"];
/// Adverbs that may stand before the verb of a clause.
const LEADING_ADVERBS: [&str; 4] = ["immediately", "just", "slightly", "again"];
/// Prepositions with which a clause may begin: "in the hallway take a left".
const LEADING_PREPOSITIONS: [&str; 2] = ["in", "at"];
/// The verb comes at most this many words after such a preposition.
const MAX_LEADING_WORDS: usize = 7;

/// A text in pieces: sentences, and clauses of sentences.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FaultText {
    /// The words of each piece, with a small first letter.
    pub(super) pieces: Vec<String>,
    /// The marks and words before each piece, such as ", and then ".
    joints: Vec<String>,
    /// The marks after the last piece.
    tail: String,
}

impl FaultText {
    /// Cuts a text into pieces. `None` where the pieces would not give the same text again, or there are none.
    pub(super) fn from_text(text: &str) -> Option<Self> {
        let words = list_words(text);
        let firsts = find_piece_starts(text, &words);
        let mut cut = Self { pieces: Vec::new(), joints: Vec::new(), tail: String::new() };
        let mut from = 0;
        for (number, first) in firsts.iter().enumerate() {
            let end = firsts.get(number + 1).copied().unwrap_or(words.len());
            let own = words.get(*first..end)?;
            let last = own.iter().rev().find(|word| !is_joining(word))?;
            let start = own.first()?.span[0];
            cut.joints.push(text.get(from..start)?.to_owned());
            cut.pieces.push(with_first_letter(text.get(start..last.span[1])?, char::to_ascii_lowercase));
            from = last.span[1];
        }
        cut.tail = text.get(from..)?.to_owned();
        (!cut.pieces.is_empty() && cut.render() == text).then_some(cut)
    }

    /// The whole text, with a capital at the beginning of each sentence.
    pub(super) fn render(&self) -> String {
        let mut text = String::new();
        for (joint, piece) in self.joints.iter().zip(&self.pieces) {
            text.push_str(joint);
            let is_first = text.trim_end().is_empty() || ends_sentence(joint);
            let piece = if is_first { with_first_letter(piece, char::to_ascii_uppercase) } else { piece.clone() };
            text.push_str(&piece);
        }
        text + &self.tail
    }

    /// The same text with two of its pieces exchanged.
    pub(super) fn with_exchange(&self, one: usize, other: usize) -> Option<Self> {
        let mut edited = self.clone();
        let (first, second) = (self.pieces.get(one)?.clone(), self.pieces.get(other)?.clone());
        *edited.pieces.get_mut(one)? = second;
        *edited.pieces.get_mut(other)? = first;
        Some(edited)
    }

    /// The same text with other words in place of a byte range of a piece.
    pub(super) fn with_words(&self, at: usize, span: [usize; 2], now: &str) -> Option<Self> {
        let words = replace_span(self.pieces.get(at)?, span, now)?;
        self.with_piece(at, words)
    }

    /// The same text with another piece.
    pub(super) fn with_piece(&self, at: usize, words: String) -> Option<Self> {
        let mut edited = self.clone();
        *edited.pieces.get_mut(at)? = words;
        Some(edited)
    }

    /// The same text without a piece. Of the joints around the piece, one that ends a sentence remains.
    pub(super) fn without(&self, at: usize) -> Option<Self> {
        let mut edited = self.clone();
        if at >= edited.pieces.len() || at >= edited.joints.len() {
            return None;
        }
        edited.pieces.remove(at);
        let before = edited.joints.remove(at);
        if let Some(after) = edited.joints.get_mut(at)
            && (at == 0 || ends_sentence(&before) && !ends_sentence(after))
        {
            *after = before;
        }
        Some(edited)
    }

    /// The pieces of each sentence.
    pub(super) fn sentences(&self) -> Vec<Range<usize>> {
        let starts = self.joints.iter().enumerate().filter(|(at, joint)| *at == 0 || has_sentence_end(joint));
        let starts: Vec<usize> = starts.map(|(at, _)| at).collect();
        let ends = starts.iter().skip(1).copied().chain([self.pieces.len()]);
        starts.iter().copied().zip(ends).map(|(start, end)| start..end).collect()
    }

    /// The same text with a sentence repeated right after itself.
    pub(super) fn with_sentence_twice(&self, sentence: &Range<usize>) -> Option<Self> {
        let copy = self.pieces.get(sentence.clone())?;
        let mut joints = self.joints.get(sentence.clone())?.to_vec();
        ". ".clone_into(joints.first_mut()?);
        let (before, after) = self.pieces.split_at_checked(sentence.end)?;
        let (joints_before, joints_after) = self.joints.split_at_checked(sentence.end)?;
        Some(Self {
            pieces: [before, copy, after].concat(),
            joints: [joints_before, joints.as_slice(), joints_after].concat(),
            tail: self.tail.clone(),
        })
    }
}

/// The numbers of the words with which pieces begin.
fn find_piece_starts(text: &str, words: &[FaultWord]) -> Vec<usize> {
    let mut starts = Vec::new();
    for (at, word) in words.iter().enumerate().filter(|(_, word)| !is_joining(word)) {
        let last = words.iter().take(at).rev().find(|before| !is_joining(before));
        let Some(last) = last else {
            starts.push(at);
            continue;
        };
        let joint = text.get(last.span[1]..word.span[0]).unwrap_or_default();
        let is_joined = joint.contains(',') || list_words(joint).iter().any(is_joining);
        if has_sentence_end(joint) || is_joined && starts_clause(text, words, at) {
            starts.push(at);
        }
    }
    starts
}

/// Whether a clause begins with the word at `at`, given that a comma, "and" or "then" comes before it.
fn starts_clause(text: &str, words: &[FaultWord], at: usize) -> bool {
    let low = |at: usize| words.get(at).map_or("", |word| word.low.as_str());
    if CLAUSE_VERBS.contains(&low(at)) {
        return true;
    }
    if LEADING_ADVERBS.contains(&low(at)) {
        return CLAUSE_VERBS.contains(&low(at + 1));
    }
    LEADING_PREPOSITIONS.contains(&low(at)) && low(at + 1) == "the" && {
        let rest = words.get(at + 2..).unwrap_or_default();
        let same_clause = rest.iter().take(MAX_LEADING_WORDS).take_while(|word| {
            let gap = text.get(..word.span[0]).unwrap_or_default();
            !is_joining(word) && !gap.trim_end().ends_with([',', '.', '!', '?'])
        });
        same_clause.skip(1).any(|word| CLAUSE_VERBS.contains(&word.low.as_str()))
    }
}

fn is_joining(word: &FaultWord) -> bool {
    JOINING_WORDS.contains(&word.low.as_str())
}

/// Whether a joint contains the end of a sentence.
fn has_sentence_end(joint: &str) -> bool {
    joint.contains(['.', '!', '?', ';', '\n'])
}

/// Whether the word after a joint begins a sentence: "then" has taken that place in ". Then ".
fn ends_sentence(joint: &str) -> bool {
    joint.trim_end().ends_with(['.', '!', '?'])
}

/// A text with its first letter changed, if that is a letter of ASCII.
fn with_first_letter(text: &str, change: fn(&char) -> char) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| change(&first).to_string() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "Go past the bed and turn left. Then enter the hall, in the hall take a right, and then wait by \
                        the sink and windows.";

    fn cut(text: &str) -> FaultText {
        FaultText::from_text(text).unwrap()
    }

    #[test]
    fn from_text_cuts_at_sentences_and_before_verbs() {
        let pieces = [
            "go past the bed",
            "turn left",
            "enter the hall",
            "in the hall take a right",
            "wait by the sink and windows",
        ];
        assert_eq!(cut(TEXT).pieces, pieces);
        assert_eq!(cut(TEXT).render(), TEXT);
        assert_eq!(cut("Stop").pieces, ["stop"]);
        assert_eq!(FaultText::from_text(""), None);
        assert_eq!(FaultText::from_text("stop without a capital."), None, "it would come out with one");
    }

    #[test]
    fn with_exchange_moves_capitals() {
        let edited = cut(TEXT).with_exchange(1, 2).unwrap().render();
        assert!(edited.starts_with("Go past the bed and enter the hall. Then turn left, in the hall"), "{edited}");
        let edited = cut("Turn left. Enter the hall.").with_exchange(0, 1).unwrap().render();
        assert_eq!(edited, "Enter the hall. Turn left.");
        assert_eq!(cut("Stop.").with_exchange(0, 1), None);
    }

    #[test]
    fn without_keeps_the_ends_of_sentences() {
        let left = |text: &str, at| cut(text).without(at).unwrap().render();
        assert_eq!(left("Turn left. Go on, stop.", 0), "Go on, stop.");
        assert_eq!(left("Turn left. Go on, stop.", 1), "Turn left. Stop.");
        assert_eq!(left("Turn left. Go on, stop.", 2), "Turn left. Go on.");
        assert_eq!(left("Turn left and go on. Stop.", 1), "Turn left. Stop.");
        assert_eq!(cut("Stop.").without(1), None);
    }

    #[test]
    fn with_sentence_twice_repeats_all_pieces_of_it() {
        let text = cut("Go on and turn left. Stop.");
        assert_eq!(text.sentences(), [0..2, 2..3]);
        let twice = text.with_sentence_twice(&(0..2)).unwrap().render();
        assert_eq!(twice, "Go on and turn left. Go on and turn left. Stop.");
        assert_eq!(text.with_sentence_twice(&(2..3)).unwrap().render(), "Go on and turn left. Stop. Stop.");
        assert_eq!(text.with_sentence_twice(&(2..4)), None);
    }

    #[test]
    fn with_words_changes_one_piece_alone() {
        let text = cut("Turn left. Turn left.");
        assert_eq!(text.with_words(1, [5, 9], "right").unwrap().render(), "Turn left. Turn right.");
        assert_eq!(text.with_words(1, [5, 99], "right"), None);
        assert_eq!(text.with_words(2, [0, 1], "right"), None);
    }
}
