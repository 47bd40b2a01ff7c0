//! Writes an instruction, checks it, and writes it again with the reasons where a check failed. If several candidates
//! are written, the one that a follower finds the way by most surely is chosen.

mod choose;

use crate::{
    dialogue::Mode,
    observe::Observers,
    style::Profile,
    walk::Walk,
    writer::{Brief, Complaint, FramePicture, RulesWriter, WriteError, Writer},
};
use wayword_checks::{Checked, Evidence, Memory, Subject, check_own};
use wayword_core::{Ambiguity, Check, Finding, Instruction, ModelError, Provenance, Style, Verdict, seed};
use wayword_language::text::words;

/// Everything that an instruction is made from.
#[derive(Clone, Copy)]
pub struct Order<'a> {
    /// The path and what was seen along it.
    pub walk: &'a Walk,
    /// What stays in mind of the walk, for the writer.
    pub memory: &'a Memory,
    /// The evidence that the text is checked against.
    pub evidence: &'a Evidence,
    /// The style to write in.
    pub style: &'a Style,
    /// The measured properties of the style's references.
    pub profile: &'a Profile,
    /// The style's hash, for provenance.
    pub style_hash: &'a str,
    /// The run's seed.
    pub seed: u64,
    /// How often a failed text is written again, at most.
    pub repairs: u32,
    /// How many candidate texts are written; the best is chosen. At least 1.
    pub candidates: u32,
    /// The number of the only candidate to write, if just one is wanted.
    pub only: Option<u32>,
    /// The follower for each text that passed its checks; `None` to skip this.
    pub follower: Option<&'a dyn Follow>,
    /// Texts that the walk already has in this style. The new one has to differ from them.
    pub earlier: &'a [String],
    /// Pictures of frames, for a writer that sees.
    pub pictures: &'a [FramePicture],
}

/// Follows texts on the map around their path.
pub trait Follow {
    /// Adds a finding to the checked text if it leads elsewhere, and returns what it may mean.
    fn follow(&self, text: &str, checked: &mut Checked) -> Ambiguity;

    /// How likely a text leads to the end of its walk, from 0 to 1, for the choice between texts. This uses another
    /// follower than [`Self::follow`], so that the text is not judged by the one that chose it. `None` if the text
    /// cannot be followed.
    fn leads_there(&self, text: &str) -> Option<f64>;
}

/// The writer of an instruction, and the one that takes over if it fails.
#[derive(Clone, Copy)]
pub struct Writers<'a> {
    /// Writes first, and again with the reasons if its text fails.
    pub writer: &'a dyn Writer,
    /// Writes if every text of the first writer failed; the provenance records it.
    pub finisher: Option<&'a dyn Writer>,
}

/// The result for one instruction: accepted, or rejected with the reasons.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// No check failed. A text with a check that could not be decided is accepted too; its verdict is then
    /// "unverified".
    Accepted(Instruction),
    /// The best text still fails, or no text was written.
    Rejected {
        /// The best text, if there is one.
        last: Option<Instruction>,
        /// The checks that it fails, with the reasons.
        reason: String,
    },
}

/// Writes an instruction and repairs it.
///
/// # Errors
/// When the writing model fails.
pub fn write_and_repair(
    writers: Writers<'_>,
    observers: Observers<'_>,
    order: Order<'_>,
) -> Result<Outcome, ModelError> {
    let first = choose::written(writers.writer, observers, order)?;
    let (Outcome::Rejected { .. }, Some(finisher)) = (&first, writers.finisher) else { return Ok(first) };
    let free = Order { repairs: order.repairs.max(FREE_REPAIRS), ..order };
    let finished = choose::written(finisher, observers, free)?;
    Ok(match finished {
        Outcome::Accepted(mut instruction) => {
            instruction.provenance.finished_for = Some(writers.writer.name().to_owned());
            Outcome::Accepted(instruction)
        }
        Outcome::Rejected { .. } => first,
    })
}

/// Least number of attempts of a finisher by rules. They cost nothing, so the limit for a model does not apply.
const FREE_REPAIRS: u32 = 8;

/// Lets one writer write until a text passes; `candidate` is the number of the candidate.
fn attempts(
    writer: &dyn Writer,
    observers: Observers<'_>,
    order: Order<'_>,
    candidate: u32,
) -> Result<Outcome, ModelError> {
    let mut complaints: Vec<Complaint> = Vec::new();
    let mut least_bad: Option<Instruction> = None;
    for repairs in 0..=order.repairs {
        let text = match writer.write(&brief(order, candidate, &complaints)) {
            Ok(text) if is_there(&text, order.earlier) => {
                complaints.push(unusable(text, "this way already has this text: write another one".to_owned()));
                continue;
            }
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
        let instruction = checked(text, provenance(writer, observers, order, repairs), order);
        // Attempts by rules are free, so they go on until every check passes. A model only writes again what failed a
        // check.
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

fn brief<'a>(order: Order<'a>, candidate: u32, complaints: &'a [Complaint]) -> Brief<'a> {
    let Order { walk, memory, style, profile, earlier, pictures, .. } = order;
    // A later text of the same walk gets its own seed.
    let seed = match earlier.len() {
        0 => order.seed,
        number => seed::derive(order.seed, &["text", &number.to_string()]),
    };
    Brief { candidate, complaints, earlier, pictures, ..Brief::new(walk, memory, style, profile, seed) }
}

/// Whether one of the earlier texts has the same words.
fn is_there(text: &str, earlier: &[String]) -> bool {
    let said = words(text);
    earlier.iter().any(|other| words(other) == said)
}

fn unusable(text: String, reason: String) -> Complaint {
    let finding = Finding { check: Check::Form, verdict: Verdict::Fail, reason, span: None };
    Complaint { text, findings: vec![finding] }
}

fn checked(text: String, provenance: Provenance, order: Order<'_>) -> Instruction {
    let target = order.walk.path.target.as_ref();
    let subject = Subject::closed(order.evidence, order.style, target).with_copies(&order.profile.copies);
    let mut checked = check_own(&text, Subject { writer_sees: !order.pictures.is_empty(), ..subject });
    // A failed text is written again anyway, so it is not followed.
    let follower = order.follower.filter(|_| checked.verdict() != Verdict::Fail);
    let ambiguity = follower.map(|follower| follower.follow(&text, &mut checked));
    Instruction {
        style: order.style.name.clone(),
        verdict: checked.verdict(),
        mentions: checked.mentions,
        findings: checked.findings,
        ambiguity,
        provenance,
        text,
    }
}

/// The checks that the best text fails, with the reasons; if there is no text, the reason why the last reply was
/// unusable.
fn reasons(best: Option<&Instruction>, complaints: &[Complaint]) -> String {
    let unusable = || complaints.last().map_or(&[][..], |complaint| &complaint.findings);
    let findings = best.map_or_else(unusable, |instruction| &instruction.findings);
    let failed = findings.iter().filter(|finding| finding.verdict == Verdict::Fail);
    failed.map(|finding| format!("{}: {}", finding.check.name(), finding.reason)).collect::<Vec<_>>().join("; ")
}

fn provenance(writer: &dyn Writer, observers: Observers<'_>, order: Order<'_>, repairs: u32) -> Provenance {
    let asker = match observers.mode {
        Mode::Dialogue { .. } => observers.asker.name(),
        Mode::Fixed => "fixed queries",
        Mode::Single => "one fixed request",
        Mode::Structured { .. } => "one structured request",
    };
    // Several looks of a frame are summarised even if a single answer described each.
    let condensed = order.walk.observations.iter().any(|observation| observation.looks.len() > 1);
    let summed_up = observers.mode != Mode::Single || condensed;
    let summariser = if summed_up { observers.summariser.name() } else { "nobody" };
    Provenance {
        wayword: env!("CARGO_PKG_VERSION").to_owned(),
        asker: asker.to_owned(),
        answerer: observers.answerer.name().to_owned(),
        detector: observers.detector.map(str::to_owned),
        summariser: summariser.to_owned(),
        writer: writer.name().to_owned(),
        checked_against: order.evidence.source.name().to_owned(),
        seed: order.seed,
        style_hash: order.style_hash.to_owned(),
        prompts_hash: observers.prompts_hash.map(str::to_owned),
        repairs,
        finished_for: None,
        chosen: None,
        target_undescribed: !order.walk.describes_target(),
    }
}

#[cfg(test)]
mod tests;
