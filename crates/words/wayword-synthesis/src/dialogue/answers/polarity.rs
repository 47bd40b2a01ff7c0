//! Decides whether an answer as a whole means yes, no or not sure, and how far a "no" or a "maybe" reaches within a
//! sentence.
//!
//! The method is NegEx (Chapman et al. 2001, doi 10.1006/jbin.2001.1029): a trigger such as "no" or "without" denies
//! the nouns after it up to a word that ends its reach. The word lists are for the ways in which people and models
//! describe pictures.

use std::ops::Range;
use wayword_core::WitnessAnswer;
use wayword_language::{
    answers::{
        AFTER_NOUN, AUXILIARIES, DOUBTS, ENDS, IS_NOT, MAYBE, MEANWHILE, NEW_NOUN, NO, NO_DENIAL, NO_OBJECT,
        PERCEIVING, SHORT, SIGNS, STOPPERS, YES, YES_ALONE,
    },
    text::split_words,
};

/// The meaning of an answer to a yes-or-no question.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AnswerPolarity {
    Yes,
    No,
    /// The answer expresses doubt.
    Unsure,
    /// The answer is no yes, no "no" and no doubt; the things that it names decide.
    Open,
}

/// The polarity of an answer, from how it begins, or from the yes or no after its first comma ("Looking again, no.").
/// Doubt in the first sentence outweighs both.
pub(super) fn polarity_of(answer: &str) -> AnswerPolarity {
    let answer = answer.replace('’', "'");
    let first = answer.split_inclusive(['.', '!', '?', '\n']).find(|part| part.contains(char::is_alphanumeric));
    let first = first.unwrap_or_default();
    match words_polarity(&split_words(first)) {
        AnswerPolarity::Open => {}
        polarity => return polarity,
    }
    if let Some((_, rest)) = first.split_once(',').filter(|(before, _)| split_words(before).len() <= 8) {
        let rest = split_words(rest);
        if rest.first().is_some_and(|first| matches!(first.as_str(), "yes" | "no")) {
            return words_polarity(&rest);
        }
    }
    let all_words = split_words(&answer);
    if is_unsure(&all_words.iter().map(String::as_str).collect::<Vec<_>>()) {
        AnswerPolarity::Unsure
    } else {
        AnswerPolarity::Open
    }
}

/// The polarity of the words at the beginning of an answer.
fn words_polarity(words: &[String]) -> AnswerPolarity {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let words = words.strip_prefix(&["well"]).unwrap_or(&words);
    let longest = |phrases: &[Vec<&'static str>]| {
        phrases.iter().filter(|phrase| words.starts_with(phrase)).map(|phrase| phrase.len()).max()
    };
    if is_unsure(words) || longest(&MAYBE).is_some() {
        return AnswerPolarity::Unsure;
    }
    // "There are two on the left." is a yes, but "There are two lamps." is not.
    let alone = |phrase: &&Vec<&str>, answer: &[&str]| {
        answer
            .strip_prefix(phrase.as_slice())
            .is_some_and(|rest| rest.first().is_none_or(|next| AFTER_NOUN.contains(next)))
    };
    let alone = YES_ALONE.iter().filter(|phrase| alone(phrase, words)).map(Vec::len).max();
    match (longest(&YES).or(alone).unwrap_or(0), longest(&NO).unwrap_or(0)) {
        (0, 0) => AnswerPolarity::Open,
        (yes, no) if yes >= no => AnswerPolarity::Yes,
        _ => AnswerPolarity::No,
    }
}

/// Whether words contain a phrase of doubt.
pub(super) fn is_unsure(words: &[&str]) -> bool {
    (0..words.len()).any(|at| doubt_at(&words[at..]).is_some())
}

/// A sentence: its words and punctuation marks in lower case, and the ranges of words that name things and rooms, in
/// order.
pub(super) struct AnswerSentence<'a> {
    pub(super) words: &'a [&'a str],
    pub(super) nouns: &'a [Range<usize>],
}

/// How far a trigger reaches, and the witness that it gives to the nouns within.
#[derive(Clone, Copy)]
struct TriggerReach {
    /// The word at which the reach begins, right after the trigger.
    from: usize,
    /// The witness of the nouns that it reaches: denied or unsure.
    witness: WitnessAnswer,
    /// Whether it covers a whole list ("a lamp, a bed or a sofa"), as a negated verb does, and not only the first noun.
    over_articles: bool,
    /// Whether only the end of the sentence or a "but" ends it.
    to_the_end: bool,
}

/// Words that deny a verb or a noun after them.
const NEGATION_WORDS: [&str; 2] = ["not", "never"];

/// The length of the phrase of doubt with which words begin, if they do.
pub(super) fn doubt_at(words: &[&str]) -> Option<usize> {
    DOUBTS.iter().filter(|phrase| words.starts_with(phrase)).map(|phrase| phrase.len()).max()
}

impl AnswerSentence<'_> {
    /// The witness for each noun: seen, unless a trigger denies or doubts it.
    pub(super) fn noun_witnesses(&self) -> Vec<WitnessAnswer> {
        let mut witnesses = vec![WitnessAnswer::Seen; self.nouns.len()];
        for reach in (0..self.words.len()).filter_map(|at| self.trigger_at(at)) {
            for noun in self.nouns_within(reach) {
                witnesses[noun] =
                    if witnesses[noun] == WitnessAnswer::Denied { WitnessAnswer::Denied } else { reach.witness };
            }
        }
        for noun in 0..self.nouns.len() {
            if self.is_said_absent(noun) {
                let mut first = noun;
                while first > 0 && self.is_joined(first - 1) {
                    first -= 1;
                }
                witnesses[first..=noun].fill(WitnessAnswer::Denied);
            }
        }
        witnesses
    }

    /// The word at a position; an empty one behind the end of the sentence.
    fn word_at(&self, at: usize) -> &str {
        self.words.get(at).copied().unwrap_or("")
    }

    /// The number of the noun that begins at a word.
    fn noun_at(&self, at: usize) -> Option<usize> {
        self.nouns.iter().position(|noun| noun.start == at)
    }

    /// The reach of the trigger that begins at a word, if one does.
    fn trigger_at(&self, at: usize) -> Option<TriggerReach> {
        let word = self.word_at(at);
        let denial = |from, over_articles| {
            Some(TriggerReach { from, witness: WitnessAnswer::Denied, over_articles, to_the_end: false })
        };
        if let Some(length) = doubt_at(&self.words[at..]) {
            return Some(TriggerReach {
                from: at + length,
                witness: WitnessAnswer::Unsure,
                over_articles: true,
                to_the_end: true,
            });
        }
        match word {
            "no" if NO_DENIAL.contains(&self.word_at(at + 1)) => None,
            "no" | "without" | "lacks" | "lacking" => denial(at + 1, false),
            "neither" | "nor" => denial(at + 1, true),
            "absence" | "lack" | "devoid" if self.word_at(at + 1) == "of" => denial(at + 2, false),
            "instead" if self.word_at(at + 1) == "of" => denial(at + 2, false),
            "rather" if self.word_at(at + 1) == "than" => denial(at + 2, false),
            "there's" if NEGATION_WORDS.contains(&self.word_at(at + 1)) => denial(at + 2, true),
            word if IS_NOT.contains(&word) && self.is_indefinite(at + 1) => denial(at + 1, true),
            word if NEGATION_WORDS.contains(&word) && self.is_indefinite(at + 1) => denial(at + 1, true),
            word if SHORT.contains(&word) => self.negated_verb(at + 1).and_then(|from| denial(from, true)),
            word if NEGATION_WORDS.contains(&word) && at > 0 && AUXILIARIES.contains(&self.word_at(at - 1)) => {
                self.negated_verb(at + 1).and_then(|from| denial(from, true))
            }
            _ => self.hedge_at(at),
        }
    }

    /// The reach of a word of doubt: "maybe a lamp", "might be a lamp".
    fn hedge_at(&self, at: usize) -> Option<TriggerReach> {
        let is_hedge = match self.word_at(at) {
            "maybe" | "possibly" | "perhaps" | "potentially" | "presumably" | "probably" => true,
            "might" | "may" | "could" => {
                (1..=3).any(|ahead| matches!(self.word_at(at + ahead), "be" | "have" | "contain" | "show"))
            }
            _ => false,
        };
        is_hedge.then_some(TriggerReach {
            from: at + 1,
            witness: WitnessAnswer::Unsure,
            over_articles: false,
            to_the_end: false,
        })
    }

    fn is_indefinite(&self, at: usize) -> bool {
        matches!(self.word_at(at), "a" | "an" | "any" | "one")
    }

    /// Where the object of a negated verb begins ("not see | a lamp"); `after` is the word after the "not".
    fn negated_verb(&self, after: usize) -> Option<usize> {
        let mut at = after;
        while at < after + 5 && MEANWHILE.contains(&self.word_at(at)) {
            at += 1;
        }
        let verb = self.word_at(at);
        // "does not appear to be a lamp": the last word before the noun was taken for one in between.
        let in_between = at > after && matches!(self.word_at(at - 1), "is" | "are" | "be" | "to");
        let mut from = match verb {
            verb if PERCEIVING.contains(&verb) => at + 1,
            _ if in_between && self.is_indefinite(at) => at,
            _ => return None,
        };
        while matches!(self.word_at(from), "that" | "there" | "there's" | "is" | "are" | "to" | "be" | "like" | "see") {
            from += 1;
        }
        Some(from)
    }

    /// The nouns that a trigger reaches.
    fn nouns_within(&self, reach: TriggerReach) -> Vec<usize> {
        let mut found: Vec<usize> = Vec::new();
        let mut at = reach.from;
        while at < self.words.len() {
            let word = self.word_at(at);
            if ENDS.contains(&word) || (reach.to_the_end && word == "but") {
                break;
            }
            if let Some(noun) = self.noun_at(at) {
                found.push(noun);
                at = self.nouns[noun].end;
                continue;
            }
            if !reach.to_the_end && self.ends_reach(at, reach, !found.is_empty()) {
                break;
            }
            at += 1;
        }
        found
    }

    /// Whether the reach of a trigger ends at a word that begins no noun. `had_noun`: whether it has reached a noun
    /// before.
    fn ends_reach(&self, at: usize, reach: TriggerReach, had_noun: bool) -> bool {
        let word = self.word_at(at);
        if STOPPERS.contains(&word) {
            return true;
        }
        if !had_noun {
            let of_signs = word == "of" && at > 0 && SIGNS.contains(&self.word_at(at - 1));
            let elsewhere = AFTER_NOUN.contains(&word) && !of_signs && !matches!(word, "have" | "there" | "is" | "are");
            let too_far = at > reach.from + 6;
            let hedged_verb =
                reach.witness == WitnessAnswer::Unsure && matches!(word, "be" | "have" | "contain" | "show");
            return !hedged_verb
                && (elsewhere
                    || too_far
                    || word == ","
                    || (NO_OBJECT.contains(&word) && reach.witness == WitnessAnswer::Denied));
        }
        match word {
            "," => !self.goes_on(at + 1, reach),
            "and" => !self.goes_on(at + 1, reach),
            word => AFTER_NOUN.contains(&word),
        }
    }

    /// Whether a list goes on at a word behind a comma or an "and".
    fn goes_on(&self, at: usize, reach: TriggerReach) -> bool {
        match self.word_at(at) {
            "or" | "nor" | "any" => true,
            "and" => self.goes_on(at + 1, reach),
            word if NEW_NOUN.contains(&word) => {
                reach.over_articles
                    && word != "the"
                    && self.words[at..].iter().any(|word| matches!(*word, "or" | "nor"))
            }
            _ => (at..at + 3).any(|at| self.noun_at(at).is_some()),
        }
    }

    /// "The mirror is not visible", "a mirror cannot be seen", "the mirror is absent".
    fn is_said_absent(&self, noun: usize) -> bool {
        let mut at = self.nouns[noun].end;
        while at < self.nouns[noun].end + 4
            && matches!(self.word_at(at), "that" | "you" | "mentioned" | "itself" | "really" | "actually" | "also")
        {
            at += 1;
        }
        let rest = |from: usize| (from..from + 4).map(|at| self.word_at(at)).collect::<Vec<_>>();
        match (self.word_at(at), self.word_at(at + 1)) {
            ("is" | "are" | "was" | "were", "absent" | "missing" | "invisible" | "nonexistent") => true,
            ("is" | "are" | "was" | "were", "not") => says_present(&rest(at + 2)),
            ("can" | "could", "not") | ("does" | "do" | "did", "not") => says_present(&rest(at + 2)),
            (word, _) if IS_NOT.contains(&word) || SHORT.contains(&word) => says_present(&rest(at + 1)),
            _ => false,
        }
    }

    /// Whether a noun and the next one belong to one list: only commas, articles, "and" or "or" are between them.
    fn is_joined(&self, noun: usize) -> bool {
        let between = &self.words[self.nouns[noun].end..self.nouns[noun + 1].start];
        between.iter().any(|word| matches!(*word, "and" | "or" | "nor"))
            && between.iter().all(|word| matches!(*word, "," | "and" | "or" | "nor" | "a" | "an" | "the" | "any"))
    }
}

/// Whether words say that something is in the picture: "visible", "in the picture", "be seen".
fn says_present(words: &[&str]) -> bool {
    let skipped = words.iter().take_while(|word| matches!(**word, "be" | "really" | "actually" | "to")).count();
    match &words[skipped..] {
        [
            "visible" | "present" | "there" | "shown" | "seen" | "pictured" | "included" | "depicted" | "found"
            | "exist" | "appear" | "detected",
            ..,
        ] => true,
        ["in", "view" | "sight", ..] => true,
        ["in", "the" | "this", whole, ..] => {
            matches!(*whole, "picture" | "image" | "photo" | "room" | "view" | "scene")
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_say_yes_no_or_neither() {
        for (wanted, answers) in [
            (
                AnswerPolarity::Yes,
                "Yes | yes. | Yes, there are two. | There is one. | No doubt. | I think so. | Of course",
            ),
            (
                AnswerPolarity::No,
                "No | no. | NO! | No, there isn't. | None | Not that I can see. | There is no TV. | \
                 I don't think so. | There are none. | No, I don't see one. | I cannot see a lamp. | \
                 There isn’t one. | Neither. | It does not appear so.",
            ),
            (
                AnswerPolarity::Unsure,
                "I am not sure. | Unclear | I can't tell | It is hard to say. | Unknown. | Maybe | \
                 There might be. | No, I'm not sure | It is not clear from the picture. | I don't know",
            ),
            (
                AnswerPolarity::Open,
                "There is a lamp. | I can see a lamp. | There are two lamps. |  | A bed. | A bed is. | \
                 On the left | 🤖",
            ),
        ] {
            for answer in answers.split(" | ") {
                assert_eq!(polarity_of(answer), wanted, "{answer}");
            }
        }
    }
}
