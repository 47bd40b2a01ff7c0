//! The summary of a run.

use super::progress::RunStop;
use crate::{
    calls::CallSpending,
    count::count_phrase,
    error::{CommandError, Exit},
    lookout::DetectorLookout,
    output::tame_text,
    run_folder::{FailedItem, RejectedText, RunFolder, file, lines},
};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::{collections::BTreeMap, fmt, path::Path};
use wayword_core::{
    CheckFinding, CheckKind, FormOutcome, FrameObservation, SceneLack, TextAmbiguity, TextProvenance, Verdict,
};

/// The summary of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// The run folder.
    pub run: String,
    /// Items of the run.
    pub items: usize,
    /// Items with texts in the folder, accepted or rejected.
    pub made: usize,
    /// Instructions that passed every check.
    pub passed: usize,
    /// Instructions for which something could not be checked.
    pub unverified: usize,
    /// Those of the instructions that rules wrote, because every text of the model failed.
    pub finished_by_rules: usize,
    /// Instructions that may mean several places, or several objects. They are rejected only with --reject-ambiguous.
    pub ambiguous: usize,
    /// Instructions that are far from each number of words that their style asks for.
    #[serde(skip_serializing_if = "is_zero")]
    pub far_lengths: usize,
    /// The reason of the first of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_far_length: Option<String>,
    /// Instructions that could not be followed.
    pub unfollowed: usize,
    /// The reason of the first of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why_unfollowed: Option<String>,
    /// Views where the model's first answer did not have the requested form, and the second did.
    #[serde(skip_serializing_if = "is_zero")]
    pub asked_again: usize,
    /// Views where no answer had that form, so that the last one was read as plain words.
    #[serde(skip_serializing_if = "is_zero")]
    pub read_as_words: usize,
    /// Instructions, or whole items, that were rejected.
    pub rejected: usize,
    /// Items that failed: something is missing or broken, or the platform or a service was lost. The same command tries
    /// them again.
    pub errors: usize,
    /// The first failed item with its reason, else the first rejected text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_loss: Option<String>,
    /// Who asked, answered, summarised and wrote.
    pub roles: String,
    /// The work of the detector in this command, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detector: Option<DetectorSummary>,
    /// The scenes that the run leaves out, with the reason.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub left_out: BTreeMap<String, SceneLack>,
    /// The file of `--calibration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<String>,
    /// Calls, tokens and money of this command, if models took part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spent: Option<CallSpending>,
    /// The reason, if the run stopped before its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
    /// The exit code for this outcome.
    #[serde(skip)]
    pub exit: Exit,
}

/// The work of a detector.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DetectorSummary {
    /// The detector.
    pub model: String,
    /// The views that it looked at, including those with finds from the ledger.
    pub views: usize,
}

impl DetectorSummary {
    /// The work of a detector so far.
    pub(super) fn from_lookout(lookout: &DetectorLookout) -> Self {
        Self { model: lookout.name().to_owned(), views: lookout.view_count() }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Reads the files of a run folder, and counts the texts and failures in them. `spent` and `stopped` are about this
/// command.
pub(super) fn summarise_run(
    folder: &Path,
    run: &RunFolder,
    items: usize,
    spent: Option<CallSpending>,
    stopped: Option<RunStop>,
) -> Result<RunSummary, CommandError> {
    let (mut passed, mut unverified, mut finished, mut roles) = (0, 0, 0, None);
    let (mut ambiguous, mut unfollowed, mut why_unfollowed) = (0, 0, None);
    let (mut far_lengths, mut first_far_length) = (0, None);
    lines::each_line(&folder.join(file::INSTRUCTIONS), |line| {
        let InstructionLine { verdict, provenance, ambiguity, findings } = line.parse()?;
        if let Some(far) = findings.into_iter().find(is_far_length) {
            far_lengths += 1;
            first_far_length.get_or_insert(far.reason);
        }
        passed += usize::from(verdict == Verdict::Pass);
        unverified += usize::from(verdict == Verdict::Unverified);
        finished += usize::from(provenance.finished_for.is_some());
        roles.get_or_insert_with(|| describe_roles(&provenance));
        if let Some(ambiguity) = ambiguity {
            ambiguous += usize::from(ambiguity.is_ambiguous());
            unfollowed += usize::from(ambiguity.ends.is_none());
            why_unfollowed = why_unfollowed.take().or(ambiguity.unverified);
        }
        Ok(())
    })?;
    let (asked_again, read_as_words) = count_misshapen(&folder.join(file::WALKS))?;
    let exit = match (&stopped, run.rejected.len() + run.errors.len()) {
        (Some(stop), _) => stop.exit,
        (None, 0) => Exit::Done,
        (None, _) => Exit::WithLoss,
    };
    Ok(RunSummary {
        run: folder.display().to_string(),
        items,
        made: run.walks.len(),
        passed,
        unverified,
        finished_by_rules: finished,
        ambiguous,
        far_lengths,
        first_far_length,
        unfollowed,
        why_unfollowed,
        asked_again,
        read_as_words,
        rejected: run.rejected.len(),
        errors: run.errors.len(),
        first_loss: match first_failure(&folder.join(file::ERRORS))? {
            None => first_rejection(&folder.join(file::REJECTED))?,
            failed => failed,
        },
        roles: roles.unwrap_or_default(),
        detector: None,
        left_out: BTreeMap::new(),
        calibration: None,
        spent,
        stopped: stopped.map(|stop| stop.reason),
        exit,
    })
}

/// Counts the views with an answer that lacked the requested form: those with a later answer that had it, and those without one.
fn count_misshapen(walks: &Path) -> Result<(usize, usize), CommandError> {
    let (mut mended, mut broken) = (0, 0);
    if walks.exists() {
        lines::each_line(walks, |line| {
            let WalkLine { observations } = line.parse()?;
            for look in observations.iter().flat_map(|seen| &seen.looks) {
                mended += usize::from(look.caption.form == Some(FormOutcome::Mended));
                broken += usize::from(look.caption.form == Some(FormOutcome::Broken));
            }
            Ok(())
        })?;
    }
    Ok((mended, broken))
}

fn first_failure(errors: &Path) -> Result<Option<String>, CommandError> {
    let first: Option<FailedItem> = first_line(errors)?;
    Ok(first.map(|FailedItem { item, failure, reason }| format!("{item} ({}): {reason}", failure.name())))
}

fn first_rejection(rejected: &Path) -> Result<Option<String>, CommandError> {
    let first: Option<RejectedText> = first_line(rejected)?;
    Ok(first.map(|RejectedText { item, style, reason, .. }| format!("{item} ({style}): {reason}")))
}

fn first_line<T: DeserializeOwned>(file: &Path) -> Result<Option<T>, CommandError> {
    let mut first = None;
    lines::each_line(file, |line| {
        if first.is_none() {
            first = Some(line.parse()?);
        }
        Ok(())
    })?;
    Ok(first)
}

/// The fields of an instruction's line that the summary counts and shows.
#[derive(Deserialize)]
struct InstructionLine {
    verdict: Verdict,
    provenance: TextProvenance,
    #[serde(default)]
    ambiguity: Option<TextAmbiguity>,
    #[serde(default)]
    findings: Vec<CheckFinding>,
}

/// Whether a finding says that a text is far from the lengths of its style. A broken rule of the style is a failure.
fn is_far_length(finding: &CheckFinding) -> bool {
    (finding.check, finding.verdict) == (CheckKind::Form, Verdict::Unverified)
}

/// The fields of a walk's line that the summary counts.
#[derive(Deserialize)]
struct WalkLine {
    #[serde(default)]
    observations: Vec<FrameObservation>,
}

/// The players of the roles in one line, from the provenance of a text.
fn describe_roles(provenance: &TextProvenance) -> String {
    // The provenance has the detector's name, followed by the meaning of its scores in brackets.
    let detector = provenance.detector.as_deref().and_then(|detector| detector.split(" (").next());
    let finds = detector.map_or(String::new(), |name| format!(", finds by {name}"));
    format!(
        "questions by {}, answers by {}{finds}, summary by {}, text by {}; checked against {}",
        provenance.asker,
        provenance.answerer,
        provenance.summariser,
        provenance.finished_for.as_ref().unwrap_or(&provenance.writer),
        provenance.checked_against
    )
}

impl fmt::Display for RunSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let so_far = if self.stopped.is_some() { " in the run, so far" } else { "" };
        writeln!(
            f,
            "{}{so_far}: {} passed every check, {} unverified, {} rejected",
            count_phrase(self.items, "item"),
            count_phrase(self.passed, "instruction"),
            self.unverified,
            self.rejected
        )?;
        if self.errors > 0 {
            writeln!(
                f,
                "{} failed; remove the cause, and the same command tries again",
                count_phrase(self.errors, "item")
            )?;
        }
        if let Some(loss) = &self.first_loss {
            writeln!(
                f,
                "first {}: {}",
                if self.errors > 0 { "failed item" } else { "rejected text" },
                tame_text(loss)
            )?;
        }
        if !self.roles.is_empty() {
            writeln!(f, "roles: {}", self.roles)?;
        }
        if let Some(DetectorSummary { model, views }) = &self.detector {
            writeln!(f, "detector: {model} looked at {}", count_phrase(*views, "view"))?;
        }
        if self.finished_by_rules > 0 {
            let finished = count_phrase(self.finished_by_rules, "instruction");
            writeln!(f, "{finished} written by rules, because every text of the model failed a check")?;
        }
        if self.asked_again + self.read_as_words > 0 {
            writeln!(
                f,
                "views whose answer lacked the form that was asked for: {} asked for again, {} read as words",
                self.asked_again, self.read_as_words
            )?;
        }
        if self.ambiguous > 0 {
            writeln!(
                f,
                "ambiguous: {} may mean several places or objects",
                count_phrase(self.ambiguous, "instruction")
            )?;
        }
        if let Some(reason) = &self.first_far_length {
            writeln!(
                f,
                "far from the length that the style asks for: {}; the first: {}",
                count_phrase(self.far_lengths, "instruction"),
                tame_text(reason)
            )?;
        }
        if let (Some(why), 1..) = (&self.why_unfollowed, self.unfollowed) {
            writeln!(f, "not followed: {}; {}", count_phrase(self.unfollowed, "instruction"), tame_text(why))?;
        }
        if !self.left_out.is_empty() {
            let names: Vec<&str> = self.left_out.keys().map(String::as_str).collect();
            writeln!(f, "left out: {} ({})", count_phrase(names.len(), "scene"), names.join(", "))?;
        }
        if let Some(file) = &self.calibration {
            writeln!(f, "calibration: {file}")?;
        }
        if let Some(spent) = &self.spent {
            writeln!(f, "models: {spent}")?;
        }
        if let Some(reason) = &self.stopped {
            writeln!(f, "stopped before the end: {reason}")?;
            let (run, made) = (&self.run, count_phrase(self.made, "item"));
            writeln!(
                f,
                "it need not be finished: `wayword report --run {run}` and `wayword export --run {run}` take the {made} that are \
                 there"
            )?;
        }
        write!(f, "run folder: {}", self.run)?;
        match self.loss_line() {
            Some(line) => write!(f, "\n{line}"),
            None => Ok(()),
        }
    }
}

impl RunSummary {
    /// What was lost in a run that ends with the exit code for that, and where to look.
    fn loss_line(&self) -> Option<String> {
        if self.exit != Exit::WithLoss {
            return None;
        }
        let part = |count: usize, thing: &str, how: &str, name: &str| {
            let file = Path::new(&self.run).join(name);
            (count > 0).then(|| format!("{} {how} (see {})", count_phrase(count, thing), file.display()))
        };
        let parts = [
            part(self.errors, "item", "failed", file::ERRORS),
            part(self.rejected, "text", "rejected", file::REJECTED),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        Some(format!("exit code {}: the run is done, but with loss: {}", Exit::WithLoss as u8, parts.join(", ")))
    }
}
