//! Gives each word of a text a role, and finds the clauses that the reader understood. The share of understood words
//! shows how far a verdict on the text can be trusted.

use super::{
    EventContent, ReadWord, TextClause, TextEvent, WordRole, numbers, places, role_words as r, stems::is_form_of,
    tokens::TokenSlice, vocabulary as v,
};
use crate::lexicon::{is_room, is_thing, normal_word};
use std::collections::BTreeSet;

/// The words of a text with their roles, and its clauses.
pub(super) fn read_coverage(
    tokens: TokenSlice<'_>,
    clauses: &[usize],
    events: &[TextEvent],
    known: &BTreeSet<String>,
) -> (Vec<ReadWord>, Vec<TextClause>) {
    let named = named_tokens(tokens, known);
    let roles_by_event = event_roles(tokens, events);
    let text = CoverageText { tokens, clauses, named };
    let roles: Vec<Option<WordRole>> = (0..tokens.len()).map(|at| text.role_at(at, roles_by_event[at])).collect();
    let words = roles.iter().enumerate().filter_map(|(at, role)| {
        let role = (*role)?;
        Some(ReadWord { span: tokens.span_of(at, at), role, is_counted: !r::STOP_WORDS.contains(&tokens.word_at(at)) })
    });
    (words.collect(), text.understood_clauses(&roles))
}

/// For each token, whether it belongs to a name of the lexicon or of the evidence.
fn named_tokens(tokens: TokenSlice<'_>, known: &BTreeSet<String>) -> Vec<bool> {
    let mut named = vec![false; tokens.len()];
    let mut at = 0;
    while at < tokens.len() {
        let end = places::name_end(tokens, at, known);
        named[at..end.unwrap_or(at)].fill(true);
        at = end.unwrap_or(at + 1);
    }
    named
}

/// For each token, the role that it gets from the event that it belongs to.
fn event_roles(tokens: TokenSlice<'_>, events: &[TextEvent]) -> Vec<Option<WordRole>> {
    let mut roles = vec![None; tokens.len()];
    for event in events {
        let Some(role) = role_for_event(&event.what) else { continue };
        let within = tokens.first_from(event.span[0])..tokens.first_from(event.span[1]);
        roles[within].fill(Some(role));
    }
    roles
}

/// The role of the words of an event. Those of a place are named or not, word by word.
fn role_for_event(what: &EventContent) -> Option<WordRole> {
    match what {
        EventContent::Place(_) => None,
        EventContent::Turn(_) => Some(WordRole::Turn),
        EventContent::Climb(_) | EventContent::Steps(_) => Some(WordRole::Climb),
        EventContent::Storey(_) | EventContent::Floor(_) => Some(WordRole::Storey),
        EventContent::Onward => Some(WordRole::Motion),
        EventContent::Stop => Some(WordRole::Stop),
        EventContent::Face { .. } => Some(WordRole::Facing),
        EventContent::Compass { .. } => Some(WordRole::Compass),
        EventContent::Distance { .. } => Some(WordRole::Distance),
    }
}

struct CoverageText<'a> {
    tokens: TokenSlice<'a>,
    clauses: &'a [usize],
    /// For each token, whether it belongs to a known name.
    named: Vec<bool>,
}

impl<'a> CoverageText<'a> {
    fn word_at(&self, at: usize) -> &'a str {
        self.tokens.word_at(at)
    }

    fn word_before(&self, at: usize) -> &'a str {
        self.tokens.word_before(at)
    }

    /// The role of a token; `None` for a mark.
    fn role_at(&self, at: usize, event_role: Option<WordRole>) -> Option<WordRole> {
        if !self.tokens.is_word(at) {
            return None;
        }
        let role =
            event_role.or_else(|| self.named[at].then_some(WordRole::Place)).or_else(|| self.role_from_context(at));
        Some(role.or_else(|| self.role_from_list(self.word_at(at))).unwrap_or(WordRole::Unknown))
    }

    /// The role of a word that depends on the words around it; `None` where they decide nothing.
    fn role_from_context(&self, at: usize) -> Option<WordRole> {
        let (word, before, next) = (self.word_at(at), self.word_before(at), self.word_at(at + 1));
        let is_number = !matches!(word, "bottom" | "ground") && v::floor_number(word).is_some()
            || word.starts_with(|c: char| c.is_ascii_digit());
        if matches!(word, "left" | "right") {
            return self.side_role(at);
        }
        if v::UNITS.contains(&word) && (numbers::is_number(before) || matches!(before, "few" | "of" | "more")) {
            return Some(WordRole::Distance);
        }
        if matches!(word, "leftmost" | "rightmost") {
            return Some(WordRole::Ordinal);
        }
        if is_number
            || numbers::is_number(word) && !matches!(word, "a" | "an" | "several" | "half")
            || matches!(word, "last" | "next" | "final")
        {
            return self.number_role(at);
        }
        // "The walk", "a level": a noun, whatever verb looks like it.
        let is_noun = v::DETERMINERS.contains(&before) && before != "that";
        let is_verb = !is_noun;
        let begins = at == 0 || !self.tokens.is_word(at - 1) || v::ADVERBS.contains(&before);
        let describes = !begins && (word.ends_with("ing") || word.ends_with("ed"));
        if describes && is_form_of(word, &r::RELATIONS) {
            return Some(WordRole::Relation);
        }
        if is_verb && matches!(word, "up" | "down") && !matches!(next, "" | "." | ",") {
            return Some(WordRole::Relation);
        }
        if is_verb && is_form_of(word, &r::MOTION) {
            return Some(WordRole::Motion);
        }
        let has_object = v::DETERMINERS.contains(&next) || next == "me";
        if (begins || is_verb && (word.ends_with("ing") || has_object)) && is_form_of(word, &r::TASKS) {
            return Some(WordRole::Task);
        }
        None
    }

    /// A number counts the noun behind it, or picks one of several.
    fn number_role(&self, at: usize) -> Option<WordRole> {
        let word = self.word_at(at);
        if numbers::ordinal_word(word).is_some() {
            return Some(WordRole::Ordinal);
        }
        if v::UNITS.contains(&self.word_at(at + 1)) {
            return Some(WordRole::Distance);
        }
        // "Office 12": a name.
        let is_name = self.named.get(at.wrapping_sub(1)) == Some(&true) || self.word_before(at) == "room";
        let counts = !is_name && self.tokens.is_word(at + 1) && numbers::is_number(word);
        counts.then_some(WordRole::Count)
    }

    /// A side that is no turn: of a place ("on your left", "the left door"), or "right" as an adverb.
    fn side_role(&self, at: usize) -> Option<WordRole> {
        let next = self.word_at(at + 1);
        let leads = matches!(
            self.word_before(at),
            "the"
                | "your"
                | "far"
                | "on"
                | "to"
                | "immediate"
                | "hand"
                | "its"
                | "and"
                | "or"
                | "upper"
                | "lower"
                | "top"
                | "bottom"
                | "slight"
        );
        let tells = matches!(next, "of" | "side" | "hand" | "most" | "corner" | "end" | "wall") || self.is_noun(at + 1);
        let adverb = self.word_at(at) == "right" && v::AFTER_ADVERB_RIGHT.contains(&next);
        match (adverb, leads || tells) {
            (true, _) => Some(WordRole::Manner),
            (false, true) => Some(WordRole::Side),
            _ => None,
        }
    }

    /// Whether a token belongs to a name, or can be on a side of the walker.
    fn is_noun(&self, at: usize) -> bool {
        self.named.get(at) == Some(&true) || v::HAVE_SIDES.contains(&self.word_at(at))
    }

    /// The role that a word has wherever it occurs.
    fn role_from_list(&self, word: &str) -> Option<WordRole> {
        let name = normal_word(word);
        let lists: [(&[&str], WordRole); 8] = [
            (&v::COLOURS, WordRole::Colour),
            (&["not", "never", "without", "neither", "nor", "avoid", "cannot", "no"], WordRole::Denial),
            (&["up", "down", "upstairs", "downstairs", "upwards", "downwards", "upward", "downward"], WordRole::Climb),
            (&r::CONNECTIVES, WordRole::Connective),
            (&r::RELATIONS, WordRole::Relation),
            (&r::GENERAL, WordRole::General),
            (&r::MANNER, WordRole::Manner),
            (&r::STOP_WORDS, WordRole::Filler),
        ];
        let listed = lists.into_iter().find(|(list, _)| list.contains(&word)).map(|(_, role)| role);
        let denies = word.ends_with("n't") || word.ends_with("n’t");
        listed
            .or_else(|| denies.then_some(WordRole::Denial))
            .or_else(|| r::GENERAL.contains(&name.as_str()).then_some(WordRole::General))
            .or_else(|| is_form_of(word, &r::RELATIONS).then_some(WordRole::Relation))
            .or_else(|| (is_adverb(word) || is_descriptive(word)).then_some(WordRole::Manner))
            .or_else(|| (is_thing(&name) || is_room(&name)).then_some(WordRole::Place))
    }

    /// The clauses by their numbers: each is understood unless the first word with a meaning in it is unknown.
    fn understood_clauses(&self, roles: &[Option<WordRole>]) -> Vec<TextClause> {
        let count = self.clauses.last().map_or(0, |last| last + 1);
        let mut clauses = vec![TextClause { span: [0, 0], understood: true }; count];
        // Whether a word with a meaning has come in the clause.
        let mut decided = vec![false; count];
        for (at, role) in roles.iter().enumerate() {
            let Some(role) = role else { continue };
            let number = self.clauses[at];
            let clause = &mut clauses[number];
            let [from, to] = self.tokens.span_of(at, at);
            clause.span = if clause.span == [0, 0] { [from, to] } else { [clause.span[0], to] };
            if decided[number] {
                continue;
            }
            match role {
                // "The gizmo", but not "the gizmo lamp".
                WordRole::Unknown => {
                    let describes = roles.get(at + 1).is_some_and(|next| *next == Some(WordRole::Place));
                    (decided[number], clause.understood) = (!describes, describes);
                }
                WordRole::Place | WordRole::General | WordRole::Turn | WordRole::Climb | WordRole::Storey => {
                    decided[number] = true;
                }
                _ => {}
            }
        }
        clauses
    }
}

/// Whether a word is an adjective, or a form of one: "larger", "biggest".
fn is_descriptive(word: &str) -> bool {
    let is_listed = |word: &str| v::ADJECTIVES.contains(&word) || r::MANNER.contains(&word);
    let stem = word.strip_suffix("er").or(word.strip_suffix("est")).filter(|stem| stem.len() > 2);
    let graded = |stem: &str| {
        // "Larg" of "larger" lacks an "e". "Bigg" has a letter too many, and "tini" has an "i" for a "y".
        let single = stem.char_indices().next_back().map_or("", |(last, _)| &stem[..last]);
        is_listed(stem) || is_listed(&format!("{stem}e")) || is_listed(single) || is_listed(&format!("{single}y"))
    };
    is_listed(word) || stem.is_some_and(graded)
}

/// "Directly": how something is done. "Family" is not one.
fn is_adverb(word: &str) -> bool {
    word.len() > 4 && word.ends_with("ly") && !matches!(word, "family" | "butterfly" | "fly" | "assembly")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::read_instruction;

    /// The counted words of a text that the reader does not understand.
    fn unknown(text: &str) -> Vec<&str> {
        let words = read_instruction(text, &BTreeSet::new()).words;
        let unknown = words.iter().filter(|word| word.is_counted && !word.is_understood());
        unknown.map(|word| &text[word.span[0]..word.span[1]]).collect()
    }

    fn roles(text: &str) -> Vec<WordRole> {
        read_instruction(text, &BTreeSet::new()).words.iter().map(|word| word.role).collect()
    }

    fn understood(text: &str) -> Vec<bool> {
        let clauses = read_instruction(text, &BTreeSet::new()).clauses.into_iter();
        clauses.filter(|clause| clause.span[1] > 0).map(|clause| clause.understood).collect()
    }

    #[test]
    fn each_word_has_a_role() {
        use WordRole::{Colour, Connective, Count, Filler, Motion, Ordinal, Place, Relation, Side, Stop, Turn};
        for (text, wanted) in [
            ("Turn left and stop.", &[Motion, Turn, Connective, Stop][..]),
            ("Pass two red chairs.", &[Motion, Count, Colour, Place]),
            ("Enter the second door on the left.", &[Motion, Filler, Ordinal, Place, Filler, Filler, Side]),
            ("The lamp opposite", &[Filler, Place, Relation]),
        ] {
            assert_eq!(roles(text), wanted, "{text}");
        }
    }

    #[test]
    fn words_that_no_list_has_are_unknown() {
        for (text, wanted) in [
            ("Walk past the zorble and the quirked sofa.", &["zorble", "quirked"][..]),
            ("Grimble the lamp.", &["Grimble"]),
            ("Walk past the Mona Lisa.", &["Mona", "Lisa"]),
            ("Go left-ish to office 308.", &["ish", "308"]),
            // A verb's place is not after an article.
            ("Walk along the walk.", &["walk"]),
            ("Walk slowly past the largest wooden table and turn left.", &[]),
            ("Please wipe the lamp that is closest to the door.", &[]),
        ] {
            assert_eq!(unknown(text), wanted, "{text}");
        }
    }

    #[test]
    fn names_of_the_evidence_are_understood() {
        let known = BTreeSet::from(["zorble".to_owned()]);
        let reading = read_instruction("Walk past the zorble.", &known);
        assert!(reading.words.iter().all(ReadWord::is_understood) && reading.clauses[0].understood);
    }

    #[test]
    fn a_clause_needs_its_verb_and_its_main_noun() {
        for (text, wanted) in [
            ("Grimble to the sofa. Turn left.", &[false, true][..]),
            ("Walk to the zorble, then stop at the lamp.", &[false, true]),
            ("Walk to the sofa with the zorble.", &[true]),
            ("Walk to the zorbled sofa.", &[true]),
            ("", &[]),
            ("...", &[]),
        ] {
            assert_eq!(understood(text), wanted, "{text}");
        }
    }

    #[test]
    fn clauses_have_the_numbers_that_events_have() {
        for text in ["Turn left. Stop at the sofa, by the lamp!", ", go on and stop", "Stop"] {
            let reading = read_instruction(text, &BTreeSet::new());
            for event in &reading.events {
                let [from, to] = reading.clauses[event.clause].span;
                assert!(from <= event.span[0] && event.span[1] <= to, "{text}: {event:?}");
            }
        }
    }
}
