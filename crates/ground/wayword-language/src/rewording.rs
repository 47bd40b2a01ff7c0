//! Finds the words of a text for a turn, a side, a climb, or the way past or through a place, and exchanges left with right and
//! up with down. Repairs and alternatives replace just these words.

use crate::{
    reading::TextReading,
    text::{TextToken, split_tokens},
};
use std::borrow::Cow;

crate::data::lists! {
    "languages/en/rewording.txt";
    words: SIDES, CLIMBS, TURNING, BEFORE_TURN, BELONGING, LINKING, BEFORE_NAME, PREPOSITIONS, WAY_VERBS, WALKING;
    phrases:;
}

/// Most words between the verb of a turn and its side, as "a sharp" in "take a sharp right". A verb farther away does not
/// belong to the turn.
const TURN_REACH_WORDS: usize = 6;
/// The words for the way past a place are looked for among this many tokens before it.
const WAY_REACH_TOKENS: usize = 5;

/// A text with its tokens. The methods take byte ranges of it, and find no words in a range that does not fit it.
#[derive(Debug)]
pub struct TokenisedText<'a> {
    text: &'a str,
    tokens: Cow<'a, [TextToken]>,
}

/// The words before a place for how the walk passes it: "walk past", "head out of", "leave".
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WayWords {
    /// Their byte range: "walk past".
    pub span: [usize; 2],
    /// The verb to write before a new preposition, with a space behind it: "walk "; empty where there is none.
    pub verb: String,
}

impl<'a> TokenisedText<'a> {
    /// A text.
    #[must_use]
    pub fn from_text(text: &'a str) -> Self {
        Self { text, tokens: Cow::Owned(split_tokens(text)) }
    }

    /// A text that was read before, with the tokens of its reading.
    #[must_use]
    pub fn from_reading(text: &'a str, reading: &'a TextReading) -> Self {
        Self { text, tokens: Cow::Borrowed(reading.tokens()) }
    }

    /// The whole text.
    #[must_use]
    pub fn text(&self) -> &'a str {
        self.text
    }

    /// The words of a byte range, as they are written.
    #[must_use]
    pub fn words_of(&self, [from, to]: [usize; 2]) -> &'a str {
        self.text.get(from..to).unwrap_or_default()
    }

    /// The tokens within a byte range.
    fn tokens_within(&self, [from, to]: [usize; 2]) -> &[TextToken] {
        let first = self.tokens.partition_point(|token| token.span[0] < from);
        let end = self.tokens.partition_point(|token| token.span[1] <= to);
        self.tokens.get(first..end.max(first)).unwrap_or_default()
    }

    /// The byte range of the words of a turn in a step, from its verb on: "turn slightly left". `side` is the byte range of
    /// the word "left" or "right".
    #[must_use]
    pub fn turn_words(&self, step: [usize; 2], side: [usize; 2]) -> [usize; 2] {
        let before = self.tokens_within([step[0], side[0]]);
        let between =
            before.iter().rev().take_while(|token| BEFORE_TURN.contains(&&*token.word)).take(TURN_REACH_WORDS);
        let at = before.len() - between.count();
        let verb = before[..at].last().filter(|token| TURNING.contains(&&*token.word));
        let from = verb.map_or_else(|| side_beginning(&before[at..], side[0]), |verb| verb.span[0]);
        let next = self.tokens.iter().find(|token| token.span[0] >= side[1]).filter(|next| next.word == "turn");
        [from, next.map_or(side[1], |next| next.span[1])]
    }

    /// The first words of a step that locate something on a side: "on your left".
    #[must_use]
    pub fn side_words(&self, step: [usize; 2]) -> Option<[usize; 2]> {
        let tokens = self.tokens_within(step);
        let at = tokens.iter().position(|token| opposite_word(&token.word, &SIDES).is_some())?;
        Some([side_beginning(&tokens[..at], tokens[at].span[0]), tokens[at].span[1]])
    }

    /// Words with left and right exchanged; `None` where they name no side.
    #[must_use]
    pub fn other_side(&self, span: [usize; 2]) -> Option<String> {
        self.exchange_opposites(span, &SIDES)
    }

    /// The last word of a step for up or down, and its opposite. In "walk down the hall and up the stairs" it is "up".
    #[must_use]
    pub fn climb_word(&self, step: [usize; 2], is_up: bool) -> Option<([usize; 2], String)> {
        // The list has pairs: the word for up, and then its opposite.
        let is_climb = |token: &&TextToken| CLIMBS.chunks_exact(2).any(|pair| pair[usize::from(!is_up)] == token.word);
        let span = self.tokens_within(step).iter().rev().find(is_climb)?.span;
        Some((span, self.exchange_opposites(span, &CLIMBS)?))
    }

    /// A step without the marks and words that join it to others; `None` where no other words are left.
    #[must_use]
    pub fn step_words(&self, step: [usize; 2]) -> Option<[usize; 2]> {
        let is_content = |token: &&TextToken| token.is_word() && !LINKING.contains(&&*token.word);
        let tokens = self.tokens_within(step);
        Some([tokens.iter().find(is_content)?.span[0], tokens.iter().rev().find(is_content)?.span[1]])
    }

    /// The words before a place for the way by it: "walk past", "exit". `None` where there are none.
    #[must_use]
    pub fn way_words(&self, step: [usize; 2], place: [usize; 2]) -> Option<WayWords> {
        let before = self.tokens_within([step[0], place[0]]);
        let near = &before[before.len().saturating_sub(WAY_REACH_TOKENS)..];
        let is_in = |list: &[&str], token: &TextToken| list.contains(&&*token.word);
        let last = near.iter().rposition(|token| is_in(&PREPOSITIONS, token) || is_in(&WAY_VERBS, token))?;
        if is_in(&WAY_VERBS, &near[last]) {
            // Such a verb ("leave") has no preposition, so the new words need another verb.
            return Some(WayWords { span: near[last].span, verb: "walk ".into() });
        }
        let first = near[..last].iter().rposition(|token| !is_in(&PREPOSITIONS, token)).map_or(0, |at| at + 1);
        let verb = near[..first].last().filter(|token| is_in(&WALKING, token));
        let from = verb.map_or(near[first].span[0], |verb| verb.span[0]);
        let verb = verb.map_or_else(String::new, |verb| format!("{} ", verb.word));
        Some(WayWords { span: [from, near[last].span[1]], verb })
    }

    /// Whether no word before a name describes the thing: before it is an article or a word of the way, or no word at
    /// all.
    #[must_use]
    pub fn is_bare(&self, name: [usize; 2]) -> bool {
        let before = self.tokens[..self.tokens.partition_point(|token| token.span[1] <= name[0])].last();
        let describes_thing = |token: &TextToken| token.is_word() && !BEFORE_NAME.contains(&&*token.word);
        !before.is_some_and(describes_thing)
    }

    /// A name together with the article "a" or "an" right before it, because the article depends on the name.
    #[must_use]
    pub fn with_its_article(&self, name: [usize; 2]) -> [usize; 2] {
        let before = self.tokens[..self.tokens.partition_point(|token| token.span[1] <= name[0])].last();
        let article = before.filter(|token| matches!(token.word.as_str(), "a" | "an"));
        [article.map_or(name[0], |token| token.span[0]), name[1]]
    }

    /// The words of a byte range with their opposites; `None` where they have none.
    fn exchange_opposites(&self, [from, to]: [usize; 2], pairs: &[&str]) -> Option<String> {
        let (mut exchanged, mut copied_to) = (String::new(), from);
        for token in self.tokens_within([from, to]) {
            let Some(other) = opposite_word(&token.word, pairs) else { continue };
            exchanged.push_str(self.words_of([copied_to, token.span[0]]));
            exchanged.push_str(&in_capitals_of(self.words_of(token.span), other));
            copied_to = token.span[1];
        }
        exchanged.push_str(self.words_of([copied_to, to]));
        (copied_to > from).then_some(exchanged)
    }
}

/// Where the words that belong to a side begin: at "on" for "on your left".
fn side_beginning(before: &[TextToken], side: usize) -> usize {
    let belong = before.iter().rev().take_while(|token| BELONGING.contains(&&*token.word));
    belong.last().map_or(side, |first| first.span[0])
}

/// The other word of a pair, in a list with the two words of each pair one after the other.
fn opposite_word<'a>(word: &str, pairs: &[&'a str]) -> Option<&'a str> {
    let at = pairs.iter().position(|listed| *listed == word)?;
    // An even place and the odd one behind it are a pair.
    pairs.get(at ^ 1).copied()
}

/// Words in the capitals of others: all of them, the first one, or none.
#[must_use]
pub fn in_capitals_of(like: &str, words: &str) -> String {
    let mut letters = like.chars().filter(|c| c.is_alphabetic());
    let is_first = letters.next().is_some_and(char::is_uppercase);
    let rest: Vec<char> = letters.collect();
    if is_first && !rest.is_empty() && rest.iter().all(|c| c.is_uppercase()) {
        return words.to_uppercase();
    }
    let mut chars = words.chars();
    match chars.next() {
        Some(letter) if is_first => letter.to_uppercase().chain(chars).collect(),
        _ => words.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn range(text: &str, words: &str) -> [usize; 2] {
        let from = text.find(words).unwrap();
        [from, from + words.len()]
    }

    #[test]
    fn turn_begins_with_the_verb() {
        for (text, side, told, other) in [
            ("Turn left.", "left", "Turn left", "Turn right"),
            ("then take a sharp Right at the sofa", "Right", "take a sharp Right", "take a sharp Left"),
            ("walk on and make a left turn", "left", "make a left turn", "make a right turn"),
            ("the door to your left", "left", "to your left", "to your right"),
            ("geh LEFT", "LEFT", "LEFT", "RIGHT"),
        ] {
            let tokenised = TokenisedText::from_text(text);
            let span = tokenised.turn_words([0, text.len()], range(text, side));
            assert_eq!((tokenised.words_of(span), tokenised.other_side(span).as_deref()), (told, Some(other)));
        }
    }

    #[test]
    fn a_side_and_a_climb_are_found_in_their_step() {
        let text = "Walk down the hall and up the stairs, the door is on your left";
        let tokenised = TokenisedText::from_text(text);
        let step = [0, text.len()];
        assert_eq!(tokenised.words_of(tokenised.side_words(step).unwrap()), "on your left");
        let (span, other) = tokenised.climb_word(step, true).unwrap();
        assert_eq!((tokenised.words_of(span), &*other), ("up", "down"));
        assert_eq!(tokenised.climb_word([0, 10], true), None);
        assert_eq!(
            tokenised.words_of(tokenised.step_words(range(text, "and up the stairs, ")).unwrap()),
            "up the stairs"
        );
        assert_eq!(tokenised.step_words(range(text, "and ")), None);
    }

    #[test]
    fn way_finds_a_verb_or_a_preposition_with_its_verb() {
        for (text, words, verb) in [
            ("Walk past the sofa", "Walk past", "walk "),
            ("and head out of the large sofa", "head out of", "head "),
            ("Leave the sofa", "Leave", "walk "),
            ("down to the sofa", "down to", ""),
        ] {
            let tokenised = TokenisedText::from_text(text);
            let way = tokenised.way_words([0, text.len()], range(text, "sofa")).unwrap();
            assert_eq!((tokenised.words_of(way.span), &*way.verb), (words, verb));
        }
        assert_eq!(TokenisedText::from_text("the sofa").way_words([0, 8], [4, 8]), None);
    }

    #[test]
    fn a_name_is_bare_where_no_word_describes_it() {
        for (text, is_bare) in [("by the oven", true), ("oven", true), ("past an oven", true), ("a gas oven", false)] {
            assert_eq!(TokenisedText::from_text(text).is_bare(range(text, "oven")), is_bare, "{text}");
        }
    }

    #[test]
    fn with_its_article_includes_a_or_an() {
        let (text, tokenised) = ("by an oven", TokenisedText::from_text("by an oven"));
        assert_eq!(tokenised.words_of(tokenised.with_its_article(range(text, "oven"))), "an oven");
        assert_eq!(tokenised.with_its_article([3, 5]), [3, 5]);
    }

    #[test]
    fn ranges_that_do_not_fit_have_no_words() {
        let tokenised = TokenisedText::from_text("門 left 🪑");
        for span in [[1, 2], [9, 3], [usize::MAX, usize::MAX]] {
            assert_eq!(tokenised.words_of(span), "");
            assert_eq!((tokenised.side_words(span), tokenised.step_words(span)), (None, None));
        }
    }
}
