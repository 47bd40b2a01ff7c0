//! Divides an instruction into parts by its mentions alone, where the path has no poses, and for records of older versions. Each mention names
//! the frame that shows its landmark or room, or at which its turn is made. Example: "Walk past the table. Turn left" becomes two
//! parts; the second begins at the frame of the turn.

use std::collections::BTreeSet;
use wayword_core::{InstructionPart, MentionKind, TextMention};
use wayword_language::{
    languages::ReadableText,
    reading::{read_instruction, steps::read_steps},
};

/// A part of an instruction, with the frames of its mentions.
#[derive(Debug, Clone, Copy)]
struct MentionedPart {
    span: [usize; 2],
    /// The last frame of its mentions; a turn ends one frame later.
    end: usize,
    /// The frame of its first mention, if that is a turn.
    turns_at: Option<usize>,
}

/// The parts of a text with these mentions along a path of `frames` frames. The first begins at the first frame, each begins where
/// the one before ends, and the last ends at the last frame. Words without evidence belong to the part before them, or to the first.
#[must_use]
pub fn parts_from_mentions(text: &str, mentions: &[TextMention], frames: usize) -> Vec<InstructionPart> {
    let Some(last) = frames.checked_sub(1) else { return Vec::new() };
    let mut all: Vec<MentionedPart> = Vec::new();
    // Where the words without evidence before the first part begin; the first part takes them.
    let mut waiting_begin: Option<usize> = None;
    let readable = ReadableText::new(text, None);
    for step in read_steps(&read_instruction(readable.english(), &BTreeSet::new())) {
        let [begin, end] = readable.source_span(step.span);
        let begin = waiting_begin.take().unwrap_or(begin);
        let span = [begin, end];
        match (part_from_span(mentions, span, last), all.last_mut()) {
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
        InstructionPart { span: part.span, frames, confidence: None }
    });
    parts.collect()
}

/// The part for a span of the text; `None` if no mention lies in it.
fn part_from_span(mentions: &[TextMention], span: [usize; 2], last: usize) -> Option<MentionedPart> {
    let within = |mention: &&TextMention| span[0] <= mention.span[0] && mention.span[1] <= span[1];
    let mentions: Vec<_> = mentions.iter().filter(within).collect();
    let end_frame = |mention: &TextMention| {
        if mention.kind == MentionKind::Turn { (mention.frame + 1).min(last) } else { mention.frame.min(last) }
    };
    let end = mentions.iter().map(|mention| end_frame(mention)).max()?;
    let opening = mentions.iter().min_by_key(|mention| mention.span[0]);
    let turns_at = opening.filter(|mention| mention.kind == MentionKind::Turn).map(|mention| mention.frame.min(last));
    Some(MentionedPart { span, end, turns_at })
}

/// The frame at which each part ends: the frame of the turn with which the next part begins, or else its own last frame.
fn end_frames(parts: &[MentionedPart], last: usize) -> Vec<usize> {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The parts of a text with these mentions (words, kind, frame).
    fn parts(text: &str, mentions: &[(&str, MentionKind, usize)], frames: usize) -> Vec<(String, [usize; 2])> {
        let mentions: Vec<TextMention> = mentions
            .iter()
            .map(|(words, kind, frame)| {
                let from = text.find(words).unwrap();
                TextMention { span: [from, from + words.len()], kind: *kind, frame: *frame }
            })
            .collect();
        let parts = parts_from_mentions(text, &mentions, frames);
        parts.into_iter().map(|part| (text[part.span[0]..part.span[1]].to_owned(), part.frames)).collect()
    }

    #[test]
    fn parts_follow_one_another_and_a_turn_begins_its_part() {
        let text = "Walk past the table. Turn left and go into the hall, then stop at the sink.";
        let mentions = [
            ("table", MentionKind::Landmark, 1),
            ("left", MentionKind::Turn, 3),
            ("hall", MentionKind::Room, 4),
            ("sink", MentionKind::Landmark, 6),
        ];
        let frames: Vec<[usize; 2]> = parts(text, &mentions, 8).into_iter().map(|(_, frames)| frames).collect();
        assert_eq!(frames, [[0, 3], [3, 4], [4, 4], [4, 7]]);
    }

    #[test]
    fn words_without_evidence_belong_to_a_neighbour() {
        let text = "Go ahead. Walk past the sofa. Keep going. Stop at the bed.";
        let mentions = [("sofa", MentionKind::Landmark, 1), ("bed", MentionKind::Landmark, 3)];
        let found = parts(text, &mentions, 4);
        assert!(found[0].0.starts_with("Go ahead") && found[0].0.contains("Keep going"), "{found:?}");
        assert_eq!((found.len(), found[0].1, found[1].1), (2, [0, 1], [1, 3]));
    }

    #[test]
    fn a_text_without_evidence_has_no_parts() {
        assert!(parts("Walk on.", &[], 3).is_empty());
    }
}
