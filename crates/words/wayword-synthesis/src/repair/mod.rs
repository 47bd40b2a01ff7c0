//! Writes an instruction, checks it, and writes it again with the reasons where a check failed. If several candidates
//! are written, the one that a follower finds the way by most surely is chosen.
//!
//! - `attempts`: one candidate, written until it passes.
//! - `questions`: asks the model that sees about what the checks could not decide.
//! - `refine`: writes a text again by which a follower does not arrive.
//! - `choose`: the best of several candidates.

mod attempts;
mod choose;
mod questions;
mod refine;

use crate::{
    dialogue::DialogueMode,
    observe::ObservationRoles,
    style::StyleProfile,
    walk::ObservedWalk,
    writer::{FramePicture, InstructionWriter, RulesInLanguage, RulesWriter, TextComplaint, WritingBrief},
};
use wayword_checks::{CheckSubject, Evidence, TextFindings, WalkMemory, check_own_text};
use wayword_core::{
    CheckFinding, CheckKind, Instruction, InstructionStyle, ModelError, TextAmbiguity, TextProvenance, Verdict, View,
    WrittenDraft, seed,
};
use wayword_language::{languages::ReadableText, text::split_words};

/// Everything that an instruction is made from.
#[derive(Clone, Copy)]
pub struct InstructionOrder<'a> {
    /// The path and what was seen along it.
    pub walk: &'a ObservedWalk,
    /// What stays in mind of the walk, for the writer.
    pub memory: &'a WalkMemory,
    /// The evidence that the text is checked against.
    pub evidence: &'a Evidence,
    /// The memory of the walk by that evidence: each claim is held against its own stretch of it.
    pub evidence_memory: &'a WalkMemory,
    /// The style to write in.
    pub style: &'a InstructionStyle,
    /// The measured properties of the style's references.
    pub profile: &'a StyleProfile,
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
    pub follower: Option<&'a dyn TextFollower>,
    /// Texts that the walk already has in this style. The new one has to differ from them.
    pub earlier: &'a [String],
    /// Pictures of frames, for a writer that sees.
    pub pictures: &'a [FramePicture],
    /// The view ahead of each frame, for questions to a model that sees; empty where none sees.
    pub views: &'a [View],
    /// How often a text that passed is written again at most, if the follower does not arrive by it surely.
    pub refinements: u32,
    /// Writes several candidates at the same time.
    pub together: &'a dyn WriteTogether,
}

/// Writes several candidates at the same time, or one after the other.
pub trait WriteTogether: Sync {
    /// Calls `write` with each of the numbers. The results are in the order of the numbers; after an error the last ones
    /// may be missing.
    fn write_each(&self, numbers: &[u32], write: &CandidateWriting<'_>) -> Vec<CandidateResult>;
}

/// Writes the candidate of a number.
pub type CandidateWriting<'a> = dyn Fn(u32) -> CandidateResult + Sync + 'a;
/// The outcome of a candidate.
pub type CandidateResult = Result<WritingOutcome, ModelError>;

/// Writes candidates one after the other.
pub struct OneByOne;

impl WriteTogether for OneByOne {
    fn write_each(&self, numbers: &[u32], write: &CandidateWriting<'_>) -> Vec<CandidateResult> {
        numbers.iter().map(|number| write(*number)).collect()
    }
}

/// Follows texts on the map around their path.
pub trait TextFollower: Sync {
    /// Follows a checked text. Adds a finding if the text leads elsewhere, and returns how many ends and objects the
    /// text may mean.
    fn follow(&self, text: &str, checked: &mut TextFindings) -> TextAmbiguity;

    /// How likely a text leads to the end of its walk, from 0 to 1, for the choice between texts. This uses another
    /// follower than [`Self::follow`], so that the text is not judged by the one that chose it. `None` if the text
    /// cannot be followed.
    fn leads_there(&self, text: &str) -> Option<f64>;

    /// What a text lacks for a walker to arrive by it, in sentences for its writer: parts of the walk that no words
    /// tell, and words that fit other ways as well.
    fn advice(&self, instruction: &Instruction) -> Vec<String>;
}

/// The writer of an instruction, and the one that takes over if it fails.
#[derive(Clone, Copy)]
pub struct WriterPair<'a> {
    /// Writes first, and again with the reasons if its text fails.
    pub writer: &'a dyn InstructionWriter,
    /// Writes if every text of the first writer failed; the provenance records it.
    pub finisher: Option<&'a dyn InstructionWriter>,
}

/// The result for one instruction: accepted, or rejected with the reasons.
#[derive(Debug, Clone, PartialEq)]
pub enum WritingOutcome {
    /// No check failed. A text with a check that could not be decided is accepted too; its verdict is then
    /// "unverified".
    Accepted(Instruction),
    /// The best text still fails, or no text was written.
    Rejected {
        /// The best text, if there is one.
        last: Option<Instruction>,
        /// The checks that it fails, with the reasons.
        reason: String,
        /// The texts of a model before it.
        drafts: Vec<WrittenDraft>,
    },
}

impl WritingOutcome {
    /// The accepted text, or the best one of those that failed.
    pub fn instruction_mut(&mut self) -> Option<&mut Instruction> {
        match self {
            Self::Accepted(instruction) => Some(instruction),
            Self::Rejected { last, .. } => last.as_mut(),
        }
    }
}

/// Writes an instruction and repairs it. If the first writer's texts all fail, the finisher writes.
///
/// # Errors
/// When the writing model fails.
pub fn write_and_repair(
    writers: WriterPair<'_>,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
) -> Result<WritingOutcome, ModelError> {
    let first = write_in_language(writers.writer, observers, order)?;
    let (WritingOutcome::Rejected { .. }, Some(finisher)) = (&first, writers.finisher) else { return Ok(first) };
    let more_repairs = InstructionOrder { repairs: order.repairs.max(MIN_FINISHER_REPAIRS), ..order };
    let finished = write_in_language(finisher, observers, more_repairs)?;
    let WritingOutcome::Rejected { drafts, .. } = &first else { return Ok(first) };
    Ok(match finished {
        WritingOutcome::Accepted(mut instruction) => {
            instruction.provenance.drafts.clone_from(drafts);
            instruction.provenance.finished_for = Some(writers.writer.name().to_owned());
            WritingOutcome::Accepted(instruction)
        }
        WritingOutcome::Rejected { .. } => first,
    })
}

/// The best text of a writer in the language of the style. Rules write, check and choose in English, so that the texts for a path say the
/// same in every language; the text that is kept is then put into the language and checked once more.
fn write_in_language(
    writer: &dyn InstructionWriter,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
) -> Result<WritingOutcome, ModelError> {
    let Some(language) = order.profile.language.as_ref().filter(|_| writer.name() == RulesWriter.name()) else {
        return choose::write_best(writer, observers, order);
    };
    let rules = RulesInLanguage::new(language);
    let english = choose::write_best(&rules, observers, order)?;
    let (WritingOutcome::Accepted(instruction) | WritingOutcome::Rejected { last: Some(instruction), .. }) = &english
    else {
        return Ok(english);
    };
    let mut best: Option<Instruction> = None;
    for version in rules.versions_of(&instruction.text).into_iter().filter(|text| !has_same_words(text, order.earlier))
    {
        let checked = check_text(version, instruction.provenance.clone(), order);
        let is_good = checked.verdict <= instruction.verdict;
        if best.as_ref().is_none_or(|best| checked.verdict < best.verdict) {
            best = Some(checked);
        }
        if is_good {
            break;
        }
    }
    let Some(instruction) = best else {
        let reason = format!("no text in {} says the same as {:?}", language.tag(), instruction.text);
        return Ok(WritingOutcome::Rejected { last: None, reason, drafts: Vec::new() });
    };
    Ok(match (instruction.verdict, english) {
        (Verdict::Fail, _) => {
            let reason = attempts::failed_reasons(&instruction.findings).join("; ");
            WritingOutcome::Rejected { last: Some(instruction), reason, drafts: Vec::new() }
        }
        (_, WritingOutcome::Accepted(_)) => WritingOutcome::Accepted(instruction),
        (_, WritingOutcome::Rejected { reason, drafts, .. }) => {
            WritingOutcome::Rejected { last: Some(instruction), reason, drafts }
        }
    })
}

/// Least number of repairs that a finisher by rules may make. They cost nothing, so the limit for a model does not
/// apply.
const MIN_FINISHER_REPAIRS: u32 = 8;

/// The verdict of the checks that other words could change: without a map, no words make a route known.
fn verdict_on_words(findings: &[CheckFinding]) -> Verdict {
    let is_route_unknown =
        |finding: &&CheckFinding| finding.check == CheckKind::Route && finding.verdict == Verdict::Unverified;
    let counted = findings.iter().filter(|finding| !is_route_unknown(finding));
    counted.map(|finding| finding.verdict).max().unwrap_or(Verdict::Unverified)
}

/// The input of the writer for its next attempt, with the complaints about the texts before.
fn brief_for_attempt<'a>(
    order: InstructionOrder<'a>,
    candidate: u32,
    complaints: &'a [TextComplaint],
) -> WritingBrief<'a> {
    let InstructionOrder { walk, memory, style, profile, earlier, pictures, .. } = order;
    // A later text of the same walk gets its own seed.
    let seed = match earlier.len() {
        0 => order.seed,
        number => seed::derive_seed(order.seed, &["text", &number.to_string()]),
    };
    let known = order.evidence_memory;
    let brief = WritingBrief::new(walk, memory, style, profile, seed);
    WritingBrief { known, candidate, complaints, earlier, pictures, ..brief }
}

/// Whether one of the earlier texts has the same words.
fn has_same_words(text: &str, earlier: &[String]) -> bool {
    let words = split_words(text);
    earlier.iter().any(|other| split_words(other) == words)
}

/// The complaint about a text that cannot be used, as a failed check of its form.
fn unusable_complaint(text: String, reason: String) -> TextComplaint {
    let finding = CheckFinding { check: CheckKind::Form, verdict: Verdict::Fail, reason, span: None };
    TextComplaint { text, findings: vec![finding] }
}

/// Checks a text, follows it if it passed, and makes an instruction of it with all findings.
fn check_text(text: String, provenance: TextProvenance, order: InstructionOrder<'_>) -> Instruction {
    let target = order.walk.path.target.as_ref();
    let subject = CheckSubject::closed_world(order.evidence, order.style, target)
        .with_copies(&order.profile.copies)
        .with_memory(order.evidence_memory);
    let readable = ReadableText::new(&text, Some(order.style.language.as_str()).filter(|tag| !tag.is_empty()));
    let (writer_sees, own_tokens) = (!order.pictures.is_empty(), readable.own_tokens());
    let subject = CheckSubject { writer_sees, own_tokens: own_tokens.as_deref(), ..subject };
    let mut checked = check_own_text(readable.english(), subject);
    // A failed text is written again anyway, so it is not followed.
    let follower = order.follower.filter(|_| checked.verdict() != Verdict::Fail);
    let ambiguity = follower.map(|follower| follower.follow(readable.english(), &mut checked));
    checked.put_into_text(&readable);
    Instruction {
        style: order.style.name.clone(),
        verdict: checked.verdict(),
        mentions: checked.mentions,
        parts: checked.parts,
        findings: checked.findings,
        ambiguity,
        provenance,
        text,
    }
}

/// Who asked, answered, summarised and wrote, with the seed and the hashes of the inputs.
fn text_provenance(
    writer: &dyn InstructionWriter,
    observers: ObservationRoles<'_>,
    order: InstructionOrder<'_>,
    repairs: u32,
) -> TextProvenance {
    let asker = match observers.mode {
        DialogueMode::Dialogue { .. } => observers.asker.name(),
        DialogueMode::Fixed => "fixed queries",
        DialogueMode::Single => "one fixed request",
        DialogueMode::Structured { .. } => "one structured request",
    };
    // Several looks of a frame are summarised even if a single answer described each.
    let condensed = order.walk.observations.iter().any(|observation| observation.looks.len() > 1);
    let summed_up = observers.mode != DialogueMode::Single || condensed;
    let summariser = if summed_up { observers.summariser.name() } else { "nobody" };
    TextProvenance {
        wayword: env!("CARGO_PKG_VERSION").to_owned(),
        asker: asker.to_owned(),
        answerer: observers.answerer.name().to_owned(),
        detector: observers.detector.map(str::to_owned),
        summariser: summariser.to_owned(),
        writer: writer.name().to_owned(),
        checked_against: order.evidence.source_name().to_owned(),
        seed: order.seed,
        style_hash: order.style_hash.to_owned(),
        prompts_hash: observers.prompts_hash.map(str::to_owned),
        repairs,
        finished_for: None,
        chosen: None,
        drafts: Vec::new(),
        refined: Vec::new(),
        target_undescribed: !order.walk.describes_target(),
    }
}

#[cfg(test)]
mod tests;
