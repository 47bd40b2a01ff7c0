//! Splits a text into clauses, and decides which of them give the task ("clean the sink") and which only lead the way.

use super::{
    super::names::{LexiconName, find_names_with, split_words},
    vocabulary::{FILLER_WORDS, LOOK_WORDS, MOVE_VERBS, NO_VERBS, NON_TASK_OPENERS},
};
use std::collections::BTreeSet;

/// A text as words with its marks and its names.
pub(super) struct ListenerText {
    /// All words, in lower case.
    pub words: Vec<String>,
    /// For each word, whether it is the first of the text or after a mark.
    pub(super) after_mark: Vec<bool>,
    /// The names of rooms and things among the words.
    pub(super) names: Vec<LexiconName>,
}

impl ListenerText {
    /// Splits a text. `known`: names of things in addition to those of the lexicon.
    pub(super) fn from_text(text: &str, known: &BTreeSet<String>) -> Self {
        let (mut all, mut after_mark) = (Vec::new(), Vec::new());
        for part in text.split(['.', ',', ';', ':', '!', '?']) {
            let part = split_words(part);
            after_mark.extend((0..part.len()).map(|at| at == 0));
            all.extend(part);
        }
        let names = find_names_with(&all, known);
        Self { words: all, after_mark, names }
    }

    /// The clauses, as ranges of words: first word, and the word after the last.
    pub(super) fn clause_ranges(&self) -> Vec<[usize; 2]> {
        let begins = |at: &usize| {
            let before = at.checked_sub(1).map(|at| self.words[at].as_str());
            *at == 0
                || self.after_mark[*at]
                || (matches!(before, Some("and" | "then" | "to")) && self.is_verb(*at, before))
        };
        let starts: Vec<usize> = (0..self.words.len()).filter(begins).collect();
        let ends = starts.iter().skip(1).copied().chain([self.words.len()]);
        starts.iter().copied().zip(ends).map(|(from, to)| [from, to]).collect()
    }

    /// Whether a clause may begin with a word after "and", "then" or "to", which means that the word is a verb: it is in no list of other
    /// words and in no name, or an article or particle follows. After "to", "the" or "me" must also follow, and neither the word
    /// itself nor the one before "to" may be a verb of motion.
    pub(super) fn is_verb(&self, at: usize, before: Option<&str>) -> bool {
        let word = self.words[at].as_str();
        let in_name = self.names.iter().any(|name| (name.start..name.end).contains(&at));
        let may_be_verb = !NO_VERBS.contains(&word) && !in_name && !LOOK_WORDS.contains(&word) && word != "then";
        let is_verb_by_list_or_follower = may_be_verb || self.has_object_or_particle(at);
        // "Go to the kitchen to clean the sink" begins a task; "go to the kitchen" does not.
        let precedes_the_or_me = || self.words.get(at + 1).is_some_and(|next| next == "the" || next == "me");
        // The word before "to" is the last of these.
        let follows_move = || self.words[..at - 1].last().is_some_and(|word| MOVE_VERBS.contains(&word.as_str()));
        is_verb_by_list_or_follower
            && (before != Some("to") || (precedes_the_or_me() && !MOVE_VERBS.contains(&word) && !follows_move()))
    }

    /// Whether a word is a verb by the word after it: "switch on", "water the".
    pub(super) fn has_object_or_particle(&self, at: usize) -> bool {
        let next = self.words.get(at + 1).map_or("", String::as_str);
        let is_never_verb = NO_VERBS.contains(&self.words[at].as_str());
        !is_never_verb && matches!(next, "the" | "a" | "an" | "on" | "off" | "me" | "up" | "down" | "out")
    }

    /// Whether a clause gives a task. Its first word that is no filler decides.
    pub(super) fn is_task(&self, [from, to]: [usize; 2]) -> bool {
        let Some(at) = (from..to).find(|at| !FILLER_WORDS.contains(&self.words[*at].as_str())) else { return false };
        let next = self.words.get(at + 1).filter(|_| at + 1 < to).map_or("", String::as_str);
        let has_thing =
            self.names.iter().any(|name| name.is_thing && !name.is_room && name.start > at && name.end <= to);
        let is_way = |words: &[&str]| words.contains(&next);
        match self.words[at].as_str() {
            "turn" => has_thing && !is_way(&["left", "right", "around", "back", "to"]),
            "take" | "make" => has_thing && !is_way(&["left", "right", "your"]) && !self.names_stairs(at, to),
            "get" => next != "to" && has_thing,
            "the" | "a" | "an" | "it" | "that" | "which" | "is" | "where" | "there" => false,
            word => {
                !MOVE_VERBS.contains(&word)
                    && !NON_TASK_OPENERS.contains(&word)
                    && !self.names.iter().any(|name| name.start == at)
            }
        }
    }

    /// Whether words of a range name stairs or a side, so that "take" and "make" command a move: "take the stairs".
    pub(super) fn names_stairs(&self, from: usize, to: usize) -> bool {
        self.words[from..to]
            .iter()
            .any(|word| matches!(word.as_str(), "stairs" | "staircase" | "steps" | "left" | "right"))
    }
}
