//! Thinking aloud, which is not part of the answer.

const OPEN: &str = "<think>";
const CLOSE: &str = "</think>";

/// A text without the thinking at its beginning.
///
/// Some servers open the thinking in their prompt template, so that only its end is in the text.
pub(super) fn removed(text: &str) -> &str {
    let text = text.trim_start();
    match (text.strip_prefix(OPEN), text.find(CLOSE)) {
        (Some(_), Some(at)) => &text[at + CLOSE.len()..],
        // Cut off while it was still thinking.
        (Some(_), None) => "",
        (None, Some(at)) if !text[..at].contains(OPEN) => &text[at + CLOSE.len()..],
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinking_is_removed_where_it_comes_first() {
        assert_eq!(removed("\n<think>a sofa?</think>\n\nA sofa."), "\n\nA sofa.");
        assert_eq!(removed("a sofa?\n</think>A sofa."), "A sofa.");
        assert_eq!(removed("<think>is it a"), "");
        assert_eq!(removed("A sign says <think>hard</think>."), "A sign says <think>hard</think>.");
        assert_eq!(removed("A sofa."), "A sofa.");
    }
}
