//! Write, check, and write again what failed.

use crate::{
    dialogue::Mode,
    observe::Minds,
    style::{Profile, hash},
    walk::Walk,
    writer::{Brief, Complaint, RulesWriter, WriteError, Writer},
};
use wayword_checks::{Evidence, Subject, check_own};
use wayword_core::{Check, Finding, Instruction, ModelError, Provenance, Style, Verdict};

/// Everything that one instruction is made from.
#[derive(Clone, Copy)]
pub struct Order<'a> {
    /// The path and what was seen along it.
    pub walk: &'a Walk,
    /// What the text is checked against.
    pub evidence: &'a Evidence,
    /// The style to write in.
    pub style: &'a Style,
    /// What the style's references are like.
    pub profile: &'a Profile,
    /// The run's seed.
    pub seed: u64,
    /// How often a text that failed is written again, at most.
    pub repairs: u32,
}

/// Who writes.
#[derive(Clone, Copy)]
pub struct Writers<'a> {
    /// Writes first, and again with the reasons where its text fails.
    pub writer: &'a dyn Writer,
    /// Writes where every text of the first failed; the provenance says so.
    pub finisher: Option<&'a dyn Writer>,
}

/// A walk in words: accepted, or rejected with the reasons.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// No check failed. "Unverified" is accepted where nothing could be checked, and says so.
    Accepted(Instruction),
    /// The best text still fails, or there is none.
    Rejected {
        /// The last text, where there is one.
        last: Option<Instruction>,
        /// Why.
        reason: String,
    },
}

/// Writes an instruction and repairs it.
///
/// # Errors
/// When a model that was to write gave nothing.
pub fn write_and_repair(writers: Writers<'_>, minds: Minds<'_>, order: Order<'_>) -> Result<Outcome, ModelError> {
    let first = attempts(writers.writer, minds, order)?;
    let (Outcome::Rejected { .. }, Some(finisher)) = (&first, writers.finisher) else { return Ok(first) };
    let free = Order { repairs: order.repairs.max(FREE_REPAIRS), ..order };
    let finished = attempts(finisher, minds, free)?;
    Ok(match finished {
        Outcome::Accepted(mut instruction) => {
            instruction.provenance.finished_for = Some(writers.writer.name().to_owned());
            Outcome::Accepted(instruction)
        }
        Outcome::Rejected { .. } => first,
    })
}

/// A finisher that works by rules writes again for nothing, however few times a model may.
const FREE_REPAIRS: u32 = 8;

/// One writer's texts until one passes.
fn attempts(writer: &dyn Writer, minds: Minds<'_>, order: Order<'_>) -> Result<Outcome, ModelError> {
    let mut complaints: Vec<Complaint> = Vec::new();
    let mut least_bad: Option<Instruction> = None;
    for repairs in 0..=order.repairs {
        let text = match writer.write(&brief(order, &complaints)) {
            Ok(text) => text,
            Err(error @ WriteError::NoObject) => {
                return Ok(Outcome::Rejected { last: least_bad, reason: error.to_string() });
            }
            Err(WriteError::Unusable { text, reason }) => {
                complaints.push(unusable(text, reason));
                continue;
            }
            Err(WriteError::Model(error)) => return Err(error),
        };
        let instruction = checked(text, provenance(writer, minds, order, repairs), order);
        // Rules write again for nothing; a model is only sent back what failed.
        let good_enough = if writer.name() == RulesWriter.name() { Verdict::Pass } else { Verdict::Unverified };
        if instruction.verdict <= good_enough {
            return Ok(Outcome::Accepted(instruction));
        }
        complaints.push(Complaint { text: instruction.text.clone(), findings: instruction.findings.clone() });
        if least_bad.as_ref().is_none_or(|before| instruction.verdict < before.verdict) {
            least_bad = Some(instruction);
        }
    }
    Ok(match least_bad {
        Some(instruction) if instruction.verdict == Verdict::Unverified => Outcome::Accepted(instruction),
        last => Outcome::Rejected { reason: reasons(last.as_ref(), &complaints), last },
    })
}

fn brief<'a>(order: Order<'a>, complaints: &'a [Complaint]) -> Brief<'a> {
    Brief { walk: order.walk, style: order.style, profile: order.profile, seed: order.seed, complaints }
}

fn unusable(text: String, reason: String) -> Complaint {
    let finding = Finding { check: Check::Form, verdict: Verdict::Fail, reason, span: None };
    Complaint { text, findings: vec![finding] }
}

fn checked(text: String, provenance: Provenance, order: Order<'_>) -> Instruction {
    let target = order.walk.path.target.as_ref();
    let checked = check_own(&text, Subject { evidence: order.evidence, style: order.style, target });
    Instruction {
        style: order.style.name.clone(),
        verdict: checked.verdict(),
        mentions: checked.mentions,
        findings: checked.findings,
        provenance,
        text,
    }
}

/// What the best text fails in, or the last of those that could not be used.
fn reasons(best: Option<&Instruction>, complaints: &[Complaint]) -> String {
    let unusable = || complaints.last().map_or(&[][..], |complaint| &complaint.findings);
    let findings = best.map_or_else(unusable, |instruction| &instruction.findings);
    let failed = findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    failed.map(|finding| format!("{}: {}", finding.check.name(), finding.reason)).collect::<Vec<_>>().join("; ")
}

fn provenance(writer: &dyn Writer, minds: Minds<'_>, order: Order<'_>, repairs: u32) -> Provenance {
    let asker = match minds.mode {
        Mode::Dialogue { .. } => minds.asker.name(),
        Mode::Fixed => "fixed queries",
        Mode::Single => "one fixed request",
    };
    // The looks of a frame are condensed even where each was described at once.
    let condensed = order.walk.observations.iter().any(|observation| observation.looks.len() > 1);
    let summed_up = minds.mode != Mode::Single || condensed;
    let summariser = if summed_up { minds.summariser.name() } else { "nobody" };
    Provenance {
        wayword: env!("CARGO_PKG_VERSION").to_owned(),
        asker: asker.to_owned(),
        answerer: minds.answerer.name().to_owned(),
        summariser: summariser.to_owned(),
        writer: writer.name().to_owned(),
        checked_against: order.evidence.source.name().to_owned(),
        seed: order.seed,
        style_hash: hash(order.style),
        prompts_hash: minds.prompts_hash.map(str::to_owned),
        repairs,
        finished_for: None,
    }
}

#[cfg(test)]
mod tests;
