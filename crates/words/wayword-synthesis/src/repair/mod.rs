//! Write, check, and write again what failed; of several texts, keep the one that is followed most surely.

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

/// Everything that one instruction is made from.
#[derive(Clone, Copy)]
pub struct Order<'a> {
    /// The path and what was seen along it.
    pub walk: &'a Walk,
    /// What stays in mind of the walk, for the writer.
    pub memory: &'a Memory,
    /// What the text is checked against.
    pub evidence: &'a Evidence,
    /// The style to write in.
    pub style: &'a Style,
    /// What the style's references are like.
    pub profile: &'a Profile,
    /// The style's hash, for provenance.
    pub style_hash: &'a str,
    /// The run's seed.
    pub seed: u64,
    /// How often a text that failed is written again, at most.
    pub repairs: u32,
    /// How many texts are written, of which one is kept; at least 1.
    pub candidates: u32,
    /// Which one of these alone is written, where that is known.
    pub only: Option<u32>,
    /// Who follows each text that passed its checks; nobody where `None`.
    pub follower: Option<&'a dyn Follow>,
    /// Texts that the walk already has in this style: the new one has to differ from them, and is drawn anew.
    pub earlier: &'a [String],
    /// Pictures of frames, for a writer that sees.
    pub pictures: &'a [FramePicture],
}

/// Follows texts over what is known around their path.
pub trait Follow {
    /// Adds to a checked text whether it leads elsewhere, and returns what it may mean.
    fn follow(&self, text: &str, checked: &mut Checked) -> Ambiguity;

    /// How likely a text leads to the end of its walk, from 0 to 1, for the choice between texts. It is another follower
    /// than the one of [`Self::follow`], so that the text is not judged by the one that chose it. `None` where it cannot be
    /// followed.
    fn leads_there(&self, text: &str) -> Option<f64>;
}

/// Who writes.
#[derive(Clone, Copy)]
pub struct Writers<'a> {
    /// Writes first, and again with the reasons where its text fails.
    pub writer: &'a dyn Writer,
    /// Writes where every text of the first writer failed; the provenance says so.
    pub finisher: Option<&'a dyn Writer>,
}

/// What came of one instruction: accepted, or rejected with the reasons.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// No check failed. A text is accepted as "unverified" where something could not be checked, and its verdict says
    /// so.
    Accepted(Instruction),
    /// The best text still fails, or there is none.
    Rejected {
        /// The best text, where there is one.
        last: Option<Instruction>,
        /// Why.
        reason: String,
    },
}

/// Writes an instruction and repairs it.
///
/// # Errors
/// When the model that writes gives nothing.
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

/// How often a finisher by rules writes again, at least. It costs nothing, so the limit for a model does not apply.
const FREE_REPAIRS: u32 = 8;

/// One writer's texts until one passes; `candidate` counts the texts of which one is kept.
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
        // Rules write again for nothing, until every check passes. A model only writes again what failed a check.
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
    // A later text of the same walk is drawn anew.
    let seed = match earlier.len() {
        0 => order.seed,
        number => seed::derive(order.seed, &["text", &number.to_string()]),
    };
    Brief { candidate, complaints, earlier, pictures, ..Brief::new(walk, memory, style, profile, seed) }
}

/// Whether one of the earlier texts says the same words.
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
    // A text that failed is written again, wherever it leads.
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

/// The checks that the best text fails, with the reasons; where there is no text, why the last one could not be used.
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
    // Several looks of a frame are condensed even where one answer described each.
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
