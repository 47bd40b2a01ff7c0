//! Recognises the language of a text.
//!
//! The reader knows English only, and other languages only through their packs (`languages/`). A foreign script decides by itself.
//! In Latin letters, a sentence is foreign if the reader knows few of its words. The small words of a language ("der",
//! "est") show which language it is.

use crate::{data, reading::ReadWord, text::TextToken};
use std::{collections::BTreeMap, fmt, sync::LazyLock};

const LANGUAGE_LISTS: &str = include_str!("languages/en/languages.txt");

/// The language of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// English, or too short to decide.
    English,
    /// Some sentences or words are in another language, of this name.
    Partly(&'static str),
    /// Another language, of this name: "Hindi", or "another language" where the program does not know which.
    Other(&'static str),
}

/// The name of a language that the program does not know.
const UNNAMED_LANGUAGE: &str = "another language";

/// For each small word, the languages that have it.
static SMALL_WORDS: LazyLock<BTreeMap<&'static str, Vec<&'static str>>> = LazyLock::new(|| {
    let mut languages: BTreeMap<&'static str, Vec<&'static str>> = BTreeMap::new();
    for language in data::content_lines(LANGUAGE_LISTS).filter_map(data::list_name) {
        for word in data::list_words(LANGUAGE_LISTS, language) {
            let known = languages.entry(word).or_default();
            if !known.contains(&language) {
                known.push(language);
            }
        }
    }
    languages
});

/// For each language the code that tags begin with, its list in `languages/en/languages.txt` (empty where its script is enough),
/// and its name.
const LANGUAGE_NAMES: [(&str, &str, &str); 20] = [
    ("hi", "hindi", "Hindi"),
    ("te", "telugu", "Telugu"),
    ("de", "german", "German"),
    ("fr", "french", "French"),
    ("es", "spanish", "Spanish"),
    ("it", "italian", "Italian"),
    ("pt", "portuguese", "Portuguese"),
    ("nl", "dutch", "Dutch"),
    ("sv", "swedish", "Swedish"),
    ("da", "danish", "Danish"),
    ("pl", "polish", "Polish"),
    ("tr", "turkish", "Turkish"),
    ("id", "indonesian", "Indonesian"),
    ("zh", "", "Chinese"),
    ("ja", "", "Japanese"),
    ("ko", "", "Korean"),
    ("ru", "", "Russian"),
    ("ar", "", "Arabic"),
    ("el", "", "Greek"),
    ("he", "", "Hebrew"),
];

/// Scripts outside Latin: first and last letter, and the language that our datasets write in it.
const SCRIPT_RANGES: [(char, char, &str); 19] = [
    ('\u{900}', '\u{97F}', "Hindi"),
    ('\u{C00}', '\u{C7F}', "Telugu"),
    ('\u{980}', '\u{9FF}', "Bengali"),
    ('\u{A00}', '\u{A7F}', "Punjabi"),
    ('\u{A80}', '\u{AFF}', "Gujarati"),
    ('\u{B80}', '\u{BFF}', "Tamil"),
    ('\u{C80}', '\u{CFF}', "Kannada"),
    ('\u{D00}', '\u{D7F}', "Malayalam"),
    ('\u{370}', '\u{3FF}', "Greek"),
    ('\u{400}', '\u{52F}', "Russian"),
    ('\u{590}', '\u{5FF}', "Hebrew"),
    ('\u{600}', '\u{77F}', "Arabic"),
    ('\u{E00}', '\u{E7F}', "Thai"),
    ('\u{1100}', '\u{11FF}', "Korean"),
    ('\u{AC00}', '\u{D7AF}', "Korean"),
    ('\u{3040}', '\u{30FF}', "Japanese"),
    ('\u{3400}', '\u{4DBF}', "Chinese"),
    ('\u{4E00}', '\u{9FFF}', "Chinese"),
    ('\u{530}', '\u{58F}', "Armenian"),
];

impl Language {
    /// The language that a dataset's tag names: "en-IN" is English, "hi-IN" is Hindi.
    #[must_use]
    pub fn from_tag(tag: &str) -> Self {
        let code = tag.split(['-', '_']).next().unwrap_or_default().trim().to_lowercase();
        match code.as_str() {
            "en" => Self::English,
            code => Self::Other(
                LANGUAGE_NAMES.iter().find(|(known, ..)| *known == code).map_or(UNNAMED_LANGUAGE, |(.., name)| name),
            ),
        }
    }

    /// The tag of the language of a text by its script, such as "zh"; `None` for Latin letters, and for a script that the program does not
    /// know.
    #[must_use]
    pub fn tag_of_script(text: &str) -> Option<&'static str> {
        let Self::Other(language) = script_language(text) else { return None };
        LANGUAGE_NAMES.iter().find(|(.., name)| *name == language).map(|(tag, ..)| *tag)
    }

    /// The tag of the language of a text by its script; "en" where that tells none.
    #[must_use]
    pub fn tag_of_text(text: &str) -> &'static str {
        Self::tag_of_script(text).unwrap_or("en")
    }

    /// The language of a text that its dataset gives a tag. A tag of another language is believed. A tag "en" is not
    /// believed against the text itself, because people mix languages.
    #[must_use]
    pub fn or_tagged(self, tag: Option<&str>) -> Self {
        match tag.map(Self::from_tag) {
            Some(tagged @ Self::Other(_)) => tagged,
            _ => self,
        }
    }

    /// Whether all of the text is English.
    #[must_use]
    pub fn is_english(self) -> bool {
        self == Self::English
    }

    /// The name of the language that is not English, where there is one.
    #[must_use]
    pub fn foreign_name(self) -> Option<&'static str> {
        match self {
            Self::English => None,
            Self::Partly(name) | Self::Other(name) => Some(name),
        }
    }
}

impl fmt::Display for Language {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::English => f.write_str("English"),
            Self::Partly(name) => write!(f, "English and {name}"),
            Self::Other(name) => f.write_str(name),
        }
    }
}

/// Decides the language of a text from its letters, and then from its words as the reader took them. `tokens` are those
/// of the text.
#[must_use]
pub(crate) fn language_of(text: &str, tokens: &[TextToken], words: &[ReadWord]) -> Language {
    let script_language = script_language(text);
    if script_language != Language::English {
        return script_language;
    }
    let mut whole = LanguageVotes::default();
    // The language of the first foreign sentence, and whether a sentence is English.
    let (mut foreign, mut english) = (None, false);
    for sentence in tokens.split(TextToken::ends_sentence) {
        let votes = LanguageVotes::from_sentence(sentence, words);
        match votes.foreign_language() {
            Some(name) => foreign = foreign.or(Some(name)),
            None => english |= votes.known > votes.words / 2 && votes.known > 1,
        }
        whole.add_votes(votes);
    }
    match (whole.foreign_language(), foreign) {
        (Some(name), _) if !english => Language::Other(name),
        (Some(name), _) | (None, Some(name)) => Language::Partly(name),
        (None, None) => Language::English,
    }
}

/// The language by the scripts of the letters.
pub(crate) fn script_language(text: &str) -> Language {
    let mut latin = 0;
    let mut others: BTreeMap<&'static str, usize> = BTreeMap::new();
    for letter in text.chars().filter(|letter| letter.is_alphabetic()) {
        match SCRIPT_RANGES.iter().find(|(first, last, _)| (*first..=*last).contains(&letter)) {
            Some((.., name)) => *others.entry(name).or_default() += 1,
            None => latin += 1,
        }
    }
    // Kana occur in Japanese texts only.
    let japanese = others.contains_key("Japanese");
    let other: usize = others.values().sum();
    let most = others.into_iter().max_by_key(|(_, count)| *count).map(|(name, _)| name);
    let most = if japanese { Some("Japanese") } else { most };
    match most {
        // A letter or two may be a name or a slip.
        Some(name) if (other > 2 && other >= latin) || latin == 0 => Language::Other(name),
        Some(name) if other > 2 => Language::Partly(name),
        _ => Language::English,
    }
}

/// Counts over a sentence or a text in Latin letters, which decide its language.
#[derive(Debug, Default)]
struct LanguageVotes {
    /// All words.
    words: usize,
    /// Words that the reader of English knows.
    known: usize,
    /// Small words of each language that are no English words.
    small: BTreeMap<&'static str, usize>,
}

impl LanguageVotes {
    fn from_sentence(sentence: &[TextToken], words: &[ReadWord]) -> Self {
        let mut votes = Self::default();
        for token in sentence.iter().filter(|token| token.word.starts_with(char::is_alphabetic)) {
            let at = words.partition_point(|word| word.span[0] < token.span[0]);
            votes.words += 1;
            if words.get(at).is_some_and(ReadWord::is_understood) {
                votes.known += 1;
                continue;
            }
            for language in small_words(&token.word) {
                *votes.small.entry(language).or_default() += 1;
            }
        }
        votes
    }

    fn add_votes(&mut self, other: Self) {
        self.words += other.words;
        self.known += other.known;
        for (language, count) in other.small {
            *self.small.entry(language).or_default() += count;
        }
    }

    /// The name of the language, where it is not English.
    fn foreign_language(&self) -> Option<&'static str> {
        let best = self.small.iter().max_by_key(|(_, count)| **count);
        let votes = best.map_or(0, |(_, count)| *count);
        // Whether the reader knows at most one word in `parts`. The fewer it knows, the fewer small words are needed.
        let knows_one_in = |parts: usize| self.words >= 3 && self.known * parts <= self.words;
        let is_foreign = (votes >= 2 && votes >= self.known && knows_one_in(2))
            || (votes >= 1 && knows_one_in(3))
            || (self.words >= 4 && knows_one_in(5));
        let name = |list: &str| {
            LANGUAGE_NAMES.iter().find(|(_, known, _)| *known == list).map_or(UNNAMED_LANGUAGE, |(.., name)| name)
        };
        is_foreign.then(|| best.map_or(UNNAMED_LANGUAGE, |(list, _)| name(list)))
    }
}

/// The languages that have a word among their small words. Of "l'escalier" the small word is "l'".
fn small_words(word: &str) -> impl Iterator<Item = &'static str> {
    let elided = word.find(['\'', '’']).map(|end| format!("{}'", &word[..end]));
    let languages = SMALL_WORDS.get(word).or_else(|| SMALL_WORDS.get(elided?.as_str()));
    languages.into_iter().flatten().copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::read_instruction;
    use std::collections::BTreeSet;

    fn language(text: &str) -> Language {
        read_instruction(text, &BTreeSet::new()).language
    }

    #[test]
    fn other_languages_are_named() {
        for (name, text) in [
            ("Hindi", "दरवाज़े से बाहर निकलें और बाएँ मुड़ें।"),
            ("Hindi", "Seedha jaiye aur darwaze ke baad baaye mudiye."),
            ("Telugu", "తలుపు గుండా వెళ్ళి ఎడమ వైపు తిరగండి."),
            ("Telugu", "Mee edama vaipu tiragandi, talupu daggara aagandi."),
            ("German", "Gehen Sie durch die Tür und biegen Sie links ab. Warten Sie neben dem Sofa."),
            ("German", "Links abbiegen und bis zum Ende gehen."),
            ("French", "Tournez à gauche et montez l'escalier. Arrêtez-vous devant la porte."),
            ("Spanish", "Gire a la izquierda y suba las escaleras hasta la puerta."),
            ("Italian", "Gira a sinistra e sali le scale fino alla porta."),
            ("Portuguese", "Vire à esquerda e suba as escadas até a porta do quarto."),
            ("Dutch", "Ga naar de keuken en draai linksaf bij het raam."),
            ("Swedish", "Gå genom dörren och sväng till vänster vid soffan."),
            ("Polish", "Idź przez drzwi i skręć w lewo obok kanapy."),
            ("Turkish", "Kapıdan geçin ve sola dönün, sonra merdivenleri çıkın."),
            ("Indonesian", "Belok kiri dan berjalan lurus sampai pintu dapur."),
            ("Chinese", "向左转，走到沙发旁边停下。"),
            ("Japanese", "左に曲がってソファの横で止まってください。"),
            ("Russian", "Поверните налево и остановитесь у дивана."),
            ("another language", "Menjen balra, majd forduljon jobbra, álljon meg."),
        ] {
            assert_eq!(language(text), Language::Other(name), "{text}");
        }
    }

    #[test]
    fn short_and_odd_english_is_english() {
        for text in [
            "Stop at the sink",
            "Stop",
            "Kitchen",
            "",
            "123",
            "Zorble.",
            "Turn left en route to the den.",
            "Go to the en suite.",
            "Walk past the chaise longue, the credenza and the armoire.",
            "Stop at the El Greco painting.",
            "Go to the piano, grand piano.",
            "Wlak thru teh dor adn trun lfet at the sofa.",
            "Enter the café.",
            "Pass the π poster.",
        ] {
            assert_eq!(language(text), Language::English, "{text}");
        }
    }

    #[test]
    fn mixed_texts_are_partly_english() {
        for (name, text) in [
            ("German", "Walk past the sofa and turn left. Dann gehen Sie durch die Tür und warten."),
            ("Hindi", "Walk past the sofa and turn left. फिर रुकें।"),
            ("Spanish", "Suba las escaleras hasta la puerta. Stop next to the old sofa."),
        ] {
            assert_eq!(language(text), Language::Partly(name), "{text}");
        }
    }

    #[test]
    fn the_texts_of_the_fixture_are_in_the_languages_of_their_tags() {
        let fixture = include_str!("../../wayword-formats/tests/data/rxr_languages.jsonl");
        let value = |line: &'static str, field: &str| -> &'static str {
            let behind = line.split_once(&format!("\"{field}\": \"")).unwrap().1;
            behind.split_once('"').unwrap().0
        };
        for line in fixture.lines() {
            let (tag, text) = (value(line, "language"), value(line, "instruction"));
            let reading = read_instruction(text, &BTreeSet::new());
            assert_eq!(reading.language, Language::from_tag(tag), "{text}");
            let understood = reading.clauses.iter().filter(|clause| clause.span[1] > 0).all(|clause| clause.understood);
            assert_eq!(understood, reading.language.is_english(), "{text}");
        }
    }

    #[test]
    fn or_tagged_believes_tags_of_other_languages() {
        assert_eq!(Language::from_tag("en-IN"), Language::English);
        assert_eq!(Language::from_tag("te-IN"), Language::Other("Telugu"));
        assert_eq!(Language::from_tag("hi_IN"), Language::Other("Hindi"));
        assert_eq!(Language::from_tag("xx"), Language::Other("another language"));
        let text = language("Stop at the sofa.");
        assert_eq!(text.or_tagged(Some("hi-IN")), Language::Other("Hindi"));
        assert_eq!(text.or_tagged(Some("en-US")), Language::English);
        assert_eq!(text.or_tagged(None), Language::English);
        assert_eq!(Language::Other("German").or_tagged(Some("en-US")), Language::Other("German"));
    }

    #[test]
    fn every_list_has_a_name() {
        for list in data::content_lines(LANGUAGE_LISTS).filter_map(data::list_name) {
            assert!(LANGUAGE_NAMES.iter().any(|(_, known, _)| *known == list), "{list}");
        }
    }
}
