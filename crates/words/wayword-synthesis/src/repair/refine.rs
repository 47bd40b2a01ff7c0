//! Writes a text again that passed its checks, but by which a follower does not arrive: its failure is the teacher.

use super::{CandidateResult, InstructionOrder, WritingOutcome, attempts::WritingAttempts, verdict_on_words};
use crate::{
    observe::ObservationRoles,
    writer::{InstructionWriter, TextComplaint},
};
use wayword_core::{CheckFinding, CheckKind, Instruction, ModelError, RefinedRound, Verdict};

/// A text that leads to the end of its walk with this probability is not written again.
const SURE_SHARE: f64 = 0.7;
/// A new text is kept if it leads there more surely by at least this.
const LEAST_GAIN: f64 = 0.02;

/// Writes one candidate: until it passes, and again if a follower does not arrive by it. It gets the drafts before it.
///
/// # Errors
/// When a model fails.
pub(super) fn write_candidate(
    writer: &dyn InstructionWriter,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
    number: u32,
) -> CandidateResult {
    let mut attempts = WritingAttempts::new(writer, observers, order, number);
    Ok(match attempts.write_until_good()? {
        WritingOutcome::Accepted(instruction) => {
            let mut instruction =
                if attempts.is_by_rules() { instruction } else { refine_text(&mut attempts, instruction)? };
            instruction.provenance.drafts = attempts.drafts;
            WritingOutcome::Accepted(instruction)
        }
        WritingOutcome::Rejected { last, reason, .. } => {
            WritingOutcome::Rejected { last, reason, drafts: attempts.drafts }
        }
    })
}

/// Writes a text again with what a follower lacks, at most so often as the order allows. The new text is kept if it passes as many checks,
/// and leads to the end more surely.
///
/// # Errors
/// When the writing model fails.
fn refine_text(attempts: &mut WritingAttempts<'_>, mut best: Instruction) -> Result<Instruction, ModelError> {
    let Some(follower) = attempts.order.follower else { return Ok(best) };
    let mut rounds: Vec<RefinedRound> = Vec::new();
    for _ in 0..attempts.order.refinements {
        let Some(before) = follower.leads_there(&best.text).filter(|share| *share < SURE_SHARE) else { break };
        let advice = follower.advice(&best);
        if advice.is_empty() {
            break;
        }
        let lacks =
            |reason: String| CheckFinding { check: CheckKind::Route, verdict: Verdict::Fail, reason, span: None };
        let complaint =
            TextComplaint { text: best.text.clone(), findings: advice.iter().cloned().map(lacks).collect() };
        let written = attempts.write_once(best.provenance.repairs, &[complaint])?;
        let passes = |new: &Instruction| verdict_on_words(&new.findings) <= verdict_on_words(&best.findings);
        let Some(new) = written else {
            rounds.push(RefinedRound { before, after: None, kept: false });
            continue;
        };
        let after = follower.leads_there(&new.text).filter(|_| passes(&new));
        let kept = after.is_some_and(|after| after >= before + LEAST_GAIN);
        rounds.push(RefinedRound { before, after, kept });
        if kept {
            attempts.keep_draft(&best.text, advice, &[]);
            best = new;
        } else {
            let why = match after {
                Some(after) => format!(
                    "a reader arrives by it with {:.0} %, by the kept text with {:.0} %",
                    100.0 * after,
                    100.0 * before
                ),
                None => "it fails checks that the kept text passes, or cannot be followed".to_owned(),
            };
            attempts.keep_draft(&new.text, vec![why], &new.findings);
        }
    }
    best.provenance.refined = rounds;
    Ok(best)
}
