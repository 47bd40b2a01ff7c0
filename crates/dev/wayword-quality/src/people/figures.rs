//! Recall, false alarms and precision of the findings of `check`, by spans that people labelled.

use super::kinds::SpanTopic;
use crate::{checked_texts::is_about, share::ClusteredShare};
use serde::Serialize;
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_formats::hear_annotations::{LabelledSpan, LabelledText};

/// A labelled text with the findings of `check`.
pub(super) struct LabelledFindings<'a> {
    pub(super) text: &'a LabelledText,
    pub(super) findings: &'a [CheckFinding],
}

/// The figures of one check, of one kind of span, or of all.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct CheckedSpanRow {
    pub(super) name: String,
    /// Of the wrong spans, those that a "fail" overlaps.
    pub(super) recall: Option<ClusteredShare>,
    /// Of the right spans, those that a "fail" overlaps.
    pub(super) false_alarms: Option<ClusteredShare>,
    /// Of the findings "fail" that overlap a labelled span, those that overlap a wrong one.
    pub(super) precision: Option<ClusteredShare>,
    /// Of the wrong spans, those that an "unverified" overlaps, and no "fail".
    pub(super) unverified_wrong: Option<ClusteredShare>,
    /// Of the right spans, those that an "unverified" overlaps, and no "fail".
    pub(super) unverified_right: Option<ClusteredShare>,
    /// Findings "fail" that overlap no labelled span, or name no words.
    pub(super) elsewhere: usize,
}

/// All figures.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct SpanFigures {
    pub(super) all: CheckedSpanRow,
    /// A row for each check: all spans, with only the findings of that check.
    pub(super) by_check: Vec<CheckedSpanRow>,
    /// A row for each kind of span: all findings, with only the spans of that kind.
    pub(super) by_kind: Vec<CheckedSpanRow>,
    /// Of the texts with a wrong span, those that fail.
    pub(super) wrong_texts_that_fail: Option<ClusteredShare>,
    /// Of the texts without one, those that fail.
    pub(super) right_texts_that_fail: Option<ClusteredShare>,
}

/// The findings and spans that a row counts: `None` takes all of them.
#[derive(Clone, Copy)]
struct SpanSelection {
    check: Option<CheckKind>,
    kind: Option<SpanTopic>,
}

/// All figures of some labelled texts.
pub(super) fn span_figures(texts: &[LabelledFindings<'_>], seed: u64) -> SpanFigures {
    let used = |check: &CheckKind| {
        texts.iter().any(|labelled| labelled.findings.iter().any(|finding| finding.check == *check))
    };
    let row = |name: &str, check, kind| span_row(name, texts, SpanSelection { check, kind }, seed);
    let fails = |wrong: bool| {
        let texts = texts.iter().filter(|labelled| labelled.text.spans.iter().any(|span| !span.is_right) == wrong);
        ClusteredShare::from_cases(
            texts.map(|labelled| (&labelled.text.name, labelled.findings.iter().any(is_fail))),
            seed,
        )
    };
    SpanFigures {
        all: row("all", None, None),
        by_check: CheckKind::ALL.into_iter().filter(used).map(|check| row(check.name(), Some(check), None)).collect(),
        by_kind: SpanTopic::ALL.into_iter().map(|kind| row(kind.name(), None, Some(kind))).collect(),
        wrong_texts_that_fail: fails(true),
        right_texts_that_fail: fails(false),
    }
}

/// The figures of the findings and spans that `part` selects.
fn span_row(name: &str, texts: &[LabelledFindings<'_>], part: SpanSelection, seed: u64) -> CheckedSpanRow {
    let spans = |right: bool, verdict: Verdict| {
        let cases = texts.iter().flat_map(|labelled| {
            let spans = part.selected_spans(labelled).filter(move |span| span.is_right == right);
            spans.map(|span| (&labelled.text.name, part.worst_verdict(labelled, span) == Some(verdict)))
        });
        ClusteredShare::from_cases(cases, seed)
    };
    let fails = || {
        texts.iter().flat_map(|labelled| {
            part.selected_findings(labelled).filter(|found| is_fail(found)).map(move |found| (labelled, found))
        })
    };
    let labels = |labelled: &LabelledFindings<'_>, found: &CheckFinding| -> Vec<bool> {
        let overlapped = |span: &&LabelledSpan| is_about(found, span.span);
        // A finding belongs to a kind if it overlaps a span of that kind. All spans that it overlaps then decide whether it is right.
        let is_here = part.selected_spans(labelled).any(|span| overlapped(&span));
        labelled.text.spans.iter().filter(|_| is_here).filter(overlapped).map(|span| span.is_right).collect()
    };
    let judged = fails().map(|(labelled, found)| (&labelled.text.name, labels(labelled, found)));
    let on_labels = judged.filter(|(_, labels)| !labels.is_empty());
    CheckedSpanRow {
        name: name.to_owned(),
        recall: spans(false, Verdict::Fail),
        false_alarms: spans(true, Verdict::Fail),
        precision: ClusteredShare::from_cases(on_labels.map(|(text, labels)| (text, labels.contains(&false))), seed),
        unverified_wrong: spans(false, Verdict::Unverified),
        unverified_right: spans(true, Verdict::Unverified),
        elsewhere: fails().filter(|(labelled, found)| labels(labelled, found).is_empty()).count(),
    }
}

impl SpanSelection {
    /// The spans of a text that count.
    fn selected_spans<'h>(self, labelled: &'h LabelledFindings<'_>) -> impl Iterator<Item = &'h LabelledSpan> {
        let is_selected = move |span: &&LabelledSpan| {
            let words = labelled.text.text.get(span.span[0]..span.span[1]).unwrap_or_default();
            self.kind.is_none_or(|kind| kind == SpanTopic::for_span(words))
        };
        labelled.text.spans.iter().filter(is_selected)
    }

    /// The findings in a text that count.
    fn selected_findings<'h>(self, labelled: &'h LabelledFindings<'_>) -> impl Iterator<Item = &'h CheckFinding> {
        labelled.findings.iter().filter(move |finding| self.check.is_none_or(|check| check == finding.check))
    }

    /// The worst verdict on a span; `None` where no finding is about it.
    fn worst_verdict(self, labelled: &LabelledFindings<'_>, span: &LabelledSpan) -> Option<Verdict> {
        self.selected_findings(labelled)
            .filter(|finding| is_about(finding, span.span))
            .map(|finding| finding.verdict)
            .max()
    }
}

pub(super) fn is_fail(finding: &CheckFinding) -> bool {
    finding.verdict == Verdict::Fail
}
