//! Makes doubts of the findings of checks, and of the ambiguity of a text.

use crate::guide::Guide;
use wayword_core::{
    CheckFinding, CheckKind, DoubtAlternative, DoubtCause, DoubtGrade, TextAmbiguity, TextDoubt, Verdict,
};
use wayword_language::{
    lexicon::{is_room, names_agree},
    reading::TextReading,
    rewording::TokenisedText,
};

/// The doubts from the findings of checks. Findings about form, copying and unknown words are left out, because they do
/// not concern the path.
#[must_use]
pub fn doubts_from_findings(findings: &[CheckFinding]) -> Vec<TextDoubt> {
    let doubt = |finding: &CheckFinding| {
        let (grade, cause) = match finding.verdict {
            Verdict::Pass => return None,
            Verdict::Unverified => (DoubtGrade::Uncertain, DoubtCause::Unverified),
            Verdict::Fail => (DoubtGrade::Likely, DoubtCause::Wrong),
        };
        let concerns_path = !matches!(finding.check, CheckKind::Form | CheckKind::Leak | CheckKind::Coverage);
        let span = finding.span.filter(|_| concerns_path)?;
        Some(TextDoubt { span, grade, cause, reason: finding.reason.clone(), alternatives: Vec::new() })
    };
    findings.iter().filter_map(doubt).collect()
}

/// The doubts about a text that may mean several places or objects: at its end, and at the object of its task.
#[must_use]
pub fn doubts_from_ambiguity(
    text: &str,
    guide: &Guide,
    reading: &TextReading,
    ambiguity: &TextAmbiguity,
) -> Vec<TextDoubt> {
    let doubt = |span, reason, alternatives| TextDoubt {
        span,
        grade: DoubtGrade::Uncertain,
        cause: DoubtCause::Ambiguous,
        reason,
        alternatives,
    };
    let mut doubts = Vec::new();
    let spelt = TokenisedText::from_reading(text, reading);
    if let Some((ends, span)) = ambiguity.ends.filter(|ends| *ends > 1).zip(end_words(&spelt, guide)) {
        let apart = ambiguity.told_apart_by.as_deref().zip(text.get(span[0]..span[1]));
        // "The stairs by the stairs".
        let apart = apart.filter(|(by, words)| !names_agree(by, words));
        let apart = apart.map(|(by, words)| {
            let joined = if is_room(by) { "in" } else { "by" };
            DoubtAlternative { words: Some(format!("{words} {joined} the {by}")), gain: None }
        });
        doubts.push(doubt(span, format!("the text may end at {ends} places"), apart.into_iter().collect()));
    }
    let object = reading.task.as_ref().and_then(|task| reading.events.get(task.object?));
    if let Some(object) = object.filter(|_| ambiguity.objects > 1) {
        let reason = format!("the task may mean {} objects", ambiguity.objects);
        doubts.push(doubt(object.span, reason, Vec::new()));
    }
    doubts
}

/// The words for the end of the walk: the last place of the step that stops, or else that step.
fn end_words(spelt: &TokenisedText<'_>, guide: &Guide) -> Option<[usize; 2]> {
    let stop = guide.steps.iter().rev().find(|step| step.step.stops).or(guide.steps.last())?;
    stop.mentions.iter().rev().find_map(|mention| mention.span).or_else(|| spelt.step_words(stop.step.span))
}
