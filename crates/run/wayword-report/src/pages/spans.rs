//! Cuts a text where its mentions begin and end, so that each segment can become a link.
//!
//! Spans come from files that anyone may have written: they may overlap, be outside the text or cut a character in two.

use std::collections::BTreeSet;
use wayword_core::{CheckFinding, TextMention, Verdict};

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
    /// Whether a failed check is about it.
    pub(super) is_flawed: bool,
}

/// Cuts a text into segments. Mentions with a span or frame that does not exist are left out.
pub(super) fn cut_segments<'a>(
    text: &'a str,
    mentions: &'a [TextMention],
    findings: &[CheckFinding],
    frames: usize,
) -> Vec<TextSegment<'a>> {
    let fits = |span: [usize; 2]| text.get(span[0]..span[1]).is_some_and(|words| !words.is_empty());
    let mentions: Vec<&TextMention> =
        mentions.iter().filter(|mention| fits(mention.span) && mention.frame < frames).take(MAX_MARKED_SPANS).collect();
    let flaws = findings.iter().filter(|finding| finding.verdict == Verdict::Fail).filter_map(|finding| finding.span);
    let flaws: Vec<[usize; 2]> = flaws.filter(|span| fits(*span)).take(MAX_MARKED_SPANS).collect();
    let spans = mentions.iter().map(|mention| mention.span).chain(flaws.iter().copied());
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

    #[test]
    fn words_are_cut_out_with_their_frames() {
        let mentions = [mention([5, 9], 1), mention([15, 19], 2)];
        let segments = cut_segments("Pass sofa, the door.", &mentions, &[], 3);
        let told: Vec<_> = segments.iter().map(|part| (part.text, part.mention.map(|mention| mention.frame))).collect();
        assert_eq!(told, [("Pass ", None), ("sofa", Some(1)), (", the ", None), ("door", Some(2)), (".", None)]);
    }

    #[test]
    fn of_overlapping_mentions_each_ends_once_and_the_shorter_one_covers() {
        let mentions = [mention([0, 10], 0), mention([4, 6], 1)];
        let segments = cut_segments("0123456789", &mentions, &[], 2);
        let told: Vec<_> = segments
            .iter()
            .map(|part| (part.text, part.mention.map(|mention| mention.frame), part.ends.len()))
            .collect();
        assert_eq!(told, [("0123", Some(0), 0), ("45", Some(1), 1), ("6789", Some(0), 1)]);
    }

    #[test]
    fn a_flaw_is_marked() {
        let segments = cut_segments("turn left now", &[], &[flaw([0, 9])], 1);
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
            let segments = cut_segments(text, &mentions, &flaws, frames);
            assert_eq!(segments.iter().map(|part| part.text).collect::<String>(), *text);
            assert_eq!(segments.iter().map(|part| part.ends.len()).sum::<usize>(), shown.count());
            for part in &segments {
                assert!(part.mention.is_none_or(|mention| text[mention.span[0]..mention.span[1]].contains(part.text)));
            }
        }
    }
}
