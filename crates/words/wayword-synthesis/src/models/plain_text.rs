//! Takes the wanted text out of a model's reply: whole sentences only, without labels, quotes and emphasis.

use super::chatter::without_chatter;
use wayword_core::{FinishReason, ModelReply};

/// The text of a reply. Of a reply that was cut off: up to the end of its last sentence, or all of it where no sentence
/// ended.
pub(super) fn whole_sentences(reply: &ModelReply) -> &str {
    let text = reply.text.trim();
    if reply.finish == FinishReason::Stop {
        return text;
    }
    // The dot of "2.5 metres" ends no sentence.
    let ends = |(at, _): &(usize, &str)| text[at + 1..].chars().next().is_none_or(|next| !next.is_alphanumeric());
    text.rmatch_indices(['.', '!', '?']).find(ends).map_or(text, |(end, _)| &text[..=end])
}

/// A text as one line, without the chatter, the label, the quotes and the marks of emphasis that models put around it.
pub(super) fn plain_text(text: &str, labels: &[&str]) -> String {
    let text = text.replace("**", "");
    let joined = without_chatter(&text).split_whitespace().collect::<Vec<_>>().join(" ");
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
            ("Sure! Here is the instruction:\n\n\"Go to the sink.\"\n\nLet me know if it fits.", "Go to the sink."),
            ("```\nInstruction: Go to the sink.\n```", "Go to the sink."),
            ("\"Go\" and \"stop\"", "\"Go\" and \"stop\""),
            ("instruction", "instruction"),
            ("", ""),
        ] {
            assert_eq!(plain_text(told, &labels), wanted);
        }
    }

    #[test]
    fn a_sentence_that_was_cut_off_is_left_out() {
        for (finish, told, wanted) in [
            (FinishReason::Length, "A bed. A lamp and a", "A bed."),
            (FinishReason::Length, "A lamp and a", "A lamp and a"),
            (FinishReason::Length, "A bed. A rug 2.5 metres", "A bed."),
            (FinishReason::Length, "He said \"go!\" and", "He said \"go!"),
            (FinishReason::Stop, "A bed. A lamp and a rug", "A bed. A lamp and a rug"),
            (FinishReason::Stop, " A rug 2.5 metres wide ", "A rug 2.5 metres wide"),
        ] {
            assert_eq!(whole_sentences(&ModelReply { text: told.to_owned(), finish, usage: None }), wanted);
        }
    }
}
