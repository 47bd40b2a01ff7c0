//! Finds words that a text copied from the reference texts of its style. Otherwise a writer could score well by
//! repeating them.

use super::{CheckSubject, new_finding, pass_finding};
use std::{
    collections::{BTreeSet, HashMap, HashSet, hash_map::DefaultHasher},
    hash::{Hash, Hasher},
};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::{
    languages::ReadableText,
    lexicon::{names_agree, normalise_name, room_name, same_room},
    reading::{
        TextReading,
        vocabulary::{STOCK, TURNING, WALKING, ordinal_or_number},
    },
    text::{TextToken, split_tokens},
};

/// A run of this many words that a reference also has is a copy.
pub const LONG_RUN: usize = 10;
/// A run of this many words is a copy if it names something beside the text's own topic, and if fewer than
/// [`FORMULA_REFERENCES`] references have it.
pub const SHARED_RUN: usize = 6;
/// A shorter run than [`LONG_RUN`] that this many references share is a formula, and no copy from one of them.
pub const FORMULA_REFERENCES: u8 = 3;
/// Our own writer avoids a run of this many words that a reference has, though the run may be a formula.
const AVOIDED_RUN: usize = 8;

/// The runs of words of a style's reference texts, indexed once for all texts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ReferenceRuns {
    /// By the hash of a run of [`SHARED_RUN`] words, how many references have it, up to [`FORMULA_REFERENCES`].
    shared: HashMap<u64, u8>,
    /// Hashes of all runs of [`AVOIDED_RUN`] words.
    avoided: HashSet<u64>,
    /// Hashes of all runs of [`LONG_RUN`] words.
    long: HashSet<u64>,
}

/// The topic of a text. Words for it are no copy, even if a reference has them too.
#[derive(Debug, Clone, Copy, Default)]
pub struct TextTopic<'a> {
    /// The name of its target.
    pub target: Option<&'a str>,
    /// The rooms where it ends.
    pub rooms: &'a [String],
}

impl ReferenceRuns {
    /// Indexes reference texts.
    #[must_use]
    pub fn from_references(references: &[String]) -> Self {
        let mut copies = Self::default();
        references.iter().for_each(|reference| copies.add_reference(&split_tokens(reference)));
        copies
    }

    /// Indexes reference texts with their readings. Of a text that was read through English words, its own words are indexed, and long runs
    /// alone: it has fewer small words than English, so that a short run is a formula more often.
    #[must_use]
    pub fn from_readings<'a>(texts: impl IntoIterator<Item = (&'a ReadableText<'a>, &'a TextReading)>) -> Self {
        let mut copies = Self::default();
        for (text, reading) in texts {
            match text.own_tokens() {
                Some(tokens) => copies.add_long_runs(&word_tokens(&tokens)),
                None => copies.add_reference(reading.tokens()),
            }
        }
        copies
    }

    /// Adds the long runs of these words.
    fn add_long_runs(&mut self, words: &[&TextToken]) {
        self.avoided.extend(words.windows(AVOIDED_RUN).map(run_hash));
        self.long.extend(words.windows(LONG_RUN).map(run_hash));
    }

    /// Adds the runs of a reference text, of which these are the tokens.
    fn add_reference(&mut self, tokens: &[TextToken]) {
        let words = word_tokens(tokens);
        let runs = |length: usize| words.windows(length).map(run_hash);
        for run in runs(SHARED_RUN).collect::<BTreeSet<u64>>() {
            let count = self.shared.entry(run).or_default();
            *count = (*count + 1).min(FORMULA_REFERENCES);
        }
        self.add_long_runs(&words);
    }

    /// The byte range of the first run of a text that is copied. `tokens` are those of the text.
    #[must_use]
    pub fn find_copy(&self, tokens: &[TextToken], topic: TextTopic<'_>) -> Option<[usize; 2]> {
        let words = word_tokens(tokens);
        let has_content_word = |run: &[&TextToken]| run.iter().any(|token| !STOCK.contains(&token.word.as_str()));
        let is_long = |run: &&[&TextToken]| has_content_word(run) && self.long.contains(&run_hash(run));
        let is_shared = |run: &&[&TextToken]| {
            let count = self.shared.get(&run_hash(run)).copied().unwrap_or_default();
            (1..FORMULA_REFERENCES).contains(&count) && run.iter().any(|token| is_content(&token.word, topic))
        };
        let run = words.windows(LONG_RUN).find(is_long).or_else(|| words.windows(SHARED_RUN).find(is_shared))?;
        Some([run[0].span[0], run[run.len() - 1].span[1]])
    }

    /// The byte range of the first eight words in a row that a text shares with a reference. `tokens` are those of the
    /// text.
    #[must_use]
    pub fn find_avoidable_copy(&self, tokens: &[TextToken]) -> Option<[usize; 2]> {
        let words = word_tokens(tokens);
        let run = words.windows(AVOIDED_RUN).find(|run| self.avoided.contains(&run_hash(run)))?;
        Some([run[0].span[0], run[AVOIDED_RUN - 1].span[1]])
    }
}

fn word_tokens(tokens: &[TextToken]) -> Vec<&TextToken> {
    tokens.iter().filter(|token| token.is_word()).collect()
}

fn run_hash(run: &[&TextToken]) -> u64 {
    let mut hasher = DefaultHasher::new();
    run.iter().for_each(|token| token.word.hash(&mut hasher));
    hasher.finish()
}

/// Whether a word names something other than the way, a number, a storey or the topic of the text.
fn is_content(word: &str, topic: TextTopic<'_>) -> bool {
    let is_of_way = STOCK.contains(&word) || WALKING.contains(&word) || TURNING.contains(&word);
    let is_of_storey = matches!(word, "level" | "floor" | "storey" | "story" | "upstairs" | "downstairs");
    let is_part = |name: &str| normalise_name(name).split(' ').any(|part| part == normalise_name(word));
    let is_target = || topic.target.is_some_and(|target| is_part(target) || names_agree(target, word));
    let is_room = || {
        let is_word_of = |room: &String| is_part(room) || room_name(word).is_some() && same_room(room, word);
        word == "room" || topic.rooms.iter().any(is_word_of)
    };
    !(is_of_way || is_of_storey || ordinal_or_number(word) || is_target() || is_room())
}

/// The finding about copied words: a failure at the first copy. `tokens` are those of the text, or of the English words that are read in its
/// place.
pub(super) fn check_leak(text: &str, tokens: &[TextToken], subject: CheckSubject<'_>) -> CheckFinding {
    let rooms = subject.evidence.frames.last().map_or(&[][..], |frame| &frame.rooms);
    let topic = TextTopic { target: subject.target.map(|target| target.name.as_str()), rooms };
    let words = subject.own_tokens.unwrap_or(tokens);
    let copied = match subject.copies {
        Some(copies) => copies.find_copy(words, topic),
        None => ReferenceRuns::from_references(&subject.style.references).find_copy(words, topic),
    };
    match copied {
        None => pass_finding(CheckKind::Leak),
        // The place of a word of the text among its English words is not known here.
        Some(_) if subject.own_tokens.is_some() => {
            let reason = "a reference text has the same words for a long stretch".to_owned();
            new_finding(CheckKind::Leak, Verdict::Fail, reason, None)
        }
        Some(span) => {
            let reason = format!("{:?} is in a reference text too", &text[span[0]..span[1]]);
            new_finding(CheckKind::Leak, Verdict::Fail, reason, Some(span))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn copied<'a>(text: &'a str, references: &[&str], topic: TextTopic<'_>) -> Option<&'a str> {
        let references: Vec<String> = references.iter().map(|text| (*text).to_owned()).collect();
        let found = ReferenceRuns::from_references(&references).find_copy(&split_tokens(text), topic);
        found.map(|[from, to]| &text[from..to])
    }

    #[test]
    fn six_words_in_a_row_are_a_copy_and_five_are_not() {
        let references = ["Walk past the old oak table, then stop."];
        let none = TextTopic::default();
        assert_eq!(copied("Now walk past the old oak table", &references, none), Some("walk past the old oak table"));
        assert_eq!(copied("Walk past the old oak door", &references, none), None);
    }

    #[test]
    fn words_for_the_topic_are_no_copy() {
        let references = ["Go to the pantry on level 2 and salt the ham"];
        let rooms = ["pantry".to_owned()];
        let own = TextTopic { target: Some("ham"), rooms: &rooms };
        let text = "Go to the pantry on level 2 and eat";
        assert_eq!(copied(text, &references, own), None);
        assert_eq!(copied(text, &references, TextTopic::default()), Some("Go to the pantry on level"));
    }

    #[test]
    fn a_run_in_three_references_is_a_formula_up_to_ten_words() {
        let text = "polish the brass rail beside the oak bench near the altar";
        let one = text.to_owned();
        let others = ["polish the brass rail beside the cat", "do polish the brass rail beside the dog"];
        assert!(
            copied("polish the brass rail beside the fox", &[&one, others[0], others[1]], TextTopic::default())
                .is_none()
        );
        assert!(copied("polish the brass rail beside the fox", &[&one, others[0]], TextTopic::default()).is_some());
        assert!(copied(text, &[&one, &one, &one, &one], TextTopic::default()).is_some());
    }

    #[test]
    fn a_stock_phrase_of_function_words_is_no_copy() {
        let references = ["It is at the end of the one on the left."];
        assert_eq!(copied("It is at the end of the rug", &references, TextTopic::default()), None);
    }

    #[test]
    fn ten_words_of_the_way_are_a_copy_and_nine_are_not() {
        let reference = ["Turn left and walk on and turn right and go on then stop"];
        let none = TextTopic::default();
        // All words are of walking and turning, so only their number counts.
        let ten = "Turn left and walk on and turn right and go";
        assert_eq!(copied(&format!("{ten} back"), &reference, none), Some(ten));
        assert_eq!(copied("Turn left and walk on and turn right and back", &reference, none), None);
    }

    #[test]
    fn words_of_storeys_and_numbers_are_no_content() {
        let copied_in = |word: &str, topic: TextTopic<'_>| {
            let text = format!("and go on to the {word}");
            let reference = text.clone();
            copied(&text, &[&reference], topic).is_some()
        };
        let none = TextTopic::default();
        for word in ["level", "floor", "upstairs", "downstairs", "second", "3", "room"] {
            assert!(!copied_in(word, none), "{word}");
        }
        for word in ["altar", "kitchen", "lamp"] {
            assert!(copied_in(word, none), "{word}");
        }
        let rooms = ["living room".to_owned()];
        let topic = TextTopic { target: Some("table lamp"), rooms: &rooms };
        for word in ["lamp", "table", "lamps", "living", "lounge"] {
            assert!(!copied_in(word, topic), "{word}");
        }
        for word in ["kitchen", "altar"] {
            assert!(copied_in(word, topic), "{word}");
        }
    }

    #[test]
    fn find_avoidable_copy_finds_the_first_eight_words() {
        let references = ["Now go to the old oak table and wait there".to_owned()];
        let runs = ReferenceRuns::from_references(&references);
        let text = "Please go to the old oak table and wait there.";
        let found = runs.find_avoidable_copy(&split_tokens(text)).map(|[from, to]| &text[from..to]);
        assert_eq!(found, Some("go to the old oak table and wait"));
        assert_eq!(runs.find_avoidable_copy(&split_tokens("Please go to the old oak table and stop.")), None);
    }

    #[test]
    fn check_leak_uses_the_index_or_the_references_of_the_style() {
        let references = vec!["Walk past the old oak table, then stop.".to_owned()];
        let style = wayword_core::InstructionStyle { name: "s".into(), references, ..Default::default() };
        let evidence = crate::tests::to_the_bedroom();
        let subject = CheckSubject::closed_world(&evidence, &style, None);
        let text = "Now walk past the old oak table";
        let leak = |text: &str, subject: CheckSubject<'_>| check_leak(text, &split_tokens(text), subject);
        let found = leak(text, subject);
        assert_eq!((found.check, found.verdict, found.span), (CheckKind::Leak, Verdict::Fail, Some([4, text.len()])));
        assert_eq!(found.reason, "\"walk past the old oak table\" is in a reference text too");
        let empty = ReferenceRuns::default();
        assert_eq!(leak(text, subject.with_copies(&empty)), pass_finding(CheckKind::Leak));
        assert_eq!(leak("Walk past the bed", subject), pass_finding(CheckKind::Leak));
        // The rooms of the last frame are the text's own topic.
        let rooms = vec!["Go on and go into the bedroom.".to_owned(), "Go on and go into the hallway.".to_owned()];
        let style = wayword_core::InstructionStyle { references: rooms, ..style };
        let subject = CheckSubject::closed_world(&evidence, &style, None);
        assert_eq!(leak("Go on and go into the bedroom.", subject).verdict, Verdict::Pass);
        assert_eq!(leak("Go on and go into the hallway.", subject).verdict, Verdict::Fail);
    }
}
