//! Gives each word of a text a role, and finds the clauses that the reader understood. The share of understood words
//! shows how far a verdict on the text can be trusted.

use super::{
    Clause, Event, Role, What, Word, numbers, places, role_words as r, stems::is_form_of, tokens::Tokens,
    vocabulary as v,
};
use crate::lexicon::{is_room, is_thing, normal_word};
use std::collections::BTreeSet;

/// The words of a text with their roles, and its clauses.
pub(super) fn coverage(
    tokens: Tokens<'_>,
    clauses: &[usize],
    events: &[Event],
    known: &BTreeSet<String>,
) -> (Vec<Word>, Vec<Clause>) {
    let named = named(tokens, known);
    let told = told(tokens, events);
    let text = Text { tokens, clauses, named };
    let roles: Vec<Option<Role>> = (0..tokens.len()).map(|at| text.role(at, told[at])).collect();
    let words = roles.iter().enumerate().filter_map(|(at, role)| {
        let role = (*role)?;
        Some(Word { span: tokens.span(at, at), role, is_counted: !r::STOP_WORDS.contains(&tokens.word(at)) })
    });
    (words.collect(), text.clauses(&roles))
}

/// For each token, whether it belongs to a name of the lexicon or of the evidence.
fn named(tokens: Tokens<'_>, known: &BTreeSet<String>) -> Vec<bool> {
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
fn told(tokens: Tokens<'_>, events: &[Event]) -> Vec<Option<Role>> {
    let mut told = vec![None; tokens.len()];
    for event in events {
        let Some(role) = role_of(&event.what) else { continue };
        let within = tokens.first_from(event.span[0])..tokens.first_from(event.span[1]);
        told[within].fill(Some(role));
    }
    told
}

/// The role of the words of an event. Those of a place are named or not, word by word.
fn role_of(what: &What) -> Option<Role> {
    match what {
        What::Place(_) => None,
        What::Turn(_) => Some(Role::Turn),
        What::Climb(_) | What::Steps(_) => Some(Role::Climb),
        What::Storey(_) | What::Floor(_) => Some(Role::Storey),
        What::Onward => Some(Role::Motion),
        What::Stop => Some(Role::Stop),
        What::Face { .. } => Some(Role::Facing),
        What::Compass { .. } => Some(Role::Compass),
        What::Distance { .. } => Some(Role::Distance),
    }
}

struct Text<'a> {
    tokens: Tokens<'a>,
    clauses: &'a [usize],
    /// For each token, whether it belongs to a known name.
    named: Vec<bool>,
}

impl<'a> Text<'a> {
    fn word(&self, at: usize) -> &'a str {
        self.tokens.word(at)
    }

    fn before(&self, at: usize) -> &'a str {
        self.tokens.before(at)
    }

    /// The role of a token; `None` for a mark.
    fn role(&self, at: usize, told: Option<Role>) -> Option<Role> {
        if !self.tokens.is_word(at) {
            return None;
        }
        let found = told.or_else(|| self.named[at].then_some(Role::Place)).or_else(|| self.by_context(at));
        Some(found.or_else(|| self.by_list(self.word(at))).unwrap_or(Role::Unknown))
    }

    /// The role of a word that depends on the words around it.
    fn by_context(&self, at: usize) -> Option<Role> {
        let (word, before, next) = (self.word(at), self.before(at), self.word(at + 1));
        let is_number = !matches!(word, "bottom" | "ground") && v::floor_number(word).is_some()
            || word.starts_with(|c: char| c.is_ascii_digit());
        if matches!(word, "left" | "right") {
            return self.side(at);
        }
        if v::UNITS.contains(&word) && (numbers::is_number(before) || matches!(before, "few" | "of" | "more")) {
            return Some(Role::Distance);
        }
        if matches!(word, "leftmost" | "rightmost") {
            return Some(Role::Ordinal);
        }
        if is_number
            || numbers::is_number(word) && !matches!(word, "a" | "an" | "several" | "half")
            || matches!(word, "last" | "next" | "final")
        {
            return self.number(at);
        }
        // "The walk", "a level": a noun, whatever verb looks like it.
        let is_noun = v::DETERMINERS.contains(&before) && before != "that";
        let is_verb = !is_noun;
        let begins = at == 0 || !self.tokens.is_word(at - 1) || v::ADVERBS.contains(&before);
        let describes = !begins && (word.ends_with("ing") || word.ends_with("ed"));
        if describes && is_form_of(word, &r::RELATIONS) {
            return Some(Role::Relation);
        }
        if is_verb && matches!(word, "up" | "down") && !matches!(next, "" | "." | ",") {
            return Some(Role::Relation);
        }
        if is_verb && is_form_of(word, &r::MOTION) {
            return Some(Role::Motion);
        }
        let has_object = v::DETERMINERS.contains(&next) || next == "me";
        if (begins || is_verb && (word.ends_with("ing") || has_object)) && is_form_of(word, &r::TASKS) {
            return Some(Role::Task);
        }
        None
    }

    /// A number counts the noun behind it, or picks one of several.
    fn number(&self, at: usize) -> Option<Role> {
        let word = self.word(at);
        if numbers::ordinal(word).is_some() {
            return Some(Role::Ordinal);
        }
        if v::UNITS.contains(&self.word(at + 1)) {
            return Some(Role::Distance);
        }
        // "Office 12": a name.
        let is_name = self.named.get(at.wrapping_sub(1)) == Some(&true) || self.before(at) == "room";
        let counts = !is_name && self.tokens.is_word(at + 1) && numbers::is_number(word);
        counts.then_some(Role::Count)
    }

    /// A side that is no turn: of a place ("on your left", "the left door"), or "right" as an adverb.
    fn side(&self, at: usize) -> Option<Role> {
        let next = self.word(at + 1);
        let leads = matches!(
            self.before(at),
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
        let adverb = self.word(at) == "right" && v::AFTER_ADVERB_RIGHT.contains(&next);
        match (adverb, leads || tells) {
            (true, _) => Some(Role::Manner),
            (false, true) => Some(Role::Side),
            _ => None,
        }
    }

    fn is_noun(&self, at: usize) -> bool {
        self.named.get(at) == Some(&true) || v::HAVE_SIDES.contains(&self.word(at))
    }

    /// The role that a word has wherever it occurs.
    fn by_list(&self, word: &str) -> Option<Role> {
        let name = normal_word(word);
        let lists: [(&[&str], Role); 8] = [
            (&v::COLOURS, Role::Colour),
            (&["not", "never", "without", "neither", "nor", "avoid", "cannot", "no"], Role::Denial),
            (&["up", "down", "upstairs", "downstairs", "upwards", "downwards", "upward", "downward"], Role::Climb),
            (&r::CONNECTIVES, Role::Connective),
            (&r::RELATIONS, Role::Relation),
            (&r::GENERAL, Role::General),
            (&r::MANNER, Role::Manner),
            (&r::STOP_WORDS, Role::Filler),
        ];
        let by_list = lists.into_iter().find(|(list, _)| list.contains(&word)).map(|(_, role)| role);
        let denies = word.ends_with("n't") || word.ends_with("n’t");
        by_list
            .or_else(|| denies.then_some(Role::Denial))
            .or_else(|| r::GENERAL.contains(&name.as_str()).then_some(Role::General))
            .or_else(|| is_form_of(word, &r::RELATIONS).then_some(Role::Relation))
            .or_else(|| (is_adverb(word) || describes(word)).then_some(Role::Manner))
            .or_else(|| (is_thing(&name) || is_room(&name)).then_some(Role::Place))
    }

    /// The clauses: each is understood unless the first word with a meaning in it is unknown.
    fn clauses(&self, roles: &[Option<Role>]) -> Vec<Clause> {
        let count = self.clauses.last().map_or(0, |last| last + 1);
        let mut clauses = vec![Clause { span: [0, 0], understood: true }; count];
        let mut decided = vec![false; count];
        for (at, role) in roles.iter().enumerate() {
            let Some(role) = role else { continue };
            let number = self.clauses[at];
            let clause = &mut clauses[number];
            let [from, to] = self.tokens.span(at, at);
            clause.span = if clause.span == [0, 0] { [from, to] } else { [clause.span[0], to] };
            if decided[number] {
                continue;
            }
            match role {
                // "The gizmo", but not "the gizmo lamp".
                Role::Unknown => {
                    let describes = roles.get(at + 1).is_some_and(|next| *next == Some(Role::Place));
                    (decided[number], clause.understood) = (!describes, describes);
                }
                Role::Place | Role::General | Role::Turn | Role::Climb | Role::Storey => decided[number] = true,
                _ => {}
            }
        }
        clauses
    }
}

/// Whether a word is an adjective, or a form of one: "larger", "biggest".
fn describes(word: &str) -> bool {
    let is_one = |word: &str| v::ADJECTIVES.contains(&word) || r::MANNER.contains(&word);
    let stem = word.strip_suffix("er").or(word.strip_suffix("est")).filter(|stem| stem.len() > 2);
    let graded = |stem: &str| {
        let single = stem.char_indices().next_back().map_or("", |(last, _)| &stem[..last]);
        is_one(stem) || is_one(&format!("{stem}e")) || is_one(single) || is_one(&format!("{single}y"))
    };
    is_one(word) || stem.is_some_and(graded)
}

/// "Directly": how something is done. "Family" is not one.
fn is_adverb(word: &str) -> bool {
    word.len() > 4 && word.ends_with("ly") && !matches!(word, "family" | "butterfly" | "fly" | "assembly")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::read;

    /// The counted words of a text that the reader does not understand.
    fn unknown(text: &str) -> Vec<&str> {
        let words = read(text, &BTreeSet::new()).words;
        let unknown = words.iter().filter(|word| word.is_counted && !word.is_understood());
        unknown.map(|word| &text[word.span[0]..word.span[1]]).collect()
    }

    fn roles(text: &str) -> Vec<Role> {
        read(text, &BTreeSet::new()).words.iter().map(|word| word.role).collect()
    }

    fn understood(text: &str) -> Vec<bool> {
        let clauses = read(text, &BTreeSet::new()).clauses.into_iter();
        clauses.filter(|clause| clause.span[1] > 0).map(|clause| clause.understood).collect()
    }

    #[test]
    fn each_word_has_a_role() {
        use Role::{Colour, Connective, Count, Filler, Motion, Ordinal, Place, Relation, Side, Stop, Turn};
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
        let reading = read("Walk past the zorble.", &known);
        assert!(reading.words.iter().all(Word::is_understood) && reading.clauses[0].understood);
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
            let reading = read(text, &BTreeSet::new());
            for event in &reading.events {
                let [from, to] = reading.clauses[event.clause].span;
                assert!(from <= event.span[0] && event.span[1] <= to, "{text}: {event:?}");
            }
        }
    }
}
