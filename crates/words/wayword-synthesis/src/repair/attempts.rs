//! Lets one writer write until a text passes, and keeps what it wrote on the way.

use super::{
    CandidateResult, InstructionOrder, WritingOutcome, brief_for_attempt, check_text, has_same_words,
    questions::ask_about_text, text_provenance, unusable_complaint, verdict_on_words,
};
use crate::{
    observe::ObservationRoles,
    writer::{InstructionWriter, RulesWriter, TextComplaint, WriteError},
};
use wayword_core::{CheckFinding, Instruction, ModelError, Verdict, WrittenDraft};

/// The attempts of one writer at one candidate.
pub(super) struct WritingAttempts<'a> {
    pub(super) writer: &'a dyn InstructionWriter,
    pub(super) observers: ObservationRoles<'a>,
    pub(super) order: InstructionOrder<'a>,
    /// The number of the candidate.
    pub(super) candidate: u32,
    /// The texts that failed, with the reasons.
    complaints: Vec<TextComplaint>,
    /// The texts that were not kept.
    pub(super) drafts: Vec<WrittenDraft>,
}

impl<'a> WritingAttempts<'a> {
    pub(super) fn new(
        writer: &'a dyn InstructionWriter,
        observers: ObservationRoles<'a>,
        order: InstructionOrder<'a>,
        candidate: u32,
    ) -> Self {
        Self { writer, observers, order, candidate, complaints: Vec::new(), drafts: Vec::new() }
    }

    /// Writes until a text passes. The drafts stay here.
    ///
    /// # Errors
    /// When a model fails.
    pub(super) fn write_until_good(&mut self) -> CandidateResult {
        let mut least_bad: Option<Instruction> = None;
        for repairs in 0..=self.order.repairs {
            let instruction = match self.write_once(repairs, &[]) {
                Ok(Some(instruction)) => instruction,
                Ok(None) => continue,
                Err(WriteError::Model(error)) => return Err(error),
                Err(no_object) => {
                    let reason = no_object.to_string();
                    return Ok(WritingOutcome::Rejected { last: least_bad, reason, drafts: Vec::new() });
                }
            };
            if verdict_on_words(&instruction.findings) <= self.good_enough() {
                return Ok(WritingOutcome::Accepted(instruction));
            }
            self.complain(&instruction);
            if least_bad.as_ref().is_none_or(|before| instruction.verdict < before.verdict) {
                least_bad = Some(instruction);
            }
        }
        match least_bad {
            Some(instruction) if instruction.verdict == Verdict::Unverified => {
                Ok(WritingOutcome::Accepted(instruction))
            }
            last => {
                let reason = self.failure_reasons(last.as_ref());
                Ok(WritingOutcome::Rejected { reason, last, drafts: Vec::new() })
            }
        }
    }

    /// Attempts by rules are free, so they go on until every check passes. A model only writes again what failed a check.
    fn good_enough(&self) -> Verdict {
        if self.is_by_rules() { Verdict::Pass } else { Verdict::Unverified }
    }

    pub(super) fn is_by_rules(&self) -> bool {
        self.writer.name() == RulesWriter.name()
    }

    /// Writes a text and checks it. What the checks could not decide is asked of the model that sees. `None` for a reply
    /// that is no text. `more` are complaints in addition to those about failed texts.
    ///
    /// # Errors
    /// When there is no object for the task, or a model fails.
    pub(super) fn write_once(
        &mut self,
        repairs: u32,
        more: &[TextComplaint],
    ) -> Result<Option<Instruction>, WriteError> {
        let complaints: Vec<TextComplaint> = self.complaints.iter().chain(more).cloned().collect();
        let text = match self.writer.write(&brief_for_attempt(self.order, self.candidate, &complaints)) {
            Ok(text) if has_same_words(&text, self.order.earlier) => {
                let reason = "this way already has this text: write another one".to_owned();
                self.complain_about_reply(text, reason);
                return Ok(None);
            }
            Ok(text) => text,
            Err(WriteError::Unusable { text, reason }) => {
                self.complain_about_reply(text, reason);
                return Ok(None);
            }
            Err(error) => return Err(error),
        };
        let provenance = text_provenance(self.writer, self.observers, self.order, repairs);
        let mut instruction = check_text(text, provenance, self.order);
        if !self.is_by_rules() && instruction.verdict == Verdict::Unverified {
            ask_about_text(&mut instruction, self.observers, self.order)?;
        }
        Ok(Some(instruction))
    }

    /// Keeps a text that was not good enough, for the next prompt and for the user.
    fn complain(&mut self, instruction: &Instruction) {
        self.keep_draft(&instruction.text, failed_reasons(&instruction.findings), &instruction.findings);
        let (text, findings) = (instruction.text.clone(), instruction.findings.clone());
        self.complaints.push(TextComplaint { text, findings });
    }

    fn complain_about_reply(&mut self, text: String, reason: String) {
        let complaint = unusable_complaint(text, reason.clone());
        self.keep_draft(&complaint.text, vec![reason], &complaint.findings);
        self.complaints.push(complaint);
    }

    /// Keeps a text of a model that is not the final one. Of `findings` the draft has those that failed.
    pub(super) fn keep_draft(&mut self, text: &str, reasons: Vec<String>, findings: &[CheckFinding]) {
        if !self.is_by_rules() {
            self.drafts.push(new_draft(text, self.candidate, reasons, findings));
        }
    }

    /// The checks that the best text fails, with the reasons; if there is no text, the reason why the last reply was
    /// unusable.
    fn failure_reasons(&self, best: Option<&Instruction>) -> String {
        let unusable = || self.complaints.last().map_or(&[][..], |complaint| &complaint.findings);
        failed_reasons(best.map_or_else(unusable, |instruction| &instruction.findings)).join("; ")
    }
}

/// Longest text of a draft, bytes. Of a longer reply its beginning is kept.
const MAX_DRAFT_BYTES: usize = 4000;
/// Most failed checks, and most reasons, of a draft.
const MAX_DRAFT_FINDINGS: usize = 40;

/// A draft of bounded size: a model may write anything.
pub(super) fn new_draft(
    text: &str,
    candidate: u32,
    mut reasons: Vec<String>,
    findings: &[CheckFinding],
) -> WrittenDraft {
    let text = &text[..text.floor_char_boundary(MAX_DRAFT_BYTES)];
    reasons.truncate(MAX_DRAFT_FINDINGS);
    let failed = findings.iter().filter(|finding| finding.verdict == Verdict::Fail).take(MAX_DRAFT_FINDINGS);
    let within = |finding: &CheckFinding| CheckFinding {
        span: finding.span.filter(|[from, to]| text.get(*from..*to).is_some()),
        ..finding.clone()
    };
    WrittenDraft { text: text.to_owned(), candidate, reasons, findings: failed.map(within).collect() }
}

/// The checks that a text fails, with the reasons.
pub(super) fn failed_reasons(findings: &[CheckFinding]) -> Vec<String> {
    let failed = findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    failed.map(|finding| format!("{}: {}", finding.check.name(), finding.reason)).collect()
}

impl From<WriteError> for ModelError {
    /// What a writer cannot do without an object is no failure of a model; callers handle it before.
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Model(error) => error,
            other => Self::Failed { model: "the writer".to_owned(), reason: other.to_string() },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::CheckKind;

    #[test]
    fn a_draft_keeps_what_failed_and_its_size_is_bounded() {
        let finding = |verdict, span| CheckFinding { check: CheckKind::Landmarks, verdict, reason: "why".into(), span };
        let findings = [
            finding(Verdict::Pass, None),
            finding(Verdict::Fail, Some([0, 3])),
            finding(Verdict::Fail, Some([MAX_DRAFT_BYTES, MAX_DRAFT_BYTES + 4])),
            finding(Verdict::Unverified, None),
        ];
        // Two bytes a letter, and one before them, so that the limit lies within a letter.
        let long = format!("x{}", "\u{e9}".repeat(MAX_DRAFT_BYTES));
        let draft = new_draft(&long, 2, failed_reasons(&findings), &findings);
        assert_eq!((draft.text.len(), draft.candidate), (MAX_DRAFT_BYTES - 1, 2));
        assert_eq!(draft.reasons, ["landmarks: why", "landmarks: why"]);
        // A span that lies in the part that was cut off is left out.
        assert_eq!(draft.findings.iter().map(|finding| finding.span).collect::<Vec<_>>(), [Some([0, 3]), None]);
        let short = new_draft("Walk past the lamp.", 0, vec!["why".into(); 99], &vec![findings[1].clone(); 99]);
        assert_eq!((short.reasons.len(), short.findings.len()), (MAX_DRAFT_FINDINGS, MAX_DRAFT_FINDINGS));
        assert_eq!(short.findings[0].span, Some([0, 3]));
    }
}
