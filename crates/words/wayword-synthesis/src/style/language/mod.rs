//! The words of a language beside English for what a text tells.
//!
//! The writer by rules plans a text, and decides in English what each clause names. The wording of another language has shapes for the same
//! kinds of clauses, joints, and names. So the texts for a path say the same in every language. The file `builtin/zh.toml` is Chinese.

mod content;
mod learn;
#[cfg(test)]
mod tests;

use super::way::{ClauseJoint, ClauseKind, ShapeTraits, WayWording};
use super::wording::WordingShares;
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    sync::{Arc, LazyLock},
};
use wayword_core::Side;
use wayword_language::{
    Language,
    languages::{NameSense, word_for_look, word_for_name},
    lexicon::{ThingClass, find_thing, room_name},
};

pub(crate) use content::TextContent;
pub use learn::count_shapes;
pub(super) use learn::learn_wording;

/// The languages that the program writes beside English: tag, and text of the TOML file.
const WRITTEN: [(&str, &str); 1] = [("zh", include_str!("../builtin/zh.toml"))];

static READ: LazyLock<Vec<LanguageWording>> = LazyLock::new(|| {
    let parse = |(tag, text): &(&'static str, &str)| LanguageWording {
        tag,
        words: Arc::new(toml::from_str(text).unwrap_or_default()),
        way: Arc::new(toml::from_str(text).unwrap_or_default()),
    };
    WRITTEN.iter().map(parse).collect()
});

/// How texts in a language say what a text tells.
#[derive(Debug, Clone, PartialEq)]
pub struct LanguageWording {
    tag: &'static str,
    words: Arc<LanguageWords>,
    /// Shapes of clauses, joints and names, with their counts.
    way: Arc<WayWording>,
}

/// The words of a language that no style changes.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct LanguageWords {
    /// The words for left and right.
    sides: [String; 2],
    /// The numbers from one on.
    numbers: Vec<String>,
    /// What ends a sentence.
    full_stop: String,
    /// The word between two things.
    and: String,
    /// By the name of a trait of shapes, the words that have it.
    traits: BTreeMap<String, Vec<String>>,
    /// The words for doors, with their English words.
    doors: BTreeMap<String, String>,
    /// The words before a doorway that gets a room, and the same with the room `{r}`.
    doors_of_rooms: BTreeMap<String, String>,
    /// What stands before a door that gets a number, and the door with the number `{n}`, by the words for doors.
    numbered_doors: BTreeMap<String, String>,
    /// The words that count things, by usual English name or by class.
    counters: BTreeMap<String, String>,
    /// What may stand behind a clause with the trait `takes_after`, with the share of each of several words.
    after: WordingShares,
    /// What joins clauses, with the share of each of several words.
    joining: BTreeMap<ClauseJoint, WordingShares>,
    /// The same before the last clause, where that differs.
    joining_last: BTreeMap<ClauseJoint, WordingShares>,
    /// Phrases for places and tasks, by what they say.
    phrases: BTreeMap<String, Vec<String>>,
    /// Tasks with `{o}` for the object, by their English words.
    tasks: BTreeMap<String, String>,
    /// Factors on how often a plan draws a kind of clause: its own weights were set by English texts.
    plan_factors: BTreeMap<ClauseKind, f64>,
    /// Shapes that are read as several clauses, with their share of the clauses of the kind.
    joined_shapes: BTreeMap<ClauseKind, WordingShares>,
}

impl LanguageWording {
    /// The built-in wording of a language, by its tag; `None` for English, and for a language that the program does not write.
    #[must_use]
    pub fn built_in(tag: &str) -> Option<&'static Self> {
        let language = Language::from_tag(tag);
        READ.iter().find(|wording| Language::from_tag(wording.tag) == language)
    }

    /// The built-in wording of a language, by its name.
    #[must_use]
    pub fn of_language(name: &str) -> Option<&'static Self> {
        let is_it = |wording: &&Self| matches!(Language::from_tag(wording.tag), Language::Other(own) if own == name);
        READ.iter().find(is_it)
    }

    /// The tags of all languages beside English that the program writes.
    #[must_use]
    pub fn written_tags() -> Vec<&'static str> {
        WRITTEN.iter().map(|(tag, _)| *tag).collect()
    }

    /// The tag of the language.
    #[must_use]
    pub fn tag(&self) -> &'static str {
        self.tag
    }

    /// Shapes of clauses, joints and names.
    #[must_use]
    pub fn way(&self) -> &WayWording {
        &self.way
    }

    /// Lets the plan of a text leave out what texts of the language leave out; `way` was measured on such texts.
    pub(super) fn adapt_plan(&self, way: &mut WayWording) {
        for (kind, count) in &mut way.kinds {
            *count *= self.words.plan_factors.get(kind).unwrap_or(&1.0);
        }
        way.untold_first_turns = self.way.untold_first_turns;
        way.named_doorways = self.way.named_doorways;
    }

    /// Whether words have one of the marks of a trait.
    fn has_trait(&self, words: &str, name: &str) -> bool {
        let marks = self.words.traits.get(name);
        marks.into_iter().flatten().any(|mark| match mark.strip_prefix('^') {
            Some(start) => words.starts_with(start),
            None => mark.strip_suffix('$').map_or_else(|| words.contains(mark.as_str()), |end| words.ends_with(end)),
        })
    }

    /// The traits of a shape.
    #[must_use]
    pub fn traits_of(&self, shape: &str) -> ShapeTraits {
        let has = |name: &str| self.has_trait(shape, name);
        // The longest word for a door counts: a doorway is no door.
        let mut rest = shape.to_owned();
        let mut words: Vec<&String> = self.words.doors.keys().collect();
        words.sort_by_key(|word| std::cmp::Reverse(word.len()));
        let mut doors = Vec::new();
        for word in words.into_iter().filter(|word| !word.is_empty()) {
            if rest.contains(word.as_str()) {
                doors.push(self.words.doors[word].clone());
                rest = rest.replace(word.as_str(), " ");
            }
        }
        ShapeTraits {
            goes_straight: has("goes_straight"),
            says_front: has("says_front"),
            names_room: shape.contains("{r}"),
            says_room: has("says_room"),
            goes_outside: has("goes_outside"),
            is_at_door: has("is_at_door"),
            is_at_room: has("is_at_room"),
            leaves: has("leaves"),
            is_until: has("is_until"),
            says_past: has("says_past"),
            goes_all_the_way: has("goes_all_the_way"),
            doors,
        }
    }

    /// The word for a side.
    #[must_use]
    pub fn side(&self, side: Side) -> &str {
        &self.words.sides[usize::from(side != Side::Left)]
    }

    /// A shape whose door gets a number; `None` where it has no place for it.
    #[must_use]
    pub fn number_door(&self, shape: &str, number: usize) -> Option<String> {
        let number = self.number(number)?;
        let (plain, numbered) = self.words.numbered_doors.iter().rfind(|(plain, _)| shape.contains(plain.as_str()))?;
        Some(shape.replacen(plain, &numbered.replace("{n}", number), 1))
    }

    /// A clause with the name of its room before the doorway; `None` where it has no place for that.
    #[must_use]
    pub fn name_doorway(&self, clause: &str, room: &str) -> Option<String> {
        let (plain, named) = self.words.doors_of_rooms.iter().find(|(plain, _)| clause.contains(plain.as_str()))?;
        Some(clause.replacen(plain, &named.replace("{r}", room), 1))
    }

    /// What may stand behind a clause before the next one, with the share of each of several words.
    #[must_use]
    pub fn words_after(&self, clause: &str) -> Option<&WordingShares> {
        self.has_trait(clause, "takes_after").then_some(&self.words.after)
    }

    /// The word for a number from one on.
    #[must_use]
    pub fn number(&self, number: usize) -> Option<&str> {
        self.words.numbers.get(number.checked_sub(1)?).map(String::as_str)
    }

    /// The names of a thing or a room in the style's texts with their counts, by its English name.
    #[must_use]
    pub fn names(&self, english: &str, sense: NameSense) -> Option<&BTreeMap<String, f64>> {
        match sense {
            NameSense::Thing => self.way.things.get(find_thing(english)?.name),
            NameSense::Room => {
                let usual = room_name(english)?;
                self.way.rooms_by_label.get(usual).or_else(|| self.way.rooms.get(usual))
            }
        }
    }

    /// The usual name of a thing or a room, by its English name.
    #[must_use]
    pub fn usual_name(&self, english: &str, sense: NameSense) -> Option<&'static str> {
        word_for_name(self.tag, english, sense)
    }

    /// A thing with its colour or its material; `None` if the language has no word for that.
    #[must_use]
    pub fn with_look(&self, look: &str, thing: &str) -> Option<String> {
        Some(format!("{}{thing}", word_for_look(self.tag, look)?))
    }

    /// Two things of a kind; `english` is their English name.
    #[must_use]
    pub fn two_of(&self, english: &str, name: &str) -> String {
        let counted = find_thing(english).map(|thing| (thing.name, thing.class));
        let (thing, class) = counted.unwrap_or((english, ThingClass::Unknown));
        let class = format!("{class:?}").to_lowercase();
        let counter = self.words.counters.get(thing).or_else(|| self.words.counters.get(&class));
        let counter = counter.or_else(|| self.words.counters.get("any")).map_or("", String::as_str);
        // A counting language counts two of a thing with another word than the number.
        format!("{}{counter}{name}", self.phrase("two").unwrap_or_default())
    }

    /// Two things that are named together.
    #[must_use]
    pub fn both(&self, one: &str, other: &str) -> String {
        format!("{one}{}{other}", self.words.and)
    }

    /// What may join two clauses, with the share of each; the second may be the last one of its text.
    #[must_use]
    pub fn joining_words(&self, joint: ClauseJoint, is_last: bool) -> &WordingShares {
        static NONE: WordingShares = WordingShares::new();
        let last = self.words.joining_last.get(&joint).filter(|_| is_last);
        last.or_else(|| self.words.joining.get(&joint)).unwrap_or(&NONE)
    }

    /// Whether a text does not begin with a clause.
    #[must_use]
    pub fn begins_no_text(&self, clause: &str) -> bool {
        self.has_trait(clause, "not_first")
    }

    /// Whether a shape goes along its thing, which has to be long.
    #[must_use]
    pub fn goes_along_thing(&self, shape: &str) -> bool {
        self.has_trait(shape, "along_thing")
    }

    /// Whether a clause always has a mark before it.
    #[must_use]
    pub fn is_parted(&self, clause: &str) -> bool {
        self.has_trait(clause, "parted")
    }

    /// What ends a sentence.
    #[must_use]
    pub fn full_stop(&self) -> &str {
        &self.words.full_stop
    }

    /// The phrases that say something of a place, a thing or a task.
    #[must_use]
    pub fn phrases(&self, name: &str) -> &[String] {
        self.words.phrases.get(name).map_or(&[], Vec::as_slice)
    }

    /// The first of the phrases that say something.
    #[must_use]
    pub fn phrase(&self, name: &str) -> Option<&str> {
        self.phrases(name).first().map(String::as_str)
    }

    /// A task by its English words, both with `{o}` for the object.
    #[must_use]
    pub fn task(&self, english: &str) -> Option<&str> {
        self.words.tasks.get(english).map(String::as_str)
    }

    /// How many English words say about the same as a text, by the clauses of a style: `plan` has their kinds and English shapes.
    #[must_use]
    pub fn words_for(&self, text: &str, plan: &WayWording) -> usize {
        let characters = text.chars().filter(|c| c.is_alphanumeric()).count();
        (characters as f64 / self.characters_per_word(plan) / PLANNED_SHARE).round() as usize
    }

    /// How many characters a clause has for each word of the English one.
    fn characters_per_word(&self, plan: &WayWording) -> f64 {
        let mean = |shapes: Option<&BTreeMap<String, f64>>, length: &dyn Fn(&str) -> f64| {
            let (sum, count) = shapes
                .into_iter()
                .flatten()
                .fold((0.0, 0.0), |(sum, count), (shape, texts)| (sum + texts * length(shape), count + texts));
            (count > 0.0).then_some(sum / count)
        };
        let (mut own, mut english) = (0.0, 0.0);
        for (kind, texts) in &plan.kinds {
            let characters = mean(self.way.shapes.get(kind), &|shape| shape_characters(shape));
            let words = mean(plan.shapes.get(kind), &|shape| shape.split(' ').count() as f64);
            if let (Some(characters), Some(words)) = (characters, words) {
                own += texts * characters;
                english += texts * words;
            }
        }
        if english > 0.0 { own / english } else { 1.0 }
    }

    /// The shapes of a kind, at the beginning of a text or behind other clauses.
    #[must_use]
    pub fn shapes(&self, kind: ClauseKind, is_first: bool) -> Option<&BTreeMap<String, f64>> {
        let first = self.way.first_shapes.get(&kind).filter(|_| is_first);
        first.or_else(|| self.way.shapes.get(&kind))
    }
}

/// Share of the words that a text is planned for which it gets, as few walks have things for all.
const PLANNED_SHARE: f64 = 0.9;
/// Characters of a name in a text of a language without blanks, for the slots of shapes.
const NAME_CHARACTERS: f64 = 2.2;

/// About how many characters a shape has when it is filled.
fn shape_characters(shape: &str) -> f64 {
    let names = ["{l}", "{r}", "{a}"].iter().map(|slot| shape.matches(slot).count()).sum::<usize>();
    let sides = ["{s}", "{p}"].iter().map(|slot| shape.matches(slot).count()).sum::<usize>();
    let other = shape.chars().count() - 3 * (names + sides);
    other as f64 + sides as f64 + NAME_CHARACTERS * names as f64
}
