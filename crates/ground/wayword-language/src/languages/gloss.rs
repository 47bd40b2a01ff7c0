//! A text of another language in English words, each with its place in the text.

use super::{
    PackFiles,
    chunks::Chunk,
    pack_words::{PackToken, PackWords},
    rules::{RuleStage, parse_stages},
};
use crate::Language;
use crate::reading::{ReadWord, WordRole, role_words::STOP_WORDS};
use crate::text::TextToken;
use std::collections::BTreeMap;

/// A language that is read through English words.
#[derive(Debug)]
pub(super) struct LanguagePack {
    /// The name of the language, as [`Language`] has it.
    pub(super) language: &'static str,
    words: PackWords,
    stages: Vec<RuleStage>,
}

/// A text in English words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct GlossedText {
    /// The language of the text.
    language: &'static str,
    /// The English words.
    text: String,
    /// The words of the gloss, in its order.
    places: Vec<GlossPlace>,
    /// The words of the text.
    tokens: Vec<PackToken>,
}

/// A word of a gloss.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct GlossPlace {
    /// Byte range in the gloss.
    span: [usize; 2],
    /// Byte range in the text; `None` for a word that English alone needs.
    source: Option<[usize; 2]>,
}

/// Classes of chunks that join what is before them with what follows.
const JOINING: [&str; 4] = ["mark", "then", "and", "joint"];
/// The class of chunks that begin a clause.
const CLAUSE: &str = "clause";

/// A text as the reader of English gets it: an English text itself, or the gloss of another one.
#[derive(Debug, Clone)]
pub struct ReadableText<'a> {
    text: &'a str,
    gloss: Option<GlossedText>,
}

impl<'a> ReadableText<'a> {
    /// Puts a text of another language into English words, where the program reads the language. A `tag` that names another one is believed.
    #[must_use]
    pub fn new(text: &'a str, tag: Option<&str>) -> Self {
        let fits = |gloss: &GlossedText| match tag.map(Language::from_tag) {
            Some(Language::Other(tagged)) => tagged == gloss.language,
            _ => true,
        };
        Self { text, gloss: super::gloss_text(text).filter(fits) }
    }

    /// The English words.
    #[must_use]
    pub fn english(&self) -> &str {
        self.gloss.as_ref().map_or(self.text, GlossedText::text)
    }

    /// Whether the English words are not the text itself.
    #[must_use]
    pub fn is_glossed(&self) -> bool {
        self.gloss.is_some()
    }

    /// The name of its language, where it was put into English words.
    #[must_use]
    pub fn glossed_language(&self) -> Option<&'static str> {
        self.gloss.as_ref().map(|gloss| gloss.language)
    }

    /// The text itself.
    #[must_use]
    pub fn text(&self) -> &'a str {
        self.text
    }

    /// The name of its language, where that is read only in part, as an experiment.
    #[must_use]
    pub fn experimental_language(&self) -> Option<&'static str> {
        self.glossed_language().filter(|language| super::reads_in_part(language) == Some(true))
    }

    /// The tag of the language of the English words, where `tag` is that of the text.
    #[must_use]
    pub fn english_tag<'t>(&self, tag: Option<&'t str>) -> Option<&'t str> {
        tag.filter(|_| !self.is_glossed())
    }

    /// The words of the text itself, where English words are read in its place.
    #[must_use]
    pub fn own_tokens(&self) -> Option<Vec<TextToken>> {
        let token = |token: &PackToken| {
            let [from, to] = token.span;
            TextToken { word: self.text[from..to].to_lowercase(), span: token.span }
        };
        self.gloss.as_ref().map(|gloss| gloss.tokens.iter().map(token).collect())
    }

    /// The words of the text, where `words` are those of its English words. A word is understood if the pack knows it, and the reader the
    /// English word for it.
    #[must_use]
    pub fn source_words(&self, words: &[ReadWord]) -> Vec<ReadWord> {
        let Some(gloss) = &self.gloss else { return words.to_vec() };
        let mut roles: BTreeMap<[usize; 2], WordRole> = BTreeMap::new();
        for word in words {
            let Some(source) = gloss.source_of_word(word.span) else { continue };
            let role = roles.entry(source).or_insert(word.role);
            *role = if word.is_understood() { *role } else { WordRole::Unknown };
        }
        let read = |token: &PackToken| {
            let silent = if token.english.is_some() { WordRole::Filler } else { WordRole::Unknown };
            let role = roles.get(&token.span).copied().unwrap_or(silent);
            let says = |english: &str| english.split_whitespace().any(|word| !STOP_WORDS.contains(&word));
            ReadWord { span: token.span, role, is_counted: token.english.is_none_or(says) }
        };
        gloss.tokens.iter().map(read).collect()
    }

    /// The byte range of the text that the English word at a byte range stands for; `None` for a word that English alone needs.
    #[must_use]
    pub fn source_of_word(&self, span: [usize; 2]) -> Option<[usize; 2]> {
        match &self.gloss {
            Some(gloss) => gloss.source_of_word(span),
            None => Some(span),
        }
    }

    /// The byte range of the text that a byte range of the English words means.
    #[must_use]
    pub fn source_span(&self, span: [usize; 2]) -> [usize; 2] {
        self.gloss.as_ref().map_or(span, |gloss| gloss.source_span(span))
    }
}

impl LanguagePack {
    /// Reads the files of a pack. With a line that is no rule, it would have no rules; a test reads every line of every pack.
    pub(super) fn parse(files: &PackFiles) -> Self {
        let words = PackWords::parse(files.words, files.is_spaced);
        Self { language: files.language, words, stages: parse_stages(files.rules).unwrap_or_default() }
    }

    /// The English words of the things and rooms that a text in the language names.
    pub(super) fn named_in(&self, text: &str) -> Vec<String> {
        let (chunks, _) = self.words.split_chunks(text);
        let senses = chunks.iter().filter_map(|chunk| chunk.senses.first());
        let names = senses.filter(|sense| matches!(sense.class, "thing" | "room"));
        let english = |sense: &super::chunks::ChunkSense| {
            sense.words.iter().map(|word| word.word.as_str()).collect::<Vec<_>>().join(" ")
        };
        names.map(english).collect()
    }

    pub(super) fn gloss(&self, text: &str) -> GlossedText {
        let (chunks, tokens) = self.words.split_chunks(text);
        let chunks = self.stages.iter().fold(chunks, |chunks, stage| stage.apply(&chunks));
        let mut gloss = GlossedText { language: self.language, text: String::new(), places: Vec::new(), tokens };
        gloss.add_chunks(&chunks);
        gloss
    }
}

impl GlossedText {
    /// Adds the words of chunks, with commas between clauses.
    fn add_chunks(&mut self, chunks: &[Chunk]) {
        let mut is_joined = true;
        for sense in chunks.iter().filter_map(|chunk| chunk.senses.first()) {
            if sense.class == CLAUSE && !is_joined {
                self.add_word(",", None);
            }
            is_joined = JOINING.contains(&sense.class);
            for word in &sense.words {
                self.add_word(&word.word, word.source);
            }
        }
    }

    fn add_word(&mut self, word: &str, source: Option<[usize; 2]>) {
        let is_word = word.starts_with(char::is_alphanumeric);
        if !is_word && (self.text.is_empty() || self.text.ends_with(word)) {
            return;
        }
        if is_word && !self.text.is_empty() {
            self.text.push(' ');
        }
        let from = self.text.len();
        self.text.push_str(word);
        self.places.push(GlossPlace { span: [from, self.text.len()], source });
    }

    /// The English words.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// The place in the text of the word at a byte range of the gloss; `None` for a word that English alone needs.
    fn source_of_word(&self, [from, _]: [usize; 2]) -> Option<[usize; 2]> {
        let at = self.places.partition_point(|place| place.span[1] <= from);
        self.places.get(at)?.source
    }

    /// The bytes of the text that a byte range of the gloss means, from the first word of the text that has a part in it to the last. Of
    /// words that English alone needs, the next word before them counts.
    pub(super) fn source_span(&self, [from, to]: [usize; 2]) -> [usize; 2] {
        let first = self.places.partition_point(|place| place.span[1] <= from);
        let after = self.places.partition_point(|place| place.span[0] < to).max(first);
        let sources = self.places[first..after].iter().filter_map(|place| place.source);
        let all = sources.reduce(|all, one| [all[0].min(one[0]), all[1].max(one[1])]);
        all.or_else(|| self.places[..first].iter().rev().find_map(|place| place.source)).unwrap_or([0, 0])
    }
}
