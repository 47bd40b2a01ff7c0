//! Marks in a reply: everything in angle or square brackets that is no word of the answer. Models and chat templates
//! write them around turns, roles, thinking and answers.

use std::ops::Range;

/// Longest mark, bytes. A longer piece in brackets is text.
const MAX_MARK_BYTES: usize = 80;

/// A mark of a reply.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ReplyMark {
    /// Where it stands in the reply, bytes.
    pub(crate) span: Range<usize>,
    /// What it says, lower case, without brackets, bars and slash: "think", "im_end", "inst".
    pub(crate) name: String,
    /// What stands behind the name, as in `<details type="reasoning">`; lower case.
    pub(crate) attributes: String,
    /// Whether it closes something: `</think>`, `[/INST]`, `<|END_THINKING|>`.
    pub(crate) closes: bool,
    /// Whether it is written as templates write their own marks, with bars, and not as a tag: `<|im_end|>`.
    pub(crate) has_bars: bool,
}

/// The next mark of a text from byte `from` on.
pub(crate) fn next_mark(text: &str, from: usize) -> Option<ReplyMark> {
    let mut from = from;
    loop {
        let open = from + text[from..].find(['<', '[', '◁'])?;
        match mark_at(text, open) {
            Some(mark) => return Some(mark),
            None => from = open + text[open..].chars().next().map_or(1, char::len_utf8),
        }
    }
}

/// The mark that begins at byte `open`, if one does.
fn mark_at(text: &str, open: usize) -> Option<ReplyMark> {
    let rest = &text[open..];
    let bracket = rest.chars().next()?;
    let close = match bracket {
        '<' => '>',
        '[' => ']',
        _ => '▷',
    };
    let within = &rest[bracket.len_utf8()..];
    let bounded = &within[..within.floor_char_boundary(MAX_MARK_BYTES)];
    let length = bounded.find(close)?;
    let inside = &within[..length];
    let has_bars = inside.starts_with(['|', '｜']) || inside.ends_with(['|', '｜']);
    let bare = inside.trim_matches(['|', '｜']);
    let slashed = bare.starts_with('/');
    let bare = bare.trim_matches(['/', '|', '｜']).to_lowercase().replace(['▁', '-', ':'], "_");
    let (name, attributes) = bare.split_once([' ', '=']).unwrap_or((&bare, ""));
    let is_name = name.starts_with(char::is_alphanumeric)
        && name.contains(char::is_alphabetic)
        && name.chars().all(|c| c.is_alphanumeric() || "_.｜".contains(c));
    // In square brackets stand the marks of few templates, all in capitals; anything else is text or a list.
    let is_square =
        bracket == '[' && !inside.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || "/_".contains(c));
    if !is_name || inside.contains('\n') || is_square {
        return None;
    }
    let closes = slashed || name.starts_with("end_") || name.ends_with("_end");
    let span = open..open + bracket.len_utf8() + length + close.len_utf8();
    Some(ReplyMark { span, name: name.to_owned(), attributes: attributes.to_owned(), closes, has_bars })
}

/// Names of marks behind which a model's turn is over.
const TURN_ENDS: [&str; 21] = [
    "s",
    "eos",
    "im_end",
    "eot_id",
    "eom_id",
    "eot",
    "end",
    "return",
    "endoftext",
    "end_of_text",
    "end_of_turn",
    "end_of_sentence",
    "end_of_utterance",
    "end_of_turn_token",
    "eos_token",
    "turn",
    "call",
    "end_of_role",
    "eod",
    "im_start",
    "im_assistant",
];

/// Words for the one who speaks, before a turn.
const ROLES: [&str; 7] = ["assistant", "model", "user", "system", "human", "ai", "bot"];

/// A text without the marks of chat templates: turns, roles, boxes, unused tokens. What a server leaves behind the end
/// of the model's turn is left out.
#[must_use]
pub fn without_template_marks(text: &str) -> String {
    let mut kept = String::new();
    let mut at = 0;
    while let Some(mark) = next_mark(text, at) {
        let is_end = is_turn_end(&mark);
        // Numbers between marks of a box place what was named before them in the picture.
        let is_box = mark.name.starts_with("box") || mark.name == "det";
        kept.push_str(if is_box && mark.closes { "" } else { &text[at..mark.span.start] });
        let has_text = kept.contains(char::is_alphanumeric);
        at = mark.span.end;
        if is_end && has_text {
            return without_role(&kept).to_owned();
        }
        if is_template_mark(&mark) || is_end {
            // A role that stands between two marks, as in `<|im_start|>assistant`, is part of them.
            let rest = &text[at..];
            let role = ROLES.iter().find(|role| {
                rest.get(..role.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(role))
                    && rest[role.len()..].chars().next().is_none_or(|next| "\n<: ".contains(next))
            });
            at += role.filter(|_| !has_text).map_or(0, |role| role.len());
        } else {
            kept.push_str(&text[mark.span.clone()]);
        }
    }
    kept.push_str(&text[at..]);
    without_role(&kept).to_owned()
}

fn is_turn_end(mark: &ReplyMark) -> bool {
    // `<s>` begins a text and `</s>` ends it; the others have one meaning.
    let is_named = TURN_ENDS.contains(&mark.name.as_str()) && (mark.name != "s" || mark.closes);
    is_named || (mark.has_bars && mark.name == "start_of_role") || (mark.name == "start_of_turn" && !mark.closes)
}

fn is_template_mark(mark: &ReplyMark) -> bool {
    const NAMES: [&str; 9] = ["s", "bos", "pad", "unk", "inst", "sys", "start_of_turn", "begin_of_box", "end_of_box"];
    let is_byte = mark.name.len() == 4 && mark.name.starts_with("0x");
    mark.has_bars || NAMES.contains(&mark.name.as_str()) || mark.name.starts_with("unused") || is_byte
}

/// A text without the name of the speaker before it: "ASSISTANT: Go on."
fn without_role(text: &str) -> &str {
    let bare = text.trim_start_matches(|c: char| c.is_whitespace() || "#:".contains(c));
    let role = ROLES.iter().find(|role| bare.get(..role.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(role)));
    let behind = role.and_then(|role| bare[role.len()..].strip_prefix([':', '\n']));
    behind.map_or(text, str::trim_start)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_told_from_text_in_brackets() {
        let name = |text| next_mark(text, 0).map(|mark| (mark.name, mark.closes));
        for (text, wanted) in [
            ("a <think> b", Some(("think", false))),
            ("</think>", Some(("think", true))),
            ("<|END_THINKING|>", Some(("end_thinking", true))),
            ("◁/think▷", Some(("think", true))),
            ("<｜end▁of▁sentence｜>", Some(("end_of_sentence", true))),
            ("[/INST]", Some(("inst", true))),
            ("<br/>", Some(("br", false))),
            ("[the door]", None),
            ("[1, 2]", None),
            ("1 < 2 and 3 > 2", None),
            ("<\n>", None),
            ("<", None),
        ] {
            assert_eq!(name(text), wanted.map(|(name, closes)| (name.to_owned(), closes)), "{text}");
        }
    }

    #[test]
    fn template_marks_and_what_follows_the_turn_are_left_out() {
        for reply in [
            "Go to the sink.</s>",
            "<s>Go to the sink.</s>",
            "Go to the sink.<|im_end|>",
            "<|im_start|>assistant\nGo to the sink.<|im_end|>\n<|im_start|>user\nThanks!",
            "Go to the sink.<|endoftext|>\n<|im_start|>user\nThanks!",
            "Go to the sink.<end_of_turn>\n<start_of_turn>user",
            "<|start_header_id|>assistant<|end_header_id|>\n\nGo to the sink.<|eot_id|>",
            "<start_of_turn>model\nGo to the sink.",
            "[/INST] Go to the sink. </s>",
            "ASSISTANT: Go to the sink.",
            "### Assistant:\nGo to the sink.",
            "<|begin_of_box|>Go to the sink.<|end_of_box|>",
            "Go to the sink.<｜end▁of▁sentence｜>",
            "<｜Assistant｜>Go to the sink.",
            "<|assistant|>\nGo to the sink.<|end|>",
            "Go to the sink.<0x0A><eos>",
            "<|im_end|>\n\nGo to the sink.",
            "Go to the sink.[UNUSED_TOKEN_145][UNUSED_TOKEN_145]",
            "Go to the <|object_ref_start|>sink<|object_ref_end|><|box_start|>(12,30),(88,97)<|box_end|>.",
            "Go to the sink.<|im_assistant|>assistant",
            "Go to the sink.[EOS]",
            "assistant\n\nGo to the sink.",
            "<begin_of_box>Go to the sink.<end_of_box>",
            "<|START_RESPONSE|>Go to the sink.<|END_RESPONSE|><|END_OF_TURN_TOKEN|>",
        ] {
            assert_eq!(without_template_marks(reply).trim(), "Go to the sink.", "{reply}");
        }
        for text in
            ["Model trains stand on the shelf.", "Go past the [sic] sofa <here>.", "User manuals lie there: go on."]
        {
            assert_eq!(without_template_marks(text), text);
        }
    }
}
