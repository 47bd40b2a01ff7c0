//! What speaks against a text: its verdict, its findings, what it may mean, and a second check. A report shows the texts that are
//! most likely wrong first.

use super::item_record::TextState;
use serde::Serialize;
use wayword_core::{CheckFinding, DoubtCause, DoubtGrade, FailureKind, TextAmbiguity, TextDoubt, Verdict};
use wayword_run::{check::SecondCheck, run_folder::RejectedText};

/// Most signs of a text in the list.
const MAX_LISTED_SIGNS: usize = 4;

/// What speaks against a text.
#[derive(Debug, Clone)]
pub(super) struct TextSuspicion {
    pub(super) state: TextState,
    /// Claims that no evidence decides.
    pub(super) unverified: usize,
    /// Whether it may mean several places or objects.
    pub(super) is_ambiguous: bool,
    /// Whether it has words that the follower doubts.
    pub(super) is_doubtful: bool,
    /// Whether somebody changed it after the run.
    pub(super) is_changed: bool,
    /// The rank in the list: the higher, the more likely the text is wrong.
    pub(super) score: u32,
    /// What a reader should look at, the worst first.
    pub(super) signs: Vec<SuspicionSign>,
}

/// Something that speaks against a text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct SuspicionSign {
    /// Its colour: `bad` or `open`.
    pub(super) class: &'static str,
    pub(super) words: String,
    /// The words of the text that it is about.
    #[serde(skip)]
    pub(super) span: Option<[usize; 2]>,
}

/// The class of a text in the list. Its last three digits are for the rank within the class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum SuspicionClass {
    Passed = 0,
    Uncertain = 1000,
    Ambiguous = 2000,
    Unwritten = 3000,
    Unverified = 4000,
    Likely = 5000,
    Rejected = 6000,
    Failed = 7000,
    Changed = 8000,
    Wrong = 9000,
}

impl SuspicionClass {
    fn score(self, within: f64) -> u32 {
        self as u32 + within.clamp(0.0, 999.0) as u32
    }
}

/// The score of an item without a text.
pub(super) fn unwritten_score() -> u32 {
    SuspicionClass::Unwritten.score(0.0)
}

/// The score of an item that failed.
pub(super) fn failed_score(failure: FailureKind) -> u32 {
    SuspicionClass::Failed.score(if failure == FailureKind::Lost { 0.0 } else { 1.0 })
}

impl TextSuspicion {
    /// Of an accepted text, with the result of a second check.
    pub(super) fn of_accepted(
        (text, verdict, findings): (&str, Verdict, &[CheckFinding]),
        ambiguity: Option<&TextAmbiguity>,
        second: SecondCheck<'_>,
    ) -> Self {
        let findings = current_findings(verdict, findings, second);
        let ambiguity = match second.text {
            Some(again) if second.is_changed => again.ambiguity.as_ref(),
            again => again.and_then(|again| again.ambiguity.as_ref()).or(ambiguity),
        };
        let doubts = second.text.and_then(|again| again.doubted.as_ref()).map_or(&[][..], |doubted| &doubted.doubts);
        let state = match (verdict, second.text) {
            _ if fails_now(verdict, second) => TextState::Wrong,
            (_, Some(again)) if second.is_changed && again.verdict == Verdict::Pass => TextState::Passed,
            _ if second.is_changed => TextState::Unverified,
            (Verdict::Fail, _) => TextState::Wrong,
            (Verdict::Unverified, _) => TextState::Unverified,
            // "Passed" does not stand over a claim that nothing decides.
            (Verdict::Pass, _) if findings.iter().any(is_unverified) => TextState::Unverified,
            (Verdict::Pass, _) => TextState::Passed,
        };
        let meanings = ambiguity.filter(|ambiguity| ambiguity.is_ambiguous());
        let doubts: Vec<&TextDoubt> = doubts.iter().filter(|doubt| is_of_follower(doubt, findings)).collect();
        let likely = best_gain(&doubts, DoubtGrade::Likely);
        let uncertain = best_gain(&doubts, DoubtGrade::Uncertain);
        let unverified = findings.iter().filter(|finding| is_unverified(finding)).count();
        let failed = findings.iter().filter(|finding| finding.verdict == Verdict::Fail).count();
        let ends = meanings.map(|ambiguity| ambiguity.ends.unwrap_or(0).max(ambiguity.objects));
        let scores = [
            (state == TextState::Wrong)
                .then(|| SuspicionClass::Wrong.score(10.0 * failed as f64 + likely.unwrap_or(0.0))),
            second.is_changed.then(|| SuspicionClass::Changed.score(likely.or(uncertain).unwrap_or(0.0))),
            likely.map(|gain| SuspicionClass::Likely.score(100.0 * gain)),
            (state == TextState::Unverified).then(|| SuspicionClass::Unverified.score(unverified as f64)),
            ends.map(|ends| SuspicionClass::Ambiguous.score(10.0 * ends as f64 + uncertain.unwrap_or(0.0))),
            uncertain.map(|gain| SuspicionClass::Uncertain.score(100.0 * gain)),
        ];
        Self {
            state,
            unverified,
            is_ambiguous: meanings.is_some(),
            is_doubtful: likely.or(uncertain).is_some(),
            score: scores.into_iter().flatten().max().unwrap_or(SuspicionClass::Passed.score(0.0)),
            is_changed: second.is_changed,
            signs: change_sign(second).into_iter().chain(list_signs(text, findings, &doubts, meanings)).collect(),
        }
    }

    /// Of a text that was rejected.
    pub(super) fn of_rejected(rejected: &RejectedText) -> Self {
        let reason = if rejected.reason.is_empty() { "no reason was kept" } else { &rejected.reason };
        let findings = rejected.last.as_ref().map_or(&[][..], |last| &last.findings);
        let spans =
            findings.iter().filter(|finding| finding.verdict == Verdict::Fail).filter_map(|finding| finding.span);
        let mut signs = vec![SuspicionSign { class: "bad", words: reason.to_owned(), span: None }];
        // They mark words of the text, and their reasons are part of the reason above.
        signs.extend(spans.map(|span| SuspicionSign { class: "bad", words: String::new(), span: Some(span) }));
        Self {
            state: TextState::Rejected,
            unverified: 0,
            is_ambiguous: false,
            is_doubtful: false,
            is_changed: false,
            score: SuspicionClass::Rejected.score(0.0),
            signs,
        }
    }

    /// Whether a person should look at the text.
    pub(super) fn needs_look(&self) -> bool {
        self.state != TextState::Passed || self.is_ambiguous || self.is_doubtful || self.is_changed
    }
}

/// Whether a text fails when it is checked again, and did not when it was written.
pub(super) fn fails_now(verdict: Verdict, second: SecondCheck<'_>) -> bool {
    let fails = second.text.is_some_and(|again| again.verdict == Verdict::Fail);
    fails && (verdict != Verdict::Fail || second.is_changed)
}

/// The findings about a text as it is now: those of the run are about other words if it was changed.
pub(super) fn current_findings<'f>(
    verdict: Verdict,
    of_run: &'f [CheckFinding],
    second: SecondCheck<'f>,
) -> &'f [CheckFinding] {
    match second.text {
        Some(again) if second.is_changed || fails_now(verdict, second) => &again.findings,
        None if second.is_changed => &[],
        _ => of_run,
    }
}

fn change_sign(second: SecondCheck<'_>) -> Option<SuspicionSign> {
    let checked = if second.text.is_some() { "checked again" } else { "not checked again" };
    let words = format!("changed after the run; {checked}");
    second.is_changed.then_some(SuspicionSign { class: "bad", words, span: None })
}

fn is_unverified(finding: &CheckFinding) -> bool {
    finding.verdict == Verdict::Unverified
}

/// Whether a doubt tells more than the findings and the ambiguity, which are shown anyway.
fn is_of_follower(doubt: &TextDoubt, findings: &[CheckFinding]) -> bool {
    let is_told =
        || findings.iter().any(|finding| finding.span == Some(doubt.span) && finding.verdict != Verdict::Pass);
    match doubt.cause {
        DoubtCause::Change => true,
        DoubtCause::Wrong => !doubt.alternatives.is_empty() || !is_told(),
        DoubtCause::Ambiguous | DoubtCause::Unverified => false,
    }
}

/// How much better the best other words would fit, of the doubts of this grade; `None` without such a doubt.
fn best_gain(doubts: &[&TextDoubt], grade: DoubtGrade) -> Option<f64> {
    doubts.iter().filter(|doubt| doubt.grade == grade).map(|doubt| doubt.best_gain()).reduce(f64::max)
}

fn list_signs(
    text: &str,
    findings: &[CheckFinding],
    doubts: &[&TextDoubt],
    meanings: Option<&TextAmbiguity>,
) -> Vec<SuspicionSign> {
    let of_findings = |verdict, class| {
        findings.iter().filter(move |finding| finding.verdict == verdict).map(move |finding| {
            let unverified = if verdict == Verdict::Unverified { " unverified" } else { "" };
            let reason = if finding.reason.is_empty() { String::new() } else { format!(": {}", finding.reason) };
            let words = format!("{}{unverified}{reason}", finding.check.name());
            SuspicionSign { class, words, span: finding.span }
        })
    };
    let of_doubts = |grade| {
        doubts.iter().filter(move |doubt| doubt.grade == grade).map(move |doubt| SuspicionSign {
            class: if grade == DoubtGrade::Likely { "bad" } else { "open" },
            words: describe_doubt(text, doubt),
            span: Some(doubt.span),
        })
    };
    let of_meanings =
        meanings.and_then(TextAmbiguity::to_sentence).map(|words| SuspicionSign { class: "open", words, span: None });
    of_findings(Verdict::Fail, "bad")
        .chain(of_doubts(DoubtGrade::Likely))
        .chain(of_findings(Verdict::Unverified, "open"))
        .chain(of_meanings)
        .chain(of_doubts(DoubtGrade::Uncertain))
        .take(MAX_LISTED_SIGNS)
        .collect()
}

/// A doubt in words: which words, how much they are doubted, and what may stand there instead.
pub(super) fn describe_doubt(text: &str, doubt: &TextDoubt) -> String {
    let words = text.get(doubt.span[0]..doubt.span[1]).unwrap_or_default();
    let instead: Vec<String> = doubt
        .alternatives
        .iter()
        .map(|other| other.words.as_ref().map_or_else(|| "leave it out".to_owned(), |words| format!("“{words}”")))
        .collect();
    let instead = if instead.is_empty() { String::new() } else { format!("; instead: {}", instead.join(" or ")) };
    format!("“{words}” {}{instead}", doubt.grade.reader_label())
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{CheckKind, DoubtAlternative};
    use wayword_run::check::CheckedText;

    fn finding(verdict: Verdict) -> CheckFinding {
        CheckFinding { check: CheckKind::Turns, verdict, reason: "the path turns right".into(), span: Some([5, 9]) }
    }

    fn again(verdict: Verdict, findings: Vec<CheckFinding>, doubts: Vec<TextDoubt>) -> CheckedText {
        CheckedText {
            path: "a".into(),
            name: "a".into(),
            text: String::new(),
            verdict,
            world: "closed",
            findings,
            route: None,
            turn_gain: None,
            ambiguity: None,
            parts: Vec::new(),
            coverage_of_walk: Vec::new(),
            doubted: Some(wayword_run::doubts::TextDoubts { doubts, unfollowed: None }),
            style: None,
        }
    }

    fn doubt(grade: DoubtGrade, gain: f64) -> TextDoubt {
        let alternatives = vec![DoubtAlternative { words: Some("right".into()), gain: Some(gain) }];
        TextDoubt { span: [5, 9], grade, cause: DoubtCause::Change, reason: String::new(), alternatives }
    }

    fn suspicion(verdict: Verdict, findings: &[CheckFinding], again: Option<&CheckedText>) -> TextSuspicion {
        let second = SecondCheck { text: again, is_changed: false };
        TextSuspicion::of_accepted(("Turn left.", verdict, findings), None, second)
    }

    #[test]
    fn a_changed_text_keeps_nothing_of_its_old_verdict() {
        let passed = again(Verdict::Pass, Vec::new(), Vec::new());
        let changed = |text| {
            let second = SecondCheck { text, is_changed: true };
            TextSuspicion::of_accepted(("Turn left.", Verdict::Pass, &[finding(Verdict::Pass)]), None, second)
        };
        let (checked, unchecked) = (changed(Some(&passed)), changed(None));
        assert_eq!((checked.state, unchecked.state), (TextState::Passed, TextState::Unverified));
        assert_eq!(checked.signs[0].words, "changed after the run; checked again");
        assert_eq!(unchecked.signs[0].words, "changed after the run; not checked again");
        let wrong = again(Verdict::Fail, vec![finding(Verdict::Fail)], Vec::new());
        assert!(changed(Some(&wrong)).score > checked.score && unchecked.needs_look());
        assert!(checked.score > suspicion(Verdict::Unverified, &[finding(Verdict::Unverified)], None).score);
    }

    #[test]
    fn what_fails_now_comes_before_what_is_doubted_unverified_and_passed() {
        let wrong = again(Verdict::Fail, vec![finding(Verdict::Fail)], Vec::new());
        let doubted = again(Verdict::Pass, Vec::new(), vec![doubt(DoubtGrade::Likely, 3.0)]);
        let unsure = again(Verdict::Pass, Vec::new(), vec![doubt(DoubtGrade::Uncertain, 0.1)]);
        let all = [
            suspicion(Verdict::Pass, &[], Some(&wrong)),
            suspicion(Verdict::Pass, &[], Some(&doubted)),
            suspicion(Verdict::Unverified, &[finding(Verdict::Unverified)], None),
            suspicion(Verdict::Pass, &[], Some(&unsure)),
            suspicion(Verdict::Pass, &[finding(Verdict::Pass)], None),
        ];
        assert!(all.windows(2).all(|pair| pair[0].score > pair[1].score), "{all:?}");
        assert_eq!(all.iter().map(TextSuspicion::needs_look).collect::<Vec<_>>(), [true, true, true, true, false]);
        assert_eq!((all[0].state, &*all[0].signs[0].words), (TextState::Wrong, "turns: the path turns right"));
        assert_eq!(all[1].signs[0].words, "“left” likely wrong; instead: “right”");
    }

    #[test]
    fn passed_does_not_stand_over_an_unverified_claim() {
        let text = suspicion(Verdict::Pass, &[finding(Verdict::Pass), finding(Verdict::Unverified)], None);
        assert_eq!((text.state, text.unverified), (TextState::Unverified, 1));
    }

    #[test]
    fn a_second_check_that_passes_changes_nothing() {
        let passed = again(Verdict::Unverified, vec![finding(Verdict::Unverified)], Vec::new());
        let text = suspicion(Verdict::Pass, &[], Some(&passed));
        assert_eq!((text.state, text.score, text.signs.len()), (TextState::Passed, 0, 0));
    }
}
