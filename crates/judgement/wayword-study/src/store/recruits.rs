//! Compares a recruiter's list of participants with ours, so that the researcher can see whom to pay. The recruiter's status is stored
//! next to ours and never changes it.

use super::{StudyTransaction, people};
use crate::study::{ParticipantStatus, StudyError};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

/// Names of the column with the participant's id, as Prolific, MTurk and others call it.
const PERSON_COLUMN_NAMES: [&str; 5] = ["participant id", "participant_id", "prolific_pid", "workerid", "participant"];
/// Names of the column with the status. Both lists are in lower case, because the case of a heading does not count.
const STATUS_COLUMN_NAMES: [&str; 3] = ["status", "assignmentstatus", "submission status"];

/// A participant in both lists.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ReconciliationRow {
    /// The recruiter's id.
    pub recruiter_id: String,
    /// Our id, if we know the participant.
    pub participant: Option<String>,
    /// Our status.
    pub ours: Option<ParticipantStatus>,
    /// The recruiter's status, as its file has it.
    pub theirs: Option<String>,
    /// How the two disagree; `None` if they agree.
    pub problem: Option<&'static str>,
}

/// The result of comparing both lists.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Reconciliation {
    /// All participants of either list, those with a problem first.
    pub rows: Vec<ReconciliationRow>,
    /// How many have a problem.
    pub problems: usize,
}

impl StudyTransaction<'_> {
    /// Compares the recruiter's list with ours.
    pub(crate) fn reconcile_recruiter_list(&self, file: &Path) -> Result<Reconciliation, StudyError> {
        let (theirs, repeated) = read_recruiter_list(file)?;
        let mut find = self.db.prepare(
            "SELECT recruit.id, person.name, person.status FROM recruit JOIN person ON person.id = recruit.person",
        )?;
        let ours: BTreeMap<String, (String, ParticipantStatus)> = find
            .query_map([], |row| Ok((row.get(0)?, (row.get(1)?, people::status_in_column(row, 2)?))))?
            .collect::<Result<_, _>>()?;
        if ours.is_empty() {
            let problem = "no participant has a recruiter's id";
            return Err(StudyError::refused_request(
                problem,
                "ids are dropped when a study is closed: reconcile first, then close",
            ));
        }
        // Their status is stored next to ours, without their id.
        for (id, status) in &theirs {
            let update =
                "UPDATE person SET recruiter_status = ?2 WHERE id = (SELECT person FROM recruit WHERE recruit.id = ?1)";
            self.db.execute(update, [id, &plain_status(status)])?;
        }
        let ids: BTreeSet<&String> = theirs.keys().chain(ours.keys()).collect();
        let row = |id: &String| {
            let (our, their) = (ours.get(id), theirs.get(id));
            ReconciliationRow {
                recruiter_id: id.clone(),
                participant: our.map(|(name, _)| name.clone()),
                ours: our.map(|(_, status)| *status),
                theirs: their.cloned(),
                problem: status_conflict(our.map(|(_, status)| *status), their.map(String::as_str)).or_else(|| {
                    repeated.contains(id).then_some("they list this id several times; its best status counts")
                }),
            }
        };
        let mut rows: Vec<ReconciliationRow> = ids.into_iter().map(row).collect();
        rows.sort_by_key(|row| row.problem.is_none());
        let problems = rows.iter().filter(|row| row.problem.is_some()).count();
        Ok(Reconciliation { rows, problems })
    }
}

/// How our status and theirs disagree. The names of their statuses are those of Prolific and MTurk.
fn status_conflict(ours: Option<ParticipantStatus>, theirs: Option<&str>) -> Option<&'static str> {
    let theirs = theirs.map(comparable_status);
    let is_listed_done = matches!(theirs.as_deref(), Some("APPROVED" | "AWAITING REVIEW" | "SUBMITTED"));
    let is_listed_left = matches!(theirs.as_deref(), Some("RETURNED" | "TIMED OUT" | "REJECTED" | "ABANDONED"));
    match (ours, theirs.as_deref()) {
        (None, None) => None,
        (None, Some(_)) if is_listed_done => Some("they list it as done, and we know nobody of this id"),
        (None, Some(_)) => None,
        (Some(_), None) => Some("we know this participant, and their list does not"),
        (Some(ParticipantStatus::Complete), _) if is_listed_left => {
            Some("all our answers are there, and they list it as not done")
        }
        (Some(ParticipantStatus::Started | ParticipantStatus::Withdrawn | ParticipantStatus::ScreenedOut), _)
            if is_listed_done =>
        {
            Some("they list it as done, and our answers are not complete")
        }
        (Some(ParticipantStatus::AttentionFailed), Some("APPROVED")) => {
            Some("approved, and the attention checks failed")
        }
        (Some(ParticipantStatus::Complete | ParticipantStatus::AttentionFailed), _) if is_listed_done => None,
        (
            Some(
                ParticipantStatus::Started
                | ParticipantStatus::Withdrawn
                | ParticipantStatus::ScreenedOut
                | ParticipantStatus::AttentionFailed,
            ),
            _,
        ) if is_listed_left => None,
        (Some(ParticipantStatus::Started), Some("ACTIVE" | "RESERVED"))
        | (Some(ParticipantStatus::ScreenedOut), Some("SCREENED OUT")) => None,
        _ => Some("the two do not fit together, as far as we know: look at this one"),
    }
}

/// A status from the recruiter's file, reduced to harmless characters and to 40 of them.
fn plain_status(status: &str) -> String {
    let is_plain = |letter: &char| letter.is_ascii_alphanumeric() || matches!(letter, ' ' | '-' | '_');
    status.chars().filter(is_plain).take(40).collect()
}

/// A status in the form in which statuses are compared.
fn comparable_status(status: &str) -> String {
    status.trim().to_ascii_uppercase().replace(['-', '_'], " ")
}

/// How far a participant came by a status of the recruiter: of several rows of one id the highest counts, in whatever order they are.
fn status_rank(status: &str) -> (usize, String) {
    const ASCENDING: [&str; 4] = ["ACTIVE", "SUBMITTED", "AWAITING REVIEW", "APPROVED"];
    let status = comparable_status(status);
    let rank = ASCENDING.iter().position(|known| *known == status).map_or(0, |at| at + 1);
    (rank, status)
}

/// Reads ids and statuses from a recruiter's file, with the ids that have several rows.
fn read_recruiter_list(file: &Path) -> Result<(BTreeMap<String, String>, BTreeSet<String>), StudyError> {
    let wrong = |problem: String| StudyError::File {
        path: file.to_owned(),
        problem,
        hint: "give the CSV that the recruiter exports, with a column `Participant id` (or `WorkerId`) and a column `Status`",
    };
    let mut reader =
        csv::ReaderBuilder::new().flexible(true).from_path(file).map_err(|error| wrong(error.to_string()))?;
    let headers = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let column = |names: &[&str]| {
        headers.iter().position(|header| {
            names.contains(&header.trim_start_matches('\u{feff}').trim().to_ascii_lowercase().as_str())
        })
    };
    let (Some(person), Some(status)) = (column(&PERSON_COLUMN_NAMES), column(&STATUS_COLUMN_NAMES)) else {
        let is_by_semicolons = headers.len() == 1 && headers.iter().any(|header| header.contains(';'));
        return Err(wrong(match is_by_semicolons {
            true => "semicolons separate its columns, and CSV has commas: save it with commas".to_owned(),
            false => "it has no column of participants, or none of their status".to_owned(),
        }));
    };
    let (mut statuses, mut repeated) = (BTreeMap::<String, String>::new(), BTreeSet::new());
    for row in reader.records() {
        let row = row.map_err(|error| wrong(error.to_string()))?;
        if let (Some(person), Some(status)) = (row.get(person), row.get(status)) {
            let (person, status) = (person.trim().to_owned(), status.trim().to_owned());
            match statuses.get(&person) {
                Some(other) => {
                    repeated.insert(person.clone());
                    if status_rank(&status) > status_rank(other) {
                        statuses.insert(person, status);
                    }
                }
                None => drop(statuses.insert(person, status)),
            }
        }
    }
    Ok((statuses, repeated))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_conflict_names_statuses_that_disagree() {
        assert_eq!(status_conflict(Some(ParticipantStatus::Complete), Some("AWAITING REVIEW")), None);
        assert!(status_conflict(Some(ParticipantStatus::Complete), Some("TIMED-OUT")).unwrap().contains("not done"));
        assert!(status_conflict(Some(ParticipantStatus::Started), Some("APPROVED")).unwrap().contains("not complete"));
        assert!(status_conflict(None, Some("Approved")).unwrap().contains("nobody"));
        assert_eq!(status_conflict(None, Some("RETURNED")), None);
        assert!(status_conflict(Some(ParticipantStatus::Started), None).is_some());
        assert!(status_conflict(Some(ParticipantStatus::Complete), Some("SCREENED OUT")).is_some());
        assert_eq!(status_conflict(Some(ParticipantStatus::Started), Some("RETURNED")), None);
    }
}
