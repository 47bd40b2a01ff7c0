//! Carries the letter case of a word over to its replacement: "Left" becomes "Right".

/// How a word is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LetterCase {
    /// "left".
    Lower,
    /// "Left".
    Title,
    /// "LEFT".
    Upper,
}

impl LetterCase {
    /// The case of a text, by its first two letters.
    pub(super) fn for_text(text: &str) -> Self {
        let mut letters = text.chars().filter(|c| c.is_alphabetic());
        match (letters.next(), letters.next()) {
            (Some(first), Some(second)) if first.is_uppercase() && second.is_uppercase() => Self::Upper,
            (Some(first), _) if first.is_uppercase() => Self::Title,
            _ => Self::Lower,
        }
    }

    /// Writes a lower-case text in this case.
    pub(super) fn apply_to(self, text: &str) -> String {
        match self {
            Self::Lower => text.to_owned(),
            Self::Title => capitalise_first(text),
            Self::Upper => text.to_uppercase(),
        }
    }
}

/// A text with its first letter in upper case.
pub(super) fn capitalise_first(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

/// A text with its first letter in lower case, where it is a word in title case.
pub(super) fn uncapitalise_first(text: &str) -> String {
    let mut chars = text.chars();
    match (LetterCase::for_text(text.split_whitespace().next().unwrap_or_default()), chars.next()) {
        (LetterCase::Title, Some(first)) => first.to_lowercase().chain(chars).collect(),
        _ => text.to_owned(),
    }
}

/// A text with some spans (bytes) replaced; the spans are in order and do not overlap.
pub(super) fn replace_spans(text: &str, edits: &[([usize; 2], String)]) -> String {
    let mut new = String::with_capacity(text.len());
    let mut from = 0;
    for ([start, end], with) in edits {
        new.push_str(&text[from..*start]);
        new.push_str(with);
        from = *end;
    }
    new.push_str(&text[from..]);
    new
}
