//! What a model thinks before it answers, in the forms that servers leave in the answer.

use crate::{
    bounded,
    marks::{ReplyMark, next_mark},
};

/// Parts of the names of marks around thinking: `<think>`, `[THINK]`, `<reasoning>`, `<|begin_of_thought|>`.
const THINKING_NAMES: [&str; 7] = ["think", "thought", "reason", "reflect", "scratch", "monologue", "rationale"];

/// Words with which a model says in plain text that it thinks, and those with which the answer then begins.
const SPOKEN: [(&str, &[&str]); 3] = [
    ("here is my thought process", &["here is my response", "here is my final response", "here's my response"]),
    ("thinking...", &["...done thinking."]),
    ("thinking process:", &["final answer:", "final output:", "answer:"]),
];

/// A reply without what the model thought before its answer. A reply that ends while the model still thinks is empty.
///
/// Some servers put the opening mark into their prompt, so that the reply has only the closing one.
#[must_use]
pub fn without_thinking(reply: &str) -> String {
    let reply = bounded(reply);
    if let Some(answer) = final_channel(reply) {
        return answer;
    }
    without_blocks(behind_spoken_thinking(&tags_of_open_marks(reply))).trim().to_owned()
}

/// A text with tags in place of the marks in three pieces that Kimi writes: `<|open|>think<|sep|>`.
fn tags_of_open_marks(text: &str) -> String {
    let tagged = |text: String, (mark, tag): (&str, &str)| {
        let mut parts = text.split(mark);
        let first = parts.next().unwrap_or_default().to_owned();
        parts.fold(first, |text, part| match part.split_once("<|sep|>") {
            Some((name, rest)) => format!("{text}{tag}{name}>{rest}"),
            None => text + mark + part,
        })
    };
    [("<|open|>", "<"), ("<|close|>", "</")].into_iter().fold(text.to_owned(), tagged)
}

/// The text without blocks between marks of thinking.
fn without_blocks(text: &str) -> String {
    let mut kept = String::new();
    // How many blocks are open, and where the text that is not read yet begins.
    let (mut depth, mut from, mut at) = (0_usize, 0, 0);
    let mut is_closed = true;
    while let Some(mark) = next_mark(text, at) {
        at = mark.span.end;
        let is_meant = is_thinking(&mark) || (depth > 0 && ends_details(&mark));
        if !is_meant {
            continue;
        }
        is_closed = closes_thinking(&mark);
        match (is_closed, depth) {
            (false, 0) => {
                kept.push_str(&text[from..mark.span.start]);
                depth = 1;
            }
            (false, _) => depth += 1,
            // Without an opening mark, all before is thinking.
            (true, 0) => kept.clear(),
            (true, _) => depth -= 1,
        }
        from = at;
    }
    // Some models open a block twice and close it once.
    if depth == 0 || is_closed {
        kept.push_str(&text[from..]);
    }
    kept
}

fn is_thinking(mark: &ReplyMark) -> bool {
    let names = |text: &str| THINKING_NAMES.iter().any(|name| text.contains(name));
    let is_numbered = matches!(mark.name.as_str(), "unused94" | "unused95" | "inner_prefix" | "inner_suffix");
    names(&mark.name) || is_numbered || (mark.name == "details" && names(&mark.attributes)) || mark.name == "analysis"
}

/// Whether a mark ends a block of any kind: `</details>` and `<|end_message|>` do not say of what.
fn ends_details(mark: &ReplyMark) -> bool {
    mark.closes && matches!(mark.name.as_str(), "details" | "end_message")
}

/// Whether a mark closes thinking. Two models' own marks do not show it by their form.
fn closes_thinking(mark: &ReplyMark) -> bool {
    mark.closes || matches!(mark.name.as_str(), "unused95" | "inner_suffix")
}

/// The answer of a model that writes into channels (gpt-oss, Gemma): what stands in the channel "final", or the call of
/// a tool in the channel "commentary". `None` where the reply has no channels.
fn final_channel(reply: &str) -> Option<String> {
    const CHANNEL: [&str; 2] = ["<|channel|>", "<|channel>"];
    // Servers that leave out unknown tokens leave only the channels' names.
    let bare = reply.trim_start();
    if bare.starts_with("analysis") && bare.contains("assistantfinal") {
        return bare.rsplit("assistantfinal").next().map(|answer| answer.trim().to_owned());
    }
    if !CHANNEL.iter().any(|mark| reply.contains(mark)) {
        return None;
    }
    let parts: Vec<&str> = reply.split("<|channel|>").flat_map(|part| part.split("<|channel>")).collect();
    let (before, channels) = parts.split_first()?;
    let content = |part: &str| {
        let content = part.split_once("<|message|>").map_or(part, |(_, content)| content);
        let ends = ["<|end|>", "<|return|>", "<|start|>", "<|call|>"];
        let end = ends.iter().filter_map(|end| content.find(end)).min().unwrap_or(content.len());
        content[..end].trim().to_owned()
    };
    let of_final = channels.iter().rev().find(|part| part.trim_start().starts_with("final"));
    if let Some(part) = of_final {
        return Some(content(part));
    }
    if let Some(part) = channels.iter().rev().find(|part| part.starts_with("commentary") && part.contains("to=")) {
        return Some((*part).to_owned());
    }
    if let Some(part) = channels.iter().rev().find(|part| part.trim_start().starts_with("commentary")) {
        // The tool may be named before the channel.
        let called = before_channel(reply, part);
        return Some(if called.contains("to=") { format!("{called} {}", content(part)) } else { content(part) });
    }
    // Gemma closes the channel of its thoughts, and answers behind it.
    let behind = channels.last().and_then(|part| part.split_once("<channel|>"));
    Some(behind.map_or_else(|| before.trim().to_owned(), |(_, answer)| answer.trim().to_owned()))
}

/// What stands before the last channel of a reply, from the beginning of its turn.
fn before_channel<'a>(reply: &'a str, part: &str) -> &'a str {
    let at = reply.rfind(part).unwrap_or_default();
    let turn = reply[..at].rsplit("<|start|>").next().unwrap_or_default();
    turn.trim_end_matches("<|channel|>").trim_start_matches("assistant").trim()
}

/// The text behind thinking that is announced in plain words.
fn behind_spoken_thinking(text: &str) -> &str {
    let plain = text.to_ascii_lowercase();
    let begin =
        plain.trim_start_matches(|c: char| c.is_whitespace() || "*#".contains(c)).replace("here's my", "here is my");
    for (announced, answered) in SPOKEN {
        if !begin.starts_with(announced) {
            continue;
        }
        // Lower case in ASCII keeps every byte in its place.
        let end = answered.iter().filter_map(|words| plain.rfind(words).map(|at| at + words.len())).max();
        if let Some(end) = end {
            return text[end..].trim_start_matches(|c: char| c.is_whitespace() || ":*".contains(c));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ANSWER: &str = "Go to the sink.";

    #[test]
    fn every_known_form_of_thinking_is_left_out() {
        for reply in [
            "<think>I see a bed.</think>\n\nGo to the sink.",
            "I see a bed.\n</think>\n\nGo to the sink.",
            "<think>\n</think>Go to the sink.",
            "<THINK>x</THINK>Go to the sink.",
            "<thinking>Plan: <b>go</b></thinking>\nGo to the sink.",
            "<thought>A bed.</thought>Go to the sink.",
            "<reasoning>A bed.</reasoning>\nGo to the sink.",
            "<reflection>No.</reflection>Go to the sink.",
            "<scratchpad>No.</scratchpad>Go to the sink.",
            "<seed:think>A bed.</seed:think>Go to the sink.",
            "[THINK]A bed.[/THINK]Go to the sink.",
            "◁think▷A bed.◁/think▷Go to the sink.",
            "<|START_THINKING|>A bed.<|END_THINKING|>Go to the sink.",
            "<|begin_of_thought|>A bed.<|end_of_thought|>Go to the sink.",
            "<|thinking|>A bed.<|/thinking|>Go to the sink.",
            "<think>a <think>b</think> c</think>Go to the sink.",
            "<details type=\"reasoning\" done=\"true\"><summary>Thought for 3 s</summary>A bed.</details>Go to the sink.",
            "<unused94>thought\nA bed.<unused95>Go to the sink.",
            "<|channel>thought\nA bed.<channel|>Go to the sink.",
            "<|channel|>analysis<|message|>A bed.<|end|><|start|>assistant<|channel|>final<|message|>Go to the sink.<|return|>",
            "<|channel|>final<|message|>Go to the sink.",
            "analysisA bed.assistantfinalGo to the sink.",
            "Here is my thought process:\nA bed.\nHere is my response:\nGo to the sink.",
            "Thinking...\nA bed.\n...done thinking.\n\nGo to the sink.",
            "<think>a</think><think>b</think>Go to the sink.",
            "<think><think>a</think>Go to the sink.",
            "</mm:think>Go to the sink.",
            "` ends the block.\n</think>\nGo to the sink.",
            "<|open|>think<|sep|>A bed.<|close|>think<|sep|>Go to the sink.",
            "<|inner_prefix|>A bed.<|inner_suffix|>Go to the sink.",
            "<scratch_pad>A bed.</scratch_pad>Go to the sink.",
            "<think:opensource>A bed.</think:opensource>Go to the sink.",
            "<|channel|>commentary<|message|>Go to the sink.<|end|>",
            "**Thinking Process:**\n\n1. A bed.\n\nFinal answer: Go to the sink.",
            ANSWER,
        ] {
            assert_eq!(without_thinking(reply), ANSWER, "{reply}");
        }
        for unfinished in ["<think>Go to the", "<|channel|>analysis<|message|>Go to the", "[THINK]Go"] {
            assert_eq!(without_thinking(unfinished), "", "{unfinished}");
        }
    }

    proptest! {
        #[test]
        fn any_reply_is_read(reply in "(<think>|</think>|\\[THINK\\]|<\\|channel\\|>|final|\\PC|\n){0,40}") {
            let once = without_thinking(&reply);
            prop_assert!(once.len() <= reply.len());
        }
    }
}
