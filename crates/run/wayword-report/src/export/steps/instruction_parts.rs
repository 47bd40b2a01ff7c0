//! The parts of an instruction as a trajectory has them: with their words, their frames and the numbers of their steps.

use wayword_checks::parts_from_mentions;
use wayword_core::Instruction;
use wayword_formats::trajectories::SubInstruction;

/// Words between two parts, which belong to neither.
const CONJUNCTIONS: [&str; 3] = ["and", "then", "or"];

/// The parts of an instruction along a walk whose frames were reached after these numbers of steps, and how many were joined. Records
/// of older versions have no parts; theirs are found by the mentions.
///
/// The first part begins with the walk. A part without length on the walk ("go into the hall", where the turn before already leads
/// into it) is joined with the next part, and the last one with the part before. So the starts strictly grow.
pub(super) fn split_instruction(instruction: &Instruction, frame_steps: &[usize]) -> (Vec<SubInstruction>, usize) {
    let text = instruction.text.as_str();
    let by_mentions = || parts_from_mentions(text, &instruction.mentions, frame_steps.len());
    let parts = if instruction.parts.is_empty() { by_mentions() } else { instruction.parts.clone() };
    let mut stretches: Vec<PartStretch> = parts
        .iter()
        .filter_map(|part| {
            let [Some(first), Some(last)] = part.frames.map(|frame| frame_steps.get(frame).copied()) else {
                return None;
            };
            Some(PartStretch { span: part.span, frames: part.frames, steps: [first, last] })
        })
        .collect();
    if let (Some(stretch), Some(first_step)) = (stretches.first_mut(), frame_steps.first()) {
        (stretch.frames[0], stretch.steps[0]) = (0, *first_step);
    }
    let before = stretches.len();
    let joined = join_parts_without_length(stretches);
    let count = before - joined.len();
    let sub_instruction = |PartStretch { span, frames, steps }| {
        let span = trim_span(text, span);
        Some(SubInstruction { text: text.get(span[0]..span[1])?.to_owned(), span, frames, steps })
    };
    (joined.into_iter().filter_map(sub_instruction).collect(), count)
}

/// A part of a text, with the stretch of the walk that it is about.
struct PartStretch {
    span: [usize; 2],
    frames: [usize; 2],
    steps: [usize; 2],
}

/// Joins each part that does not begin before the next with that one, and a last part without length with the one before it.
fn join_parts_without_length(parts: Vec<PartStretch>) -> Vec<PartStretch> {
    let mut joined: Vec<PartStretch> = Vec::with_capacity(parts.len());
    for part in parts {
        match joined.last_mut() {
            Some(last) if part.steps[0] <= last.steps[0] => last.extend_to(&part),
            _ => joined.push(part),
        }
    }
    if let [.., before, last] = joined.as_mut_slice()
        && last.steps[0] >= last.steps[1]
    {
        before.extend_to(last);
        joined.pop();
    }
    joined
}

impl PartStretch {
    /// Makes it reach to the end of a later part.
    fn extend_to(&mut self, later: &Self) {
        self.span[1] = self.span[1].max(later.span[1]);
        if later.steps[1] > self.steps[1] {
            (self.frames[1], self.steps[1]) = (later.frames[1], later.steps[1]);
        }
    }
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

    #[test]
    fn parts_have_their_words_without_conjunctions_and_their_steps() {
        let text = "Walk past the table. Turn left and go into the hall, then stop at the sink.";
        let ends = ["table.", "left", "hall,", "sink."].map(|words| text.find(words).unwrap() + words.len());
        let starts = [0, ends[0], ends[1], ends[2]];
        let frames = [[0, 3], [3, 4], [4, 4], [4, 7]];
        let part = |at: usize| json!({"span": [starts[at], ends[at]], "frames": frames[at], "confidence": 0.5});
        let instruction: Instruction = serde_json::from_value(json!({
            "text": text, "style": "r2r", "mentions": [], "verdict": "pass", "findings": [],
            "parts": (0..4).map(part).collect::<Vec<_>>(),
            "provenance": {
                "wayword": "0", "asker": "rules", "answerer": "labels", "summariser": "rules", "writer": "rules",
                "checked_against": "labels", "seed": 0, "style_hash": "", "repairs": 0,
            },
        }))
        .unwrap();
        let steps: Vec<usize> = (0..8).map(|frame| frame * 4).collect();
        let (parts, joined) = split_instruction(&instruction, &steps);
        assert!(parts.iter().all(|part| text.get(part.span[0]..part.span[1]) == Some(&part.text)));
        let found: Vec<_> = parts.iter().map(|part| (part.text.as_str(), part.frames, part.steps)).collect();
        let expected = [
            ("Walk past the table", [0, 3], [0, 12]),
            ("Turn left", [3, 4], [12, 16]),
            ("go into the hall, then stop at the sink", [4, 7], [16, 28]),
        ];
        assert_eq!((found.as_slice(), joined), (&expected[..], 1));
    }
}
