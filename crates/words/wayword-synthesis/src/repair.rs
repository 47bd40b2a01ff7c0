//! Write, check, and write again what failed.

use crate::{
    checks::{Subject, check},
    dialogue::Mode,
    evidence::Evidence,
    observe::Minds,
    style::{Profile, hash},
    walk::Walk,
    writer::{Brief, Complaint, WriteError, Writer},
};
use wayword_core::{Instruction, Provenance, Style, Verdict};

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
#[must_use]
pub fn write_and_repair(writer: &dyn Writer, minds: Minds<'_>, order: Order<'_>) -> Outcome {
    let mut complaints: Vec<Complaint> = Vec::new();
    let mut least_bad: Option<Instruction> = None;
    for repairs in 0..=order.repairs {
        let brief = Brief {
            walk: order.walk,
            style: order.style,
            profile: order.profile,
            seed: order.seed,
            complaints: &complaints,
        };
        let text = match writer.write(&brief) {
            Ok(text) => text,
            Err(error @ WriteError::NoObject) => {
                return Outcome::Rejected { last: least_bad, reason: error.to_string() };
            }
        };
        let checked = check(
            &text,
            Subject { evidence: order.evidence, style: order.style, target: order.walk.path.target.as_ref() },
        );
        let verdict = checked.verdict();
        let instruction = Instruction {
            style: order.style.name.clone(),
            mentions: checked.mentions,
            verdict,
            findings: checked.findings,
            provenance: provenance(writer, minds, order, repairs),
            text,
        };
        if verdict == Verdict::Pass {
            return Outcome::Accepted(instruction);
        }
        complaints.push(Complaint { text: instruction.text.clone(), findings: instruction.findings.clone() });
        let better = least_bad.as_ref().is_none_or(|before| instruction.verdict < before.verdict);
        if better {
            least_bad = Some(instruction);
        }
    }
    match least_bad {
        Some(instruction) if instruction.verdict == Verdict::Unverified => Outcome::Accepted(instruction),
        last => Outcome::Rejected { reason: reasons(last.as_ref()), last },
    }
}

fn reasons(instruction: Option<&Instruction>) -> String {
    let findings = instruction.map_or(&[][..], |instruction| &instruction.findings);
    let failed = findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    failed.map(|finding| format!("{}: {}", finding.check.name(), finding.reason)).collect::<Vec<_>>().join("; ")
}

fn provenance(writer: &dyn Writer, minds: Minds<'_>, order: Order<'_>, repairs: u32) -> Provenance {
    let asker = if minds.mode == Mode::Fixed { "fixed queries" } else { minds.asker.name() };
    Provenance {
        wayword: env!("CARGO_PKG_VERSION").to_owned(),
        asker: asker.to_owned(),
        answerer: minds.answerer.name().to_owned(),
        summariser: minds.summariser.name().to_owned(),
        writer: writer.name().to_owned(),
        checked_against: order.evidence.source.name().to_owned(),
        seed: order.seed,
        style_hash: hash(order.style),
        prompts_hash: minds.prompts_hash.map(str::to_owned),
        repairs,
        finished_for: None,
    }
}
