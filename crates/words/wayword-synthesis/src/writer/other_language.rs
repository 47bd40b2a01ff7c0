//! Puts texts by rules into another language.
//!
//! The text is planned, written and checked in English. Its version in the other language is made from what its phrases say, not from their
//! words. So texts for a path agree in all languages in what they name, and in which order.

mod clauses;
mod place;
mod way;

use super::{
    InstructionWriter, RulesWriter, WriteError, WritingBrief,
    dice::TextDice,
    naming::{NamedThing, ThingCount},
    phrases::draw_option,
    rules::RulesDraft,
};
use crate::style::{LanguageWording, TextContent};
use std::{
    collections::BTreeMap,
    sync::{Mutex, PoisonError},
};
use wayword_checks::TextTopic;
use wayword_language::languages::{NameSense, ReadableText};

/// Most versions of a text that are made until enough are read as saying the same as the English text.
const MAX_VERSIONS: usize = 40;
/// The usual name of a thing is drawn more often than people use it, by this power of its count: rare names fit few things.
const NAME_POWER: f64 = 3.0;
/// So many versions are offered to the checks.
const ENOUGH_VERSIONS: usize = 16;

/// Writes by rules in English, and remembers what each text is in the language of its style.
pub struct RulesInLanguage<'a> {
    language: &'a LanguageWording,
    versions: Mutex<BTreeMap<String, Vec<String>>>,
}

impl<'a> RulesInLanguage<'a> {
    /// A writer for one order.
    #[must_use]
    pub fn new(language: &'a LanguageWording) -> Self {
        Self { language, versions: Mutex::default() }
    }

    /// What an English text of this writer is in the other language, the best first; none for a text that it did not write, or where no
    /// version in that language means the same.
    #[must_use]
    pub fn versions_of(&self, english: &str) -> Vec<String> {
        self.versions.lock().unwrap_or_else(PoisonError::into_inner).get(english).cloned().unwrap_or_default()
    }
}

impl InstructionWriter for RulesInLanguage<'_> {
    fn name(&self) -> &str {
        RulesWriter.name()
    }

    fn write(&self, brief: &WritingBrief<'_>) -> Result<String, WriteError> {
        let (english, draft) = RulesDraft::write(brief)?;
        let versions = faithful_versions(&english, &draft, self.language, brief);
        self.versions.lock().unwrap_or_else(PoisonError::into_inner).insert(english.clone(), versions);
        Ok(english)
    }
}

/// Versions of a text that are read as saying nothing else: first those in which everything is read again, and which share no run of words
/// with a reference.
fn faithful_versions(
    english: &str,
    draft: &RulesDraft<'_>,
    language: &LanguageWording,
    brief: &WritingBrief<'_>,
) -> Vec<String> {
    let said = TextContent::read(english);
    let dice = TextDice::for_brief(brief);
    let mut versions: Vec<(usize, String)> = Vec::new();
    for number in 0..MAX_VERSIONS {
        let mut words = LanguageWriter::new(language, dice.other_draws(number));
        let Some(text) = words.text_of(draft, brief) else { continue };
        let readable = ReadableText::new(&text, Some(language.tag()));
        let tokens = readable.own_tokens().unwrap_or_default();
        let copies = &brief.profile.copies;
        let is_copied = copies.find_copy(&tokens, TextTopic::default()).is_some();
        let is_shared = copies.find_avoidable_copy(&tokens).is_some();
        let own = TextContent::read(readable.english());
        if own.says_other_than(&said) {
            continue;
        }
        let cost = 8 * said.difference(&own) + 2 * usize::from(is_copied) + usize::from(is_shared);
        if versions.iter().all(|(_, other)| *other != text) {
            versions.push((cost, text));
        }
        if versions.iter().filter(|(cost, _)| *cost == 0).count() >= ENOUGH_VERSIONS {
            break;
        }
    }
    versions.sort_by_key(|(cost, _)| *cost);
    versions.into_iter().map(|(_, text)| text).take(ENOUGH_VERSIONS).collect()
}

/// Puts the parts of one text into words. A thing has one name in all of it.
struct LanguageWriter<'a> {
    language: &'a LanguageWording,
    dice: TextDice,
    chosen: BTreeMap<(String, bool), String>,
}

impl<'a> LanguageWriter<'a> {
    fn new(language: &'a LanguageWording, dice: TextDice) -> Self {
        Self { language, dice, chosen: BTreeMap::new() }
    }

    /// A text in the language; `None` where the language lacks words for it.
    fn text_of(&mut self, draft: &RulesDraft<'_>, brief: &WritingBrief<'_>) -> Option<String> {
        match draft {
            RulesDraft::Way(draft) => self.way_text(draft, brief),
            RulesDraft::Place(content) => self.place_text(content),
        }
    }

    /// The name of a thing or a room: one of those that texts of the style use, or the usual one.
    fn name(&mut self, english: &str, sense: NameSense) -> Option<String> {
        let key = (english.to_owned(), sense == NameSense::Room);
        if let Some(chosen) = self.chosen.get(&key) {
            return Some(chosen.clone());
        }
        let names = self.language.names(english, sense).into_iter().flatten();
        let all: Vec<(f64, &String)> = names.map(|(name, count)| (count.powf(NAME_POWER), name)).collect();
        let drawn = draw_option(&all, &mut self.dice.named_rng(&["name", english])).cloned();
        let name = drawn.or_else(|| self.language.usual_name(english, sense).map(str::to_owned))?;
        self.chosen.insert(key, name.clone());
        Some(name)
    }

    fn room_name(&mut self, english: &str) -> Option<String> {
        self.name(english, NameSense::Room)
    }

    fn thing_name(&mut self, english: &str) -> Option<String> {
        self.name(english, NameSense::Thing)
    }

    /// A thing with its colour, its number, and what is named with it.
    fn thing(&mut self, thing: &NamedThing) -> Option<String> {
        let name = self.thing_name(&thing.name)?;
        let name = match &thing.colour {
            Some(look) => self.language.with_look(look, &name)?,
            None => name,
        };
        let name = if thing.count == ThingCount::Two { self.language.two_of(&thing.name, &name) } else { name };
        match &thing.with {
            Some(with) => Some(self.language.both(&name, &self.thing_name(with)?)),
            None => Some(name),
        }
    }

    /// One of the phrases that say something.
    fn phrase(&self, name: &str) -> Option<&'a str> {
        let all: Vec<(f64, &'a str)> =
            self.language.phrases(name).iter().map(|phrase| (1.0, phrase.as_str())).collect();
        draw_option(&all, &mut self.dice.named_rng(&["phrase", name]))
    }
}
