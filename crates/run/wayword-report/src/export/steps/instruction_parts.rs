//! Divides an instruction into parts, and assigns each part the frames of the walk that it describes. The mentions decide: each names
//! the frame that shows its landmark or room, or at which its turn is made. Example: "Walk past the table. Turn left" becomes two
//! parts; the second begins at the frame of the turn.

use wayword_core::{Instruction, MentionKind};
use wayword_formats::trajectories::SubInstruction;
use wayword_language::reading::{read_instruction, steps::read_steps};

/// Words between two parts, which belong to neither.
const CONJUNCTIONS: [&str; 3] = ["and", "then", "or"];

/// A part of an instruction, with the frames of its mentions.
#[derive(Debug, Clone, Copy)]
struct InstructionPart {
    span: [usize; 2],
    /// The last frame of its mentions; a turn ends one frame later.
    end: usize,
    /// The frame of its first mention, if that is a turn.
    turns_at: Option<usize>,
}

/// The parts of an instruction. The first begins at the first frame, each begins where the one before ends, and the
/// last ends at the last frame. Words without evidence belong to the part before them, or to the first.
pub(super) fn split_instruction(instruction: &Instruction, frame_steps: &[usize]) -> Vec<SubInstruction> {
    let text = instruction.text.as_str();
    let Some(last) = frame_steps.len().checked_sub(1) else { return Vec::new() };
    let mut all: Vec<InstructionPart> = Vec::new();
    // Where the words without evidence before the first part begin; the first part takes them.
    let mut waiting_begin: Option<usize> = None;
    for step in read_steps(&read_instruction(text, &std::collections::BTreeSet::new())) {
        let begin = waiting_begin.take().unwrap_or(step.span[0]);
        let span = [begin, step.span[1]];
        match (part_from_span(instruction, span, last), all.last_mut()) {
            (Some(part), _) => all.push(part),
            (None, Some(before)) => before.span[1] = span[1],
            (None, None) => waiting_begin = Some(begin),
        }
    }
    let ends = end_frames(&all, last);
    let mut from = 0;
    let parts = all.iter().zip(ends).map(|(part, to)| {
        let frames = [from, to];
        from = to;
        let span = trim_span(text, part.span);
        let words = text.get(span[0]..span[1]).unwrap_or_default().to_owned();
        SubInstruction { text: words, span, frames, steps: frames.map(|frame| frame_steps[frame]) }
    });
    parts.collect()
}

/// The part for a span of the text; `None` if no mention lies in it.
fn part_from_span(instruction: &Instruction, span: [usize; 2], last: usize) -> Option<InstructionPart> {
    let within = |mention: &&wayword_core::TextMention| span[0] <= mention.span[0] && mention.span[1] <= span[1];
    let mentions: Vec<_> = instruction.mentions.iter().filter(within).collect();
    let end_frame = |mention: &wayword_core::TextMention| {
        if mention.kind == MentionKind::Turn { (mention.frame + 1).min(last) } else { mention.frame.min(last) }
    };
    let end = mentions.iter().map(|mention| end_frame(mention)).max()?;
    let opening = mentions.iter().min_by_key(|mention| mention.span[0]);
    let turns_at = opening.filter(|mention| mention.kind == MentionKind::Turn).map(|mention| mention.frame.min(last));
    Some(InstructionPart { span, end, turns_at })
}

/// The frame at which each part ends: the frame of the turn with which the next part begins, or else its own last frame.
fn end_frames(parts: &[InstructionPart], last: usize) -> Vec<usize> {
    let mut before = 0;
    let mut ends = Vec::with_capacity(parts.len());
    for (number, part) in parts.iter().enumerate() {
        let end = match parts.get(number + 1) {
            None => last,
            Some(next) => next.turns_at.unwrap_or(part.end),
        };
        before = end.max(before);
        ends.push(before);
    }
    ends
}

/// A span without the conjunctions, marks and blanks at its ends.
fn trim_span(text: &str, [mut from, mut to]: [usize; 2]) -> [usize; 2] {
    let is_mark = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '.' | ':');
    loop {
        let part = text.get(from..to).unwrap_or_default();
        let inner = part.trim_start_matches(is_mark);
        from += part.len() - inner.len();
        let word = inner.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default();
        let is_between =
            CONJUNCTIONS.iter().any(|between| word.eq_ignore_ascii_case(between)) && word.len() < inner.len();
        if !is_between {
            to = from + inner.trim_end_matches(is_mark).len();
            return [from, to];
        }
        from += word.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The parts of a text with these mentions (words, kind, frame).
    fn told(text: &str, mentions: &[(&str, &str, usize)], frames: usize) -> Vec<(String, [usize; 2], [usize; 2])> {
        let mentions: Vec<_> = mentions
            .iter()
            .map(|(words, kind, frame)| {
                let from = text.find(words).unwrap();
                json!({"span": [from, from + words.len()], "kind": kind, "frame": frame})
            })
            .collect();
        let instruction: Instruction = serde_json::from_value(json!({
            "text": text, "style": "r2r", "mentions": mentions, "verdict": "pass", "findings": [],
            "provenance": {
                "wayword": "0", "asker": "rules", "answerer": "labels", "summariser": "rules", "writer": "rules",
                "checked_against": "labels", "seed": 0, "style_hash": "", "repairs": 0,
            },
        }))
        .unwrap();
        let steps: Vec<usize> = (0..frames).map(|frame| frame * 4).collect();
        let parts = split_instruction(&instruction, &steps);
        assert!(parts.iter().all(|part| text.get(part.span[0]..part.span[1]) == Some(&part.text)));
        parts.into_iter().map(|part| (part.text, part.frames, part.steps)).collect()
    }

    #[test]
    fn parts_follow_one_another_and_a_turn_begins_its_part() {
        let text = "Walk past the table. Turn left and go into the hall, then stop at the sink.";
        let found = told(
            text,
            &[("table", "landmark", 1), ("left", "turn", 3), ("hall", "room", 4), ("sink", "landmark", 6)],
            8,
        );
        let expected = [
            ("Walk past the table", [0, 3], [0, 12]),
            ("Turn left", [3, 4], [12, 16]),
            ("go into the hall", [4, 4], [16, 16]),
            ("stop at the sink", [4, 7], [16, 28]),
        ];
        assert_eq!(found, expected.map(|(text, frames, steps)| (text.to_owned(), frames, steps)));
    }

    #[test]
    fn words_without_evidence_belong_to_a_neighbour() {
        let found = told(
            "Go ahead. Walk past the sofa. Keep going. Stop at the bed.",
            &[("sofa", "landmark", 1), ("bed", "landmark", 3)],
            4,
        );
        let texts: Vec<&str> = found.iter().map(|(text, ..)| text.as_str()).collect();
        assert_eq!(texts, ["Go ahead. Walk past the sofa. Keep going", "Stop at the bed"]);
        assert_eq!((found[0].1, found[1].1), ([0, 1], [1, 3]));
    }

    #[test]
    fn a_text_without_evidence_has_no_parts() {
        assert!(told("Walk on.", &[], 3).is_empty());
    }
}
