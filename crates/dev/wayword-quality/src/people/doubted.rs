//! Compares the words that `check` calls doubtful with spans that people labelled and corrected.

use crate::share::{Share, cell, table};
use serde::Serialize;
use wayword_core::{Cause, Doubt, Grade, doubt::overlap};
use wayword_formats::hear::{LabelledSpan, LabelledText};
use wayword_language::text::pieces;

/// A labelled text with the doubts of `check`.
pub(super) struct Doubted<'a> {
    pub(super) text: &'a LabelledText,
    pub(super) doubts: &'a [Doubt],
}

/// The figures of the doubts of one grade, of both, or of one cause.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Row {
    pub(super) name: &'static str,
    /// Of the wrong spans, those that a doubt overlaps.
    pub(super) wrong: Option<Share>,
    /// Of the right spans, those that a doubt overlaps.
    pub(super) right: Option<Share>,
    /// Of the doubts that overlap a labelled span, those that overlap a wrong one.
    pub(super) precision: Option<Share>,
    /// Of the wrong spans that a doubt overlaps, those for which it offers the correction that people made.
    pub(super) corrected: Option<Share>,
    /// Of all words, those that are doubted.
    pub(super) words: Option<Share>,
}

pub(super) fn rows(held: &[Doubted<'_>], seed: u64) -> Vec<Row> {
    let of_grade = Grade::ALL.map(|grade| row(grade.name(), held, &|doubt| doubt.grade == grade, seed));
    let of_cause = Cause::ALL.map(|cause| row(cause.name(), held, &|doubt| doubt.cause == cause, seed));
    of_grade.into_iter().chain([row("both", held, &|_| true, seed)]).chain(of_cause).collect()
}

fn row(name: &'static str, held: &[Doubted<'_>], is: &dyn Fn(&Doubt) -> bool, seed: u64) -> Row {
    let about = |held: &Doubted<'_>, span: [usize; 2]| -> Vec<Doubt> {
        held.doubts.iter().filter(|doubt| is(doubt) && overlap(doubt.span, span)).cloned().collect()
    };
    let spans = |right: bool| {
        let of_text = move |held: &Doubted<'_>| -> Vec<(String, bool)> {
            let spans = held.text.spans.iter().filter(move |span| span.is_right == right);
            spans.map(|span| (held.text.name.clone(), !about(held, span.span).is_empty())).collect()
        };
        Share::of(held.iter().flat_map(of_text), seed)
    };
    let corrected = held.iter().flat_map(|held| {
        let wrong = held.text.spans.iter().filter(|span| !span.is_right);
        let doubted = wrong.map(|span| (span, about(held, span.span))).filter(|(_, doubts)| !doubts.is_empty());
        let offered = |doubts: &[Doubt], span: &LabelledSpan| doubts.iter().any(|doubt| offers(held.text, doubt, span));
        doubted.map(|(span, doubts)| (held.text.name.clone(), offered(&doubts, span))).collect::<Vec<_>>()
    });
    let judged = held.iter().flat_map(|held| {
        let labels = |doubt: &&Doubt| -> Vec<bool> {
            let here = held.text.spans.iter().filter(|span| overlap(span.span, doubt.span));
            here.map(|span| span.is_right).collect()
        };
        let doubts = held.doubts.iter().filter(|doubt| is(doubt));
        let judged = doubts.map(|doubt| labels(&doubt)).filter(|labels| !labels.is_empty());
        judged.map(|labels| (held.text.name.clone(), labels.contains(&false))).collect::<Vec<_>>()
    });
    let words = held.iter().flat_map(|held| {
        let text = held.text.text.as_str();
        let words = pieces(text).filter(|place| text[place[0]..place[1]].contains(char::is_alphanumeric));
        words.map(|word| (held.text.name.clone(), !about(held, word).is_empty())).collect::<Vec<_>>()
    });
    Row {
        name,
        wrong: spans(false),
        right: spans(true),
        precision: Share::of(judged, seed),
        corrected: Share::of(corrected, seed),
        words: Share::of(words, seed),
    }
}

/// Whether a doubt offers people's correction of a span: a change to the same text, or to leave out the whole span.
fn offers(text: &LabelledText, doubt: &Doubt, span: &LabelledSpan) -> bool {
    let covers = doubt.span[0] <= span.span[0] && span.span[1] <= doubt.span[1];
    let with = |span: [usize; 2], words: &str| {
        let (before, after) = (text.text.get(..span[0])?, text.text.get(span[1]..)?);
        let changed = format!("{before}{words}{after}").to_lowercase();
        Some(changed.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    };
    let is_offered = |told: &Option<String>| {
        doubt.alternatives.iter().any(|one| match (&one.words, told) {
            (None, None) => covers,
            (Some(words), Some(told)) => with(doubt.span, words) == with(span.span, told),
            _ => false,
        })
    };
    span.corrections.iter().any(is_offered)
}

pub(super) fn shown(rows: &[Row]) -> String {
    let head = ["doubtful", "wrong spans", "right spans", "precision of doubts", "offers people's words", "words"];
    let line = |row: &Row| {
        let shares = [&row.wrong, &row.right, &row.precision, &row.corrected, &row.words];
        let shares = shares.into_iter().map(|share| cell(share.as_ref()));
        [row.name.to_owned()].into_iter().chain(shares).collect()
    };
    let lines: Vec<Vec<String>> = [head.map(str::to_owned).to_vec()].into_iter().chain(rows.iter().map(line)).collect();
    table(&lines)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{Alternative, SceneId};
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

    fn doubt(span: [usize; 2], words: Option<&str>) -> Doubt {
        let alternatives = vec![Alternative { words: words.map(str::to_owned), gain: None }];
        Doubt { span, grade: Grade::Likely, cause: Cause::Change, reason: String::new(), alternatives }
    }

    #[test]
    fn a_doubt_offers_people_s_words_whatever_the_ends_of_its_span() {
        let text = text();
        assert!(offers(&text, &doubt([5, 9], Some("Right")), &text.spans[0]));
        assert!(!offers(&text, &doubt([5, 9], Some("around")), &text.spans[0]));
        assert!(!offers(&text, &doubt([0, 9], None), &text.spans[0]));
        let left_out = LabelledSpan { corrections: vec![None], ..text.spans[0].clone() };
        assert!(offers(&text, &doubt([0, 9], None), &left_out));
        assert!(!offers(&text, &doubt([5, 9], None), &left_out), "it leaves out only a part");
    }

    #[test]
    fn spans_words_and_corrections_are_counted_by_grade() {
        let text = text();
        let doubts = [doubt([5, 9], Some("right"))];
        let rows = rows(&[Doubted { text: &text, doubts: &doubts }], 0);
        let count = |share: &Option<Share>| share.map(|share| (share.count, share.of));
        let likely = &rows[0];
        assert_eq!((count(&likely.wrong), count(&likely.right)), (Some((1, 1)), Some((0, 1))));
        assert_eq!((count(&likely.precision), count(&likely.corrected)), (Some((1, 1)), Some((1, 1))));
        assert_eq!(count(&likely.words), Some((1, 4)));
        assert_eq!(count(&rows[1].wrong), Some((0, 1)));
        assert_eq!(rows[2].wrong, likely.wrong);
    }
}
