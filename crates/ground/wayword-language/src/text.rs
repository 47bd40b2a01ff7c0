//! Texts as words and sentences, with their places.

/// A word or a punctuation mark of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    /// Lower case.
    pub word: String,
    /// Byte range in the text.
    pub span: [usize; 2],
}

impl Token {
    /// Whether it is a word and not a mark.
    #[must_use]
    pub fn is_word(&self) -> bool {
        self.word.chars().next().is_some_and(char::is_alphanumeric)
    }

    /// Whether it ends a sentence.
    #[must_use]
    pub fn ends_sentence(&self) -> bool {
        matches!(self.word.as_str(), "." | "!" | "?")
    }
}

/// The words and marks of a text. An apostrophe or a hyphen within a word belongs to it.
#[must_use]
pub fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut start = None;
    let mut chars = text.char_indices().peekable();
    while let Some((at, c)) = chars.next() {
        let next_is_word = chars.peek().is_some_and(|(_, next)| next.is_alphanumeric());
        let inside = c.is_alphanumeric() || (start.is_some() && matches!(c, '\'' | '’') && next_is_word);
        if inside {
            start.get_or_insert(at);
            continue;
        }
        if let Some(from) = start.take() {
            tokens.push(Token { word: text[from..at].to_lowercase(), span: [from, at] });
        }
        if !c.is_whitespace() && c != '-' {
            tokens.push(Token { word: c.to_string(), span: [at, at + c.len_utf8()] });
        }
    }
    if let Some(from) = start {
        tokens.push(Token { word: text[from..].to_lowercase(), span: [from, text.len()] });
    }
    tokens
}

/// The words of a text, lower case, without marks.
#[must_use]
pub fn words(text: &str) -> Vec<String> {
    tokens(text).into_iter().filter(Token::is_word).map(|token| token.word).collect()
}

/// A text with its first letter as a capital.
#[must_use]
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Number of words in a text, as people count them: what stands between spaces and is not a mark alone.
#[must_use]
pub fn word_count(text: &str) -> usize {
    text.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

/// Number of sentences: runs of words up to a full stop, exclamation or question mark, or the end.
#[must_use]
pub fn sentence_count(text: &str) -> usize {
    tokens(text).split(Token::ends_sentence).filter(|sentence| sentence.iter().any(Token::is_word)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn words_sentences_and_marks_are_told_apart() {
        let text = "Walk to the robot's den. Then turn left, and wait!";
        assert_eq!(word_count(text), 10);
        assert_eq!(sentence_count(text), 2);
        assert_eq!(words(text)[3], "robot's");
        assert_eq!(sentence_count("no stop at the end"), 1);
        assert_eq!(sentence_count(""), 0);
    }

    proptest! {
        #[test]
        fn spans_point_at_their_words(text in "\\PC{0,60}") {
            for token in tokens(&text) {
                prop_assert_eq!(text[token.span[0]..token.span[1]].to_lowercase(), token.word);
            }
        }
    }
}
