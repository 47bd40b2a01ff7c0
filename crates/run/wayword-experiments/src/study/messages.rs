//! The messages of the study commands: each type is the result of one command, printed as text or as JSON.

use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_run::count::count_phrase;
use wayword_study::{ErasureReport, Participant, ParticipantStatus, Reconciliation, StudyProgress};

/// New personal links.
#[derive(Debug, Serialize)]
pub(super) struct PersonalLinks {
    pub(super) links: Vec<String>,
    /// How many earlier links nobody has used.
    pub(super) unused_before: u32,
}

impl fmt::Display for PersonalLinks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.links.join("\n"))
    }
}

/// A note for somebody who makes links again: the earlier ones are not replaced. `None` where there are none.
pub(super) fn unused_links_note(made: usize, unused_before: u32) -> Option<String> {
    (made > 0 && unused_before > 0).then(|| {
        let links = if made == 1 { "this link is".to_owned() } else { format!("these {made} links are") };
        let earlier = count_phrase(unused_before, "earlier link");
        let stay = if unused_before == 1 { "stays" } else { "stay" };
        format!("{links} new; {earlier} that nobody has used {stay} valid (links are not stored, so they cannot be printed again)")
    })
}

/// The progress of a study, for `wayword study status`.
#[derive(Debug, Serialize)]
pub(super) struct StudyStatusReport {
    #[serde(flatten)]
    pub(super) progress: StudyProgress,
    /// Folders with exported results, listed if a participant was forgotten: they may still contain the answers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) exports: Vec<PathBuf>,
    #[serde(rename = "list", skip_serializing_if = "Option::is_none")]
    pub(super) participants: Option<Vec<Participant>>,
}

impl fmt::Display for StudyStatusReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let progress = &self.progress;
        writeln!(f, "{}", if progress.is_closed { "closed" } else { "open" })?;
        for row in &progress.rows {
            let (least, most) = row.answered_per_item;
            writeln!(
                f,
                "{}: {} of {}, {} now with people; per item {least} to {most}",
                row.condition,
                row.answered,
                count_phrase(row.wanted, "answer"),
                row.live
            )?;
        }
        let people: Vec<String> =
            progress.participants.iter().map(|(status, number)| format!("{number} {}", status_word(*status))).collect();
        let people = if people.is_empty() { "nobody yet".to_owned() } else { people.join(", ") };
        write!(f, "participants: {people}; {} at it now", progress.live)?;
        if progress.forgotten > 0 {
            write!(f, "; {} forgotten", progress.forgotten)?;
        }
        if progress.unused_links > 0 {
            write!(f, "; {} not used", count_phrase(progress.unused_links, "personal link"))?;
        }
        for folder in &self.exports {
            let folder = folder.display();
            write!(f, "\n{folder} may hold answers of somebody who was forgotten since: write the results again")?;
        }
        for participant in self.participants.iter().flatten() {
            write!(f, "\n{} {}", participant.id, status_word(participant.status))?;
        }
        Ok(())
    }
}

fn status_word(status: ParticipantStatus) -> &'static str {
    match status {
        ParticipantStatus::Started => "started",
        ParticipantStatus::Complete => "complete",
        ParticipantStatus::Withdrawn => "withdrawn",
        ParticipantStatus::ScreenedOut => "screened out",
        ParticipantStatus::AttentionFailed => "failed attention checks",
    }
}

/// The data that `forget` removed, or would remove.
#[derive(Debug, Serialize)]
pub(super) struct RemovalReport {
    #[serde(flatten)]
    pub(super) removed: ErasureReport,
    /// Folders to which results were written: they still contain the answers.
    pub(super) exports: Vec<PathBuf>,
}

impl fmt::Display for RemovalReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ErasureReport { participant, answers, items, is_done } = &self.removed;
        let what = format!("{} in {}", count_phrase(*answers, "answer"), count_phrase(*items, "item"));
        let verb = if *is_done { "removed" } else { "would remove" };
        write!(f, "{verb} participant {participant} with {what}")?;
        for folder in &self.exports {
            write!(f, "\n{} still holds the answers: write the results again, or delete it", folder.display())?;
        }
        Ok(())
    }
}

/// The comparison of our list of participants with the recruiter's.
pub(super) struct ReconciliationTable<'a>(pub(super) &'a Reconciliation);

impl fmt::Display for ReconciliationTable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in &self.0.rows {
            let ours = row.ours.map_or("unknown", status_word);
            let theirs = row.theirs.as_deref().unwrap_or("not listed");
            let problem = row.problem.map_or(String::new(), |problem| format!("  <- {problem}"));
            writeln!(f, "{}: ours {ours}, theirs {theirs}{problem}", row.recruiter_id)?;
        }
        write!(f, "{} of {} do not agree", self.0.problems, count_phrase(self.0.rows.len(), "participant"))
    }
}

/// The message that a study is closed.
#[derive(Debug, Serialize)]
pub(super) struct ClosedNotice;

impl fmt::Display for ClosedNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("closed: it takes no more answers, and the recruiter's ids are gone")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_makes_links_again_reads_that_the_earlier_ones_stay_valid() {
        assert_eq!(unused_links_note(3, 0), None);
        assert_eq!(unused_links_note(0, 3), None);
        assert!(
            unused_links_note(1, 1)
                .unwrap()
                .starts_with("this link is new; 1 earlier link that nobody has used stays valid")
        );
        assert!(
            unused_links_note(3, 2)
                .unwrap()
                .starts_with("these 3 links are new; 2 earlier links that nobody has used stay")
        );
    }
}
