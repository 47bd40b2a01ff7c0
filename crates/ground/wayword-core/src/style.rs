//! Styles: kinds of instruction, described by reference texts and by rules. They are data, which users can add to.

use serde::{Deserialize, Serialize};

/// A kind of instruction: reference texts that show it, and the rules for every text of this kind.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstructionStyle {
    /// Its name, as `--style` takes it.
    pub name: String,
    /// The language of its texts, as a tag such as "zh"; empty for English.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub language: String,
    /// Texts in this style. The writer imitates their shape and may not copy them.
    #[serde(default)]
    pub references: Vec<String>,
    /// How many words its texts have: a writer draws from these. Where there are none, the lengths of the references count.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub words: Vec<usize>,
    /// How a writer by rules chooses among wordings, apart from how often people of the style use them.
    #[serde(default, skip_serializing_if = "WordingPolicy::is_open")]
    pub choice: WordingPolicy,
    /// The rules for a text of this style.
    #[serde(default)]
    pub constraints: StyleConstraints,
}

impl InstructionStyle {
    /// The same style with texts in another language, of which its name gets the tag. How many sentences a text has at least is a rule for one
    /// language: others join more clauses by commas.
    #[must_use]
    pub fn in_language(&self, tag: &str) -> Self {
        let constraints = StyleConstraints { min_sentences: None, ..self.constraints.clone() };
        Self { name: format!("{}-{tag}", self.name), language: tag.to_owned(), constraints, ..self.clone() }
    }

    /// The name by which random draws are made. It is the same in all languages, so that the texts for a path agree in what they name.
    #[must_use]
    pub fn draw_name(&self) -> &str {
        let base = self.name.strip_suffix(self.language.as_str()).and_then(|base| base.strip_suffix('-'));
        base.filter(|_| !self.language.is_empty()).unwrap_or(&self.name)
    }
}

/// Choices that references cannot show. A field that is `None` is left to the program.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WordingPolicy {
    /// In which share of texts the target is described until no other object fits, 0 to 1. The others have as many
    /// details as people give.
    pub sure: Option<f64>,
    /// By which power of their share wordings are drawn, 0 to 10. At 1 as people do; above it, the commonest oftener.
    pub sharp: Option<f64>,
}

impl WordingPolicy {
    /// Whether it leaves every choice to the program.
    fn is_open(&self) -> bool {
        *self == Self::default()
    }
}

/// Rules that a text of a style is checked against. A field that is `None` or false sets no rule.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StyleConstraints {
    /// Least number of sentences.
    pub min_sentences: Option<usize>,
    /// Greatest number of sentences.
    pub max_sentences: Option<usize>,
    /// A bound on the number of words: the text has fewer.
    pub fewer_words_than: Option<usize>,
    /// The text ends in a task on an object of the final viewpoint.
    pub ends_in_task: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_the_same_in_every_language() {
        let style = InstructionStyle { name: "r2r".into(), ..InstructionStyle::default() };
        let chinese = style.in_language("zh");
        assert_eq!((chinese.name.as_str(), chinese.draw_name(), style.draw_name()), ("r2r-zh", "r2r", "r2r"));
        let own = InstructionStyle { name: "mine-zh".into(), ..InstructionStyle::default() };
        assert_eq!(own.draw_name(), "mine-zh");
    }
}
