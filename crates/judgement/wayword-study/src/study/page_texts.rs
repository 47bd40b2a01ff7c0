//! The words that participants read on the pages, in English or as somebody translated them. `texts.toml` beside this file has the
//! English ones.

use super::StudyTask;
use crate::wording::RatingScale;
use serde::Serialize;
use std::{collections::BTreeMap, sync::LazyLock};
use toml::Value;

/// The English words, as `wayword study texts` writes them.
pub const ENGLISH_TEXTS: &str = include_str!("texts.toml");

/// Words by section and key.
type TextSections = BTreeMap<String, BTreeMap<String, String>>;

/// The words of all pages.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PageTexts {
    /// The language, as a tag like `de` or `pt-BR`.
    pub language: String,
    sections: TextSections,
}

/// Longest text, characters.
const MAX_TEXT_CHARS: usize = 2000;
/// Longest tag of a language, bytes.
const MAX_TAG_BYTES: usize = 35;
/// How many problems of a file an error lists.
const MAX_LISTED_PROBLEMS: usize = 12;
/// Languages that are written from right to left.
const RIGHT_TO_LEFT: [&str; 8] = ["ar", "dv", "fa", "he", "ps", "sd", "ur", "yi"];

static ENGLISH: LazyLock<PageTexts> = LazyLock::new(|| {
    // A test rules out that this file cannot be read.
    let (language, sections) = read_sections(ENGLISH_TEXTS).unwrap_or_default();
    PageTexts { language, sections }
});

/// The motion in a picture of a film, which its description names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmMotion {
    /// It is the first picture.
    Begins,
    /// The walk goes straight on.
    GoesOn,
    /// The walk turns to the left.
    TurnsLeft,
    /// The walk turns to the right.
    TurnsRight,
}

impl FilmMotion {
    const ALL: [Self; 4] = [Self::Begins, Self::GoesOn, Self::TurnsLeft, Self::TurnsRight];

    /// The key of its words in the section `film`.
    fn key(self) -> &'static str {
        match self {
            Self::Begins => "begins",
            Self::GoesOn => "goes_on",
            Self::TurnsLeft => "turns_left",
            Self::TurnsRight => "turns_right",
        }
    }

    /// Its words in English, as the files of a study have them.
    #[must_use]
    pub fn in_english(self) -> &'static str {
        ENGLISH.text("film", self.key())
    }
}

impl Default for PageTexts {
    /// The English words.
    fn default() -> Self {
        ENGLISH.clone()
    }
}

impl PageTexts {
    /// Reads a translated file.
    ///
    /// # Errors
    /// When it is not TOML, or a text is missing, unknown, empty or too long, or has other placeholders than the English one. The text lists
    /// the problems by section and key.
    pub fn parse(file: &str) -> Result<Self, String> {
        let (language, sections) = read_sections(file)?;
        let is_tag = language.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-');
        let mut problems = Vec::new();
        if language.is_empty() || language.len() > MAX_TAG_BYTES || !is_tag {
            problems.push("language: give a tag like de or pt-BR".to_owned());
        }
        problems.extend(unknown_texts(&sections));
        for (section, key, english) in all_texts(&ENGLISH.sections) {
            match sections.get(section).and_then(|texts| texts.get(key)) {
                None => problems.push(format!("[{section}] {key} is missing; in English it is {english:?}")),
                Some(text) => {
                    problems.extend(text_problem(text, english).map(|problem| format!("[{section}] {key}: {problem}")));
                }
            }
        }
        if problems.is_empty() { Ok(Self { language, sections }) } else { Err(list_problems(&problems)) }
    }

    /// The words as the contents of a file.
    ///
    /// # Errors
    /// When they cannot be written as TOML.
    pub(super) fn to_file(&self) -> Result<String, String> {
        let sections = toml::to_string(&self.sections).map_err(|error| error.to_string())?;
        Ok(format!("language = {}\n\n{sections}", Value::String(self.language.clone())))
    }

    /// Whether the words are the English ones of this program.
    #[must_use]
    pub fn is_english(&self) -> bool {
        *self == *ENGLISH
    }

    /// `rtl` for languages that are written from right to left, else `ltr`.
    pub(crate) fn direction(&self) -> &'static str {
        let language = self.language.split('-').next().unwrap_or_default().to_ascii_lowercase();
        if RIGHT_TO_LEFT.contains(&language.as_str()) { "rtl" } else { "ltr" }
    }

    /// All words by section and key, for the templates.
    pub(crate) fn sections(&self) -> &TextSections {
        &self.sections
    }

    /// A text; empty if there is none, which tests rule out.
    pub(crate) fn text(&self, section: &str, key: &str) -> &str {
        self.sections.get(section).and_then(|texts| texts.get(key)).map_or("", String::as_str)
    }

    /// The description of a picture of a film, which `study new` writes in English, in the language of the pages.
    pub(crate) fn film_description<'a>(&'a self, written: &'a str) -> &'a str {
        let motion = FilmMotion::ALL.into_iter().find(|motion| motion.in_english() == written);
        motion.map_or(written, |motion| self.text("film", motion.key()))
    }

    /// What the consent page says of the records that come beside the answers of a task.
    pub(crate) fn recorded_words(&self, mode: StudyTask) -> &str {
        match mode {
            StudyTask::Follow => self.text("consent", "recorded_walk"),
            StudyTask::Rate | StudyTask::Pair => self.text("consent", "recorded_film"),
        }
    }

    /// The words of a question and of its five levels. A statement has the levels of agreement.
    pub(crate) fn scale_words(&self, scale: &RatingScale) -> (String, [String; 5]) {
        let own = if self.text(scale.name, "level_1").is_empty() { "agreement" } else { scale.name };
        (self.text(scale.name, "text").to_owned(), self.levels(own))
    }

    /// The words of the five levels of agreement.
    pub(crate) fn agreement_levels(&self) -> [String; 5] {
        self.levels("agreement")
    }

    fn levels(&self, section: &str) -> [String; 5] {
        [1, 2, 3, 4, 5].map(|level| self.text(section, &format!("level_{level}")).to_owned())
    }
}

/// Fills in the placeholders of a text, as `{minutes}`.
pub(crate) fn fill_placeholders<'a>(text: &str, values: impl IntoIterator<Item = (&'a str, String)>) -> String {
    let values: BTreeMap<&str, String> = values.into_iter().collect();
    let (mut filled, mut rest) = (String::new(), text);
    // Values are never searched for placeholders, because participants and files wrote some of them.
    while let Some((before, after)) = rest.split_once('{') {
        filled.push_str(before);
        match after.split_once('}').and_then(|(name, tail)| Some((values.get(name)?, tail))) {
            Some((value, tail)) => {
                filled.push_str(value);
                rest = tail;
            }
            None => {
                filled.push('{');
                rest = after;
            }
        }
    }
    filled + rest
}

/// Reads the language and the sections of a file.
fn read_sections(file: &str) -> Result<(String, TextSections), String> {
    let table: toml::Table = toml::from_str(file).map_err(|error| error.to_string())?;
    let (mut language, mut sections) = (String::new(), TextSections::new());
    for (name, value) in table {
        match value {
            Value::String(tag) if name == "language" => language = tag,
            Value::Table(texts) => {
                let texts = texts.into_iter().map(|(key, text)| match text {
                    Value::String(text) => Ok((key, text)),
                    _ => Err(format!("[{name}] {key}: give a text in quotes")),
                });
                let texts = texts.collect::<Result<_, _>>()?;
                sections.insert(name, texts);
            }
            _ => return Err(format!("{name}: only `language` and sections like [consent] stand here")),
        }
    }
    Ok((language, sections))
}

fn all_texts(sections: &TextSections) -> impl Iterator<Item = (&str, &str, &str)> {
    let of_section = |(section, texts)| {
        let texts: &BTreeMap<String, String> = texts;
        let section: &String = section;
        texts.iter().map(move |(key, text)| (section.as_str(), key.as_str(), text.as_str()))
    };
    sections.iter().flat_map(of_section)
}

/// A problem for each text of a file that no page has.
fn unknown_texts(sections: &TextSections) -> Vec<String> {
    let mut problems = Vec::new();
    for (section, texts) in sections {
        let Some(known) = ENGLISH.sections.get(section) else {
            let nearest = nearest_name(section, ENGLISH.sections.keys());
            problems.push(format!("[{section}]: there is no such section{nearest}"));
            continue;
        };
        for key in texts.keys().filter(|key| !known.contains_key(*key)) {
            problems.push(format!("[{section}] {key}: there is no such text{}", nearest_name(key, known.keys())));
        }
    }
    problems
}

/// What is wrong with a translated text, if anything is.
fn text_problem(text: &str, english: &str) -> Option<String> {
    if text.trim().is_empty() {
        return Some("it is empty".to_owned());
    }
    if text.chars().count() > MAX_TEXT_CHARS {
        return Some(format!("it has more than {MAX_TEXT_CHARS} characters"));
    }
    if text.chars().any(|letter| letter.is_control() && letter != '\n') {
        return Some("it has a control character".to_owned());
    }
    let (found, wanted) = (placeholders(text), placeholders(english));
    if found == wanted {
        return None;
    }
    let names: Vec<String> = wanted.iter().map(|name| format!("{{{name}}}")).collect();
    Some(if names.is_empty() {
        "it has a name in braces, and the English text has none".to_owned()
    } else {
        format!("it needs {} once each, and no other name in braces", names.join(" and "))
    })
}

/// The names in braces, in order of the alphabet.
fn placeholders(text: &str) -> Vec<&str> {
    let mut names: Vec<&str> =
        text.split('{').skip(1).filter_map(|after| after.split_once('}')).map(|(name, _)| name).collect();
    names.sort_unstable();
    names
}

fn list_problems(problems: &[String]) -> String {
    let mut listed: Vec<String> = problems.iter().take(MAX_LISTED_PROBLEMS).cloned().collect();
    if problems.len() > MAX_LISTED_PROBLEMS {
        listed.push(format!("and {} more", problems.len() - MAX_LISTED_PROBLEMS));
    }
    listed.join("\n  ")
}

/// A question with the nearest known name; empty if none is near.
fn nearest_name<'a>(typed: &str, known: impl Iterator<Item = &'a String>) -> String {
    let nearest = known.map(|name| (edit_distance(typed, name), name)).min();
    match nearest {
        Some((distance, name)) if distance <= typed.len().max(name.len()) / 2 => format!("; did you mean {name:?}?"),
        _ => String::new(),
    }
}

/// How many letters have to be put in, left out or changed to make one word from the other (Levenshtein).
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (line, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = line + 1;
        for (at, other) in b.iter().enumerate() {
            let changed = diagonal + usize::from(letter != *other);
            diagonal = row[at + 1];
            row[at + 1] = changed.min(row[at] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::{FOLLOW_STATEMENTS, RATE_QUESTIONS};

    #[test]
    fn the_english_file_is_complete_and_has_the_words_of_the_results() {
        let english = PageTexts::parse(ENGLISH_TEXTS).unwrap();
        assert!(english.is_english() && english.language == "en" && english.direction() == "ltr");
        for scale in FOLLOW_STATEMENTS.iter().chain(&RATE_QUESTIONS) {
            let (text, levels) = english.scale_words(scale);
            assert_eq!((text.as_str(), levels.each_ref().map(String::as_str)), (scale.text, scale.levels));
        }
    }

    #[test]
    fn problems_are_named_by_section_and_key() {
        let without = ENGLISH_TEXTS.replace("go_on = \"Continue\"\n", "goon = \"Weiter\"\n");
        let told = PageTexts::parse(&without).unwrap_err();
        assert!(told.contains("[base] go_on is missing; in English it is \"Continue\""), "{told}");
        assert!(told.contains("[base] goon: there is no such text; did you mean \"go_on\"?"), "{told}");
        for (from, to, said) in [
            ("[consent]", "[consnt]", "did you mean \"consent\"?"),
            ("about {minutes} minutes", "about some minutes", "[consent] minutes: it needs {minutes} once"),
            ("{done} of {of} done", "{done} of {off} done", "[base] progress: it needs {done} and {of}"),
            ("\"Continue\"", "\"Go {on}\"", "the English text has none"),
            ("\"Continue\"", "\" \"", "it is empty"),
            ("\"Continue\"", "3", "give a text in quotes"),
            ("language = \"en\"", "language = \"<b>\"", "language"),
            ("language = \"en\"", "", "language"),
            ("language = \"en\"", "language = 3", "only `language`"),
            ("[base]", "[base", "line"),
        ] {
            let told = PageTexts::parse(&ENGLISH_TEXTS.replacen(from, to, 1)).unwrap_err();
            assert!(told.contains(said), "{to}: {told}");
        }
        let told = PageTexts::parse("language = \"de\"").unwrap_err();
        assert!(told.contains("more") && told.lines().count() <= MAX_LISTED_PROBLEMS + 1, "{told}");
    }

    #[test]
    fn placeholders_are_filled_and_values_are_not_searched() {
        let fill = |text: &str| fill_placeholders(text, [("a", "{b}".to_owned()), ("b", "2".to_owned())]);
        assert_eq!(fill("{b}, {a} {c} {"), "2, {b} {c} {");
        assert_eq!(fill("none"), "none");
    }

    #[test]
    fn translated_words_are_written_and_read_back() {
        let file = ENGLISH_TEXTS
            .replace("language = \"en\"", "language = \"de\"")
            .replace("Continue", "Weiter \\\"x\\\"\\n</b>");
        let german = PageTexts::parse(&file).unwrap();
        assert_eq!(PageTexts::parse(&german.to_file().unwrap()), Ok(german));
    }

    #[test]
    fn some_languages_go_from_right_to_left() {
        let arabic = PageTexts { language: "ar-EG".to_owned(), ..PageTexts::default() };
        assert_eq!(arabic.direction(), "rtl");
        assert!(!arabic.is_english());
    }
}
