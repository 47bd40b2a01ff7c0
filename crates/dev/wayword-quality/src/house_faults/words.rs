//! Splits texts into words with their places.

/// A word of a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FaultWord {
    /// Byte range in the text.
    pub(super) span: [usize; 2],
    /// The word in lower case.
    pub(super) low: String,
}

/// The words of a text: letters and digits, with hyphens and apostrophes inside.
pub(super) fn list_words(text: &str) -> Vec<FaultWord> {
    let is_inside = |c: char| c.is_alphanumeric() || matches!(c, '\'' | '-');
    let mut words = Vec::new();
    let mut start = None;
    for (at, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match (is_inside(c), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                let low = text.get(from..at).unwrap_or_default().to_lowercase();
                words.push(FaultWord { span: [from, at], low });
                start = None;
            }
            _ => {}
        }
    }
    words
}

/// A text with other words in place of a byte range; `None` where the range does not fit the text.
pub(super) fn replace_span(text: &str, [from, to]: [usize; 2], now: &str) -> Option<String> {
    text.get(from..to)?;
    Some(format!("{}{now}{}", text.get(..from)?, text.get(to..)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn list_words_keeps_places_and_lowers_letters() {
        let text = "Turn left, then \u{c4}pfel: walk-in.";
        let words = list_words(text);
        let lows: Vec<&str> = words.iter().map(|word| word.low.as_str()).collect();
        assert_eq!(lows, ["turn", "left", "then", "\u{e4}pfel", "walk-in"]);
        assert!(words.iter().all(|word| text[word.span[0]..word.span[1]].to_lowercase() == word.low));
        assert!(list_words(" ., ").is_empty());
    }

    #[test]
    fn replace_span_refuses_a_range_outside_the_text() {
        assert_eq!(replace_span("turn left now", [5, 9], "right").as_deref(), Some("turn right now"));
        for span in [[5, 99], [9, 5], [1, 2]] {
            assert_eq!(replace_span("\u{e4}urn left", span, "x"), None, "{span:?}");
        }
    }
}
