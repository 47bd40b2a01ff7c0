//! Cuts a text where its mentions begin and end, so that each segment can become a link.
//!
//! Spans come from files that anyone may have written: they may overlap, be outside the text or cut a character in two.

use std::collections::BTreeSet;
use wayword_core::{CheckFinding, InstructionPart, TextMention, Verdict};

/// Most mentions that are shown, and most marked flaws.
const MAX_MARKED_SPANS: usize = 200;

/// A run of text under the same mentions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TextSegment<'a> {
    /// Its words; all segments together are the text.
    pub(super) text: &'a str,
    /// The shortest mention that covers it.
    pub(super) mention: Option<&'a TextMention>,
    /// Mentions that end with it, in their order.
    pub(super) ends: Vec<&'a TextMention>,
    /// The number of the part that it belongs to.
    pub(super) part: Option<usize>,
    /// Whether a failed check is about it.
    pub(super) is_flawed: bool,
}

/// The marks of a text.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TextMarks<'a> {
    pub(super) mentions: &'a [TextMention],
    pub(super) parts: &'a [InstructionPart],
    pub(super) findings: &'a [CheckFinding],
}

/// Cuts a text into segments. Marks with a span or frame that does not exist are left out.
pub(super) fn cut_segments<'a>(text: &'a str, marks: TextMarks<'a>, frames: usize) -> Vec<TextSegment<'a>> {
    let TextMarks { mentions, parts, findings } = marks;
    let fits = |span: [usize; 2]| text.get(span[0]..span[1]).is_some_and(|words| !words.is_empty());
    let mentions: Vec<&TextMention> =
        mentions.iter().filter(|mention| fits(mention.span) && mention.frame < frames).take(MAX_MARKED_SPANS).collect();
    let flaws = findings.iter().filter(|finding| finding.verdict == Verdict::Fail).filter_map(|finding| finding.span);
    let flaws: Vec<[usize; 2]> = flaws.filter(|span| fits(*span)).take(MAX_MARKED_SPANS).collect();
    let parts = parts.iter().take(MAX_MARKED_SPANS).enumerate();
    let parts: Vec<(usize, [usize; 2])> =
        parts.map(|(number, part)| (number, part.span)).filter(|(_, span)| fits(*span)).collect();
    let spans = mentions.iter().map(|mention| mention.span).chain(flaws.iter().copied());
    let spans = spans.chain(parts.iter().map(|(_, span)| *span));
    let cuts: BTreeSet<usize> = spans.flatten().chain([0, text.len()]).collect();
    let cuts: Vec<usize> = cuts.into_iter().collect();
    let between = |pair: &[usize]| {
        let (from, to) = (pair[0], pair[1]);
        let covers = |span: [usize; 2]| span[0] <= from && to <= span[1];
        TextSegment {
            text: &text[from..to],
            mention: mentions
                .iter()
                .filter(|mention| covers(mention.span))
                .min_by_key(|mention| mention_length(mention))
                .copied(),
            ends: mentions.iter().filter(|mention| mention.span[1] == to).copied().collect(),
            part: parts.iter().find(|(_, span)| covers(*span)).map(|(number, _)| *number),
            is_flawed: flaws.iter().any(|span| covers(*span)),
        }
    };
    cuts.windows(2).map(between).collect()
}

fn mention_length(mention: &TextMention) -> usize {
    mention.span[1] - mention.span[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use wayword_core::{CheckKind, MentionKind, seeded_rng};

    fn mention(span: [usize; 2], frame: usize) -> TextMention {
        TextMention { span, kind: MentionKind::Landmark, frame }
    }

    fn flaw(span: [usize; 2]) -> CheckFinding {
        CheckFinding { check: CheckKind::Turns, verdict: Verdict::Fail, reason: "wrong way".into(), span: Some(span) }
    }

    fn marks<'a>(mentions: &'a [TextMention], findings: &'a [CheckFinding]) -> TextMarks<'a> {
        TextMarks { mentions, findings, parts: &[] }
    }

    #[test]
    fn segments_know_their_part() {
        let part = |span| InstructionPart { span, frames: [0, 0], confidence: None };
        let parts = [part([0, 4]), part([5, 19]), part([40, 50])];
        let mentions = [mention([5, 9], 1)];
        let segments = cut_segments("Pass sofa, the door.", TextMarks { parts: &parts, ..marks(&mentions, &[]) }, 3);
        let cut: Vec<_> = segments.iter().map(|segment| (segment.text, segment.part)).collect();
        assert_eq!(cut, [("Pass", Some(0)), (" ", None), ("sofa", Some(1)), (", the door", Some(1)), (".", None)]);
    }

    #[test]
    fn words_are_cut_out_with_their_frames() {
        let mentions = [mention([5, 9], 1), mention([15, 19], 2)];
        let segments = cut_segments("Pass sofa, the door.", marks(&mentions, &[]), 3);
        let told: Vec<_> = segments.iter().map(|part| (part.text, part.mention.map(|mention| mention.frame))).collect();
        assert_eq!(told, [("Pass ", None), ("sofa", Some(1)), (", the ", None), ("door", Some(2)), (".", None)]);
    }

    #[test]
    fn of_overlapping_mentions_each_ends_once_and_the_shorter_one_covers() {
        let mentions = [mention([0, 10], 0), mention([4, 6], 1)];
        let segments = cut_segments("0123456789", marks(&mentions, &[]), 2);
        let told: Vec<_> = segments
            .iter()
            .map(|part| (part.text, part.mention.map(|mention| mention.frame), part.ends.len()))
            .collect();
        assert_eq!(told, [("0123", Some(0), 0), ("45", Some(1), 1), ("6789", Some(0), 1)]);
    }

    #[test]
    fn a_flaw_is_marked() {
        let flaws = [flaw([0, 9])];
        let segments = cut_segments("turn left now", marks(&[], &flaws), 1);
        assert_eq!(
            segments.iter().map(|part| (part.text, part.is_flawed)).collect::<Vec<_>>(),
            [("turn left", true), (" now", false)]
        );
    }

    #[test]
    fn segments_cover_the_text_and_end_each_mention_once_for_random_spans() {
        let texts = ["", "a", "Go on.", "Türe – 門 hinter 🪑", "\u{202e}e\u{301}x"];
        let mut random = seeded_rng(5, &["segments"]);
        for text in texts.iter().cycle().take(3000) {
            let mut span = || [random.random_range(0..=text.len() + 2), random.random_range(0..=text.len() + 2)];
            let mentions: Vec<TextMention> = (0..6).map(|frame| mention(span(), frame)).collect();
            let flaws = [flaw(span()), flaw([usize::MAX, 0])];
            let frames = 4;
            let shown = mentions.iter().filter(|mention| {
                mention.frame < frames
                    && text.get(mention.span[0]..mention.span[1]).is_some_and(|words| !words.is_empty())
            });
            let parts = [span(), span()].map(|span| InstructionPart { span, frames: [0, 9], confidence: None });
            let marks = TextMarks { parts: &parts, ..marks(&mentions, &flaws) };
            let segments = cut_segments(text, marks, frames);
            assert_eq!(segments.iter().map(|part| part.text).collect::<String>(), *text);
            assert_eq!(segments.iter().map(|part| part.ends.len()).sum::<usize>(), shown.count());
            for part in &segments {
                assert!(part.mention.is_none_or(|mention| text[mention.span[0]..mention.span[1]].contains(part.text)));
            }
        }
    }
}
