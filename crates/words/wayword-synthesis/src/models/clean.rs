//! Takes from a model's reply what was asked for.

/// The part of a text up to its last full stop; all of it where there is none.
pub(super) fn whole_sentences(text: &str) -> &str {
    let text = text.trim();
    text.rfind(['.', '!', '?']).map_or(text, |end| &text[..=end])
}

/// A text as one line, without the label, the quotes and the marks of emphasis that models put around it.
pub(super) fn plain(text: &str, labels: &[&str]) -> String {
    let joined = text.split_whitespace().collect::<Vec<_>>().join(" ").replace("**", "");
    let mut rest = joined.trim();
    for label in labels {
        let starts = rest.get(..label.len()).is_some_and(|start| start.eq_ignore_ascii_case(label));
        if let Some(after) = rest.get(label.len()..).filter(|_| starts).and_then(|after| after.strip_prefix(':')) {
            rest = after.trim();
        }
    }
    for (open, close) in [('"', '"'), ('“', '”'), ('\'', '\'')] {
        let inner = rest.strip_prefix(open).and_then(|inner| inner.strip_suffix(close));
        rest = inner.filter(|inner| !inner.contains(open)).map_or(rest, str::trim);
    }
    rest.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_quotes_and_emphasis_are_taken_off() {
        let labels = ["instruction", "caption"];
        for (told, wanted) in [
            ("**Instruction:** \"Go to the\n sink.\"", "Go to the sink."),
            ("Go to the sink.", "Go to the sink."),
            ("“Go.”", "Go."),
            ("\"Go\" and \"stop\"", "\"Go\" and \"stop\""),
            ("instruction", "instruction"),
            ("", ""),
        ] {
            assert_eq!(plain(told, &labels), wanted);
        }
    }

    #[test]
    fn a_sentence_that_was_cut_off_is_left_out() {
        assert_eq!(whole_sentences("A bed. A lamp and a"), "A bed.");
        assert_eq!(whole_sentences("A lamp and a"), "A lamp and a");
    }
}
