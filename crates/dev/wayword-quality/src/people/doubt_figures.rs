//! Compares the words that `check` calls doubtful with spans that people labelled and corrected.

use crate::share::{ClusteredShare, aligned_table, share_cell};
use serde::Serialize;
use wayword_core::{DoubtCause, DoubtGrade, TextDoubt, doubt::spans_overlap};
use wayword_formats::hear_annotations::{LabelledSpan, LabelledText};
use wayword_language::text::split_blanks;

/// A labelled text with the doubts of `check`.
pub(super) struct LabelledDoubts<'a> {
    pub(super) text: &'a LabelledText,
    pub(super) doubts: &'a [TextDoubt],
}

/// The figures of the doubts of one grade, of both, or of one cause.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct DoubtedSpanRow {
    pub(super) name: &'static str,
    /// Of the wrong spans, those that a doubt overlaps.
    pub(super) wrong: Option<ClusteredShare>,
    /// Of the right spans, those that a doubt overlaps.
    pub(super) right: Option<ClusteredShare>,
    /// Of the doubts that overlap a labelled span, those that overlap a wrong one.
    pub(super) precision: Option<ClusteredShare>,
    /// Of the wrong spans that a doubt overlaps, those for which it offers the correction that people made.
    pub(super) corrected: Option<ClusteredShare>,
    /// Of all words, those that are doubted.
    pub(super) words: Option<ClusteredShare>,
}

/// A row for each grade, one for both grades, and one for each cause.
pub(super) fn doubt_rows(texts: &[LabelledDoubts<'_>], seed: u64) -> Vec<DoubtedSpanRow> {
    let of_grade = DoubtGrade::ALL.map(|grade| doubt_row(grade.name(), texts, &|doubt| doubt.grade == grade, seed));
    let of_cause = DoubtCause::ALL.map(|cause| doubt_row(cause.name(), texts, &|doubt| doubt.cause == cause, seed));
    of_grade.into_iter().chain([doubt_row("both", texts, &|_| true, seed)]).chain(of_cause).collect()
}

/// The figures of the doubts that `counts` accepts.
fn doubt_row(
    name: &'static str,
    texts: &[LabelledDoubts<'_>],
    counts: &dyn Fn(&TextDoubt) -> bool,
    seed: u64,
) -> DoubtedSpanRow {
    let about = |labelled: &LabelledDoubts<'_>, span: [usize; 2]| -> Vec<TextDoubt> {
        labelled.doubts.iter().filter(|doubt| counts(doubt) && spans_overlap(doubt.span, span)).cloned().collect()
    };
    let spans = |right: bool| {
        let of_text = move |labelled: &LabelledDoubts<'_>| -> Vec<(String, bool)> {
            let spans = labelled.text.spans.iter().filter(move |span| span.is_right == right);
            spans.map(|span| (labelled.text.name.clone(), !about(labelled, span.span).is_empty())).collect()
        };
        ClusteredShare::from_cases(texts.iter().flat_map(of_text), seed)
    };
    let corrected = texts.iter().flat_map(|labelled| {
        let wrong = labelled.text.spans.iter().filter(|span| !span.is_right);
        let doubted = wrong.map(|span| (span, about(labelled, span.span))).filter(|(_, doubts)| !doubts.is_empty());
        let offered = |doubts: &[TextDoubt], span: &LabelledSpan| {
            doubts.iter().any(|doubt| offers_correction(labelled.text, doubt, span))
        };
        doubted.map(|(span, doubts)| (labelled.text.name.clone(), offered(&doubts, span))).collect::<Vec<_>>()
    });
    let judged = texts.iter().flat_map(|labelled| {
        let labels = |doubt: &&TextDoubt| -> Vec<bool> {
            let here = labelled.text.spans.iter().filter(|span| spans_overlap(span.span, doubt.span));
            here.map(|span| span.is_right).collect()
        };
        let doubts = labelled.doubts.iter().filter(|doubt| counts(doubt));
        let judged = doubts.map(|doubt| labels(&doubt)).filter(|labels| !labels.is_empty());
        judged.map(|labels| (labelled.text.name.clone(), labels.contains(&false))).collect::<Vec<_>>()
    });
    let words = texts.iter().flat_map(|labelled| {
        let text = labelled.text.text.as_str();
        let words = split_blanks(text).filter(|place| text[place[0]..place[1]].contains(char::is_alphanumeric));
        words.map(|word| (labelled.text.name.clone(), !about(labelled, word).is_empty())).collect::<Vec<_>>()
    });
    DoubtedSpanRow {
        name,
        wrong: spans(false),
        right: spans(true),
        precision: ClusteredShare::from_cases(judged, seed),
        corrected: ClusteredShare::from_cases(corrected, seed),
        words: ClusteredShare::from_cases(words, seed),
    }
}

/// Whether a doubt offers people's correction of a span: a change to the same text, or to leave out the whole span.
fn offers_correction(text: &LabelledText, doubt: &TextDoubt, span: &LabelledSpan) -> bool {
    let covers = doubt.span[0] <= span.span[0] && span.span[1] <= doubt.span[1];
    let text_with = |span: [usize; 2], words: &str| {
        let (before, after) = (text.text.get(..span[0])?, text.text.get(span[1]..)?);
        let changed = format!("{before}{words}{after}").to_lowercase();
        Some(changed.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    };
    let is_offered = |correction: &Option<String>| {
        doubt.alternatives.iter().any(|alternative| match (&alternative.words, correction) {
            (None, None) => covers,
            (Some(words), Some(corrected)) => text_with(doubt.span, words) == text_with(span.span, corrected),
            _ => false,
        })
    };
    span.corrections.iter().any(is_offered)
}

pub(super) fn doubt_table(rows: &[DoubtedSpanRow]) -> String {
    let head = ["doubtful", "wrong spans", "right spans", "precision of doubts", "offers people's words", "words"];
    let line = |row: &DoubtedSpanRow| {
        let shares = [&row.wrong, &row.right, &row.precision, &row.corrected, &row.words];
        let shares = shares.into_iter().map(|share| share_cell(share.as_ref()));
        [row.name.to_owned()].into_iter().chain(shares).collect()
    };
    let lines: Vec<Vec<String>> = [head.map(str::to_owned).to_vec()].into_iter().chain(rows.iter().map(line)).collect();
    aligned_table(&lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{DoubtAlternative, SceneId};
    use wayword_formats::Episode;

    fn text() -> LabelledText {
        let span = |key: &str, span, is_right, told: Option<&str>| LabelledSpan {
            key: key.into(),
            span,
            is_right,
            corrections: vec![told.map(str::to_owned)],
        };
        LabelledText {
            name: "t".into(),
            episode: Episode::new("t", "t", SceneId::new("s").unwrap()),
            text: "turn left . walk on .".into(),
            spans: vec![span("0-1", [0, 9], false, Some("turn right")), span("3-4", [12, 19], true, Some("walk on"))],
        }
    }

    fn doubt(span: [usize; 2], words: Option<&str>) -> TextDoubt {
        let alternatives = vec![DoubtAlternative { words: words.map(str::to_owned), gain: None }];
        TextDoubt { span, grade: DoubtGrade::Likely, cause: DoubtCause::Change, reason: String::new(), alternatives }
    }

    #[test]
    fn a_doubt_offers_people_s_words_whatever_the_ends_of_its_span() {
        let text = text();
        assert!(offers_correction(&text, &doubt([5, 9], Some("Right")), &text.spans[0]));
        assert!(!offers_correction(&text, &doubt([5, 9], Some("around")), &text.spans[0]));
        assert!(!offers_correction(&text, &doubt([0, 9], None), &text.spans[0]));
        let left_out = LabelledSpan { corrections: vec![None], ..text.spans[0].clone() };
        assert!(offers_correction(&text, &doubt([0, 9], None), &left_out));
        assert!(!offers_correction(&text, &doubt([5, 9], None), &left_out), "it leaves out only a part");
    }

    #[test]
    fn spans_words_and_corrections_are_counted_by_grade() {
        let text = text();
        let doubts = [doubt([5, 9], Some("right"))];
        let rows = doubt_rows(&[LabelledDoubts { text: &text, doubts: &doubts }], 0);
        let count = |share: &Option<ClusteredShare>| share.map(|share| (share.count, share.of));
        let likely = &rows[0];
        assert_eq!((count(&likely.wrong), count(&likely.right)), (Some((1, 1)), Some((0, 1))));
        assert_eq!((count(&likely.precision), count(&likely.corrected)), (Some((1, 1)), Some((1, 1))));
        assert_eq!(count(&likely.words), Some((1, 4)));
        assert_eq!(count(&rows[1].wrong), Some((0, 1)));
        assert_eq!(rows[2].wrong, likely.wrong);
    }
}
